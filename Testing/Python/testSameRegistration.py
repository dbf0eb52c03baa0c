# SPDX-License-Identifier: Apache-2.0
"""The command, the VTK filter and mammoray.register find the same from the same labels: testSameRegistration.py PROGRAM.

Exit 125: no device."""
import json
import pathlib
import subprocess
import sys
import tempfile

import mammoray
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from pipeline import TABLE, cells, field, half_ball_labels, image, points

FREE = ["thickness", "lateral", "anterior"]
POSE = {"thickness": "48", "lateral": "3", "anterior": "4"}

if not mammoray.devices():
    print("no Vulkan device")
    sys.exit(125)

labels, origin = half_ball_labels()
# +x anterior, +y left, +z superior: right-handed, as files are.
labels = numpy.ascontiguousarray(labels.transpose(0, 2, 1))
origin = (origin[1], origin[0], origin[2])


def write_labels(path):
    sizes = " ".join(map(str, labels.shape[::-1]))
    header = ("NRRD0004", "type: unsigned short", "dimension: 3", "space: left-posterior-superior", f"sizes: {sizes}",
              "space directions: (2,0,0) (0,2,0) (0,0,2)", "endian: little", "encoding: raw",
              "space origin: ({},{},{})".format(*origin))
    path.write_bytes("\n".join(header).encode() + b"\n\n" + labels.astype("<u2").tobytes())


def write_grid(grid, path):
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(grid)
    writer.Write()


def run(*arguments):
    subprocess.run([sys.argv[1], *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def meshed(table, **properties):
    mesher = mammoray.vtkBreastMesher(MaterialTable=str(table), **properties)
    mesher.SetInputData(image(labels, origin, 2.0))
    mesher.Update()
    return mesher.GetOutput()


def regions(grid):
    return vtk_to_numpy(grid.GetCellData().GetArray("Material"))


def registered(simulation, mammogram, table):
    """Parameters, trust and expected error of the filter, and its output."""
    registration = mammoray.vtkBreastRegistration(MaterialTable=str(table), Orientation="ALS", FreeParameters=" ".join(FREE),
                                                  AcceptUnusual=True)
    registration.SetInputData(0, image(labels, origin, 2.0))
    reader = mammoray.vtkMammogramReader(FileName=str(mammogram))
    registration.SetMammogramConnection(reader.GetOutputPort())
    registration.SetInputData(2, simulation)
    registration.Update()
    output = registration.GetOutput()
    strings = {name: output.GetFieldData().GetAbstractArray(name) for name in ("ParameterNames", "Trust", "TrustReasons")}
    texts = {name: [array.GetValue(n) for n in range(array.GetNumberOfValues())] for name, array in strings.items()}
    return (dict(zip(texts["ParameterNames"], field(output, "Parameters").tolist())),
            dict(zip(texts["ParameterNames"], field(output, "ParameterDeviations").tolist())), texts["Trust"][0],
            texts["TrustReasons"], field(output, "ExpectedErrorMm").tolist(), output)


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    table = folder / "table.json"
    table.write_text(TABLE)
    write_labels(folder / "labels.nrrd")
    anatomy = meshed(table, CellSizeMm=8)
    coarse = meshed(table, ForMechanics=True, CellSizeMm=11)
    write_grid(anatomy, folder / "anatomy.vtu")
    write_grid(coarse, folder / "coarse.vtu")
    write_grid(meshed(table, ForMechanics=True, CellSizeMm=9), folder / "other.vtu")
    pose = [word for name, value in POSE.items() for word in (f"--{name}", value)]
    given = ("--materials", table, "--orientation", "ALS")
    run("compress", "--mesh", folder / "anatomy.vtu", "--simulation-mesh", folder / "other.vtu", *given, *pose,
        "-o", folder / "compressed.vtu")
    mammogram = folder / "mammogram.dcm"
    run("project", "--mesh", folder / "compressed.vtu", *given, *pose, "--for-processing", "--side", "left", "--pixel-spacing", "0.5",
        "--columns", "90", "--rows", "180", "--spectrum", "W30kVp_Rh50um_Be1mm", "-o", mammogram)

    run("register", "--labels", folder / "labels.nrrd", *given, "--mammogram", mammogram, "--simulation-mesh", folder / "coarse.vtu",
        "--free", *FREE, "--accept-unusual", "-o", folder / "result")
    told = json.loads((folder / "result" / "result.json").read_text())
    parameters, deviations, trust, reasons, expected, output = registered(coarse, mammogram, table)
    assert parameters == {entry["name"]: entry["value"] for entry in told["parameters"]}, (parameters, told["parameters"])
    assert parameters["thickness"] != 50 and parameters["lateral"] != 0  # the search has left its start
    assert [trust, reasons] == [told["trust"]["level"], told["trust"]["reasons"]], (trust, reasons, told["trust"])
    assert expected == [told["expectedError"]["medianMm"], told["expectedError"]["most95Mm"]], (expected, told["expectedError"])

    found = mammoray.register(mammoray.LabelVolume(labels, (2, 2, 2), origin), mammogram, materials=str(table), orientation="ALS",
                              free=FREE, simulation_mesh=(points(coarse), cells(coarse), regions(coarse)))
    assert found.parameters == parameters, (found.parameters, parameters)
    assert {free: found.deviations[free] for free in FREE} == {free: deviations[free] for free in FREE}
    assert [found.trust, list(found.trust_reasons)] == [trust, reasons]
    assert list(found.expected_error) == expected
    assert found.tissue == "labels"
    assert (found.points == points(output)).all() and (found.tetrahedra == cells(output)).all()
    assert (found.regions == regions(output)).all()
