# SPDX-License-Identifier: Apache-2.0
"""The VTK algorithms raise what goes wrong, take properties as keywords, and do again only what has changed."""
import contextlib
import io
import os
import signal
import sys
import threading
import warnings

import mammoray
import numpy
from vtkmodules.vtkCommonCore import vtkLogger
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkSphereSource
from vtkmodules.vtkIOImage import vtkPNGWriter

from pipeline import half_ball_labels, image


def raises(expected, call, *arguments, **keywords):
    try:
        call(*arguments, **keywords)
    except mammoray.Error as error:
        assert expected in str(error) and "\n" not in str(error) and "0x" not in str(error), error
        return
    raise AssertionError(f"not raised: {expected}")


sphere = vtkSphereSource()
projector = mammoray.vtkXRayProjector(PixelSpacing=(0.5, 0.25), DetectorSize=(8, 4), MaterialTable="victr")
assert projector.GetPixelSpacing() == (0.5, 0.25) and projector.GetDetectorSize() == (8, 4)
raises("expected an input or a SceneFile with samples, found neither", projector.Update)
projector.SetInputConnection(sphere.GetOutputPort())
raises("did you mean victre?", projector.Update)
raises("did you mean victre?", projector.Update)  # still
raises("no property 'PixelSpacng'; did you mean PixelSpacing", mammoray.vtkXRayProjector, PixelSpacng=1)
raises("PixelSpacing='wide'", mammoray.vtkXRayProjector, PixelSpacing="wide")
raises("expected a material in [1, 65535], found 0", mammoray.vtkBreastCompression().SetMaterial, 0, 1.0, 0.4, False)
raises("no quantity 'beam.kve'", projector.SetKey, "beam.kve", "19")
raises("SetKey beam.kev: expected a number from 1 to 500", projector.SetKey, "beam.kev", "999")
raises("no file", mammoray.vtkMammogramReader(FileName="/nowhere.dcm").Update)

# A filter also raises the failures of the filters before it.
mesher = mammoray.vtkBreastMesher(MaterialTable="nowhere.json")
labels, origin = half_ball_labels()
mesher.SetInputData(image(labels, origin, 2.0))
compression = mammoray.vtkBreastCompression(Orientation="LAS")
compression.SetInputConnection(mesher.GetOutputPort())
raises("nowhere.json", compression.Update)
# Once mended, nothing of it is left.
mesher.SetMaterialTable("")
mesher.SetCellSizeMm(8)
raises("has no elastic constants", compression.Update)
assert mesher.GetOutput().GetNumberOfCells() > 100

# Where a filter of others updates ours an exception cannot pass: one line.
writer = vtkPNGWriter()
writer.SetFileName(os.devnull)
writer.SetInputConnection(projector.GetOutputPort())
vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)  # what VTK's own filter has to say
with contextlib.redirect_stderr(io.StringIO()) as said:
    writer.Update()
assert said.getvalue().startswith("vtkXRayProjector: material table victr") and said.getvalue().count("\n") == 1, said.getvalue()

# Equal values update nothing.
for algorithm, setters in (
        (mammoray.vtkXRayProjector(), (("SetMaterialTable", "victre"), ("SetSpectrum", "W28kVp_Rh50um_Be1mm"), ("SetDeviceName", "x"),
                                       ("SetKey", "attenuations.1", "0.5/mm"), ("SetKey", "attenuations.2", "adipose@0.9"),
                                       ("SetKey", "beam.kev", "19"), ("SetPixelSpacing", 0.2, 0.2), ("SetKey", "beam.kev", ""))),
        (mammoray.vtkBreastCompression(), (("SetMaterialTable", "victre"), ("SetOrientation", "LAS"), ("SetThicknessMm", 45.0),
                                           ("SetMaterial", 1, 5.0, 0.48, False), ("ClearMaterials",))),
        (mammoray.vtkBreastMesher(), (("SetMaterialTable", "victre"), ("SetCellSizeMm", 3.0))),
        (mammoray.vtkBreastRegistration(), (("SetMaterialTable", "victre"), ("SetSpectrum", "a"), ("SetOrientation", "LAS"),
                                            ("SetFreeParameters", "roll"), ("SetDeviceName", "x"))),
        (mammoray.vtkMammogramReader(), (("SetFileName", "a.dcm"),))):
    for name, *values in setters:
        before = algorithm.GetMTime()
        getattr(algorithm, name)(*values)
        changed = algorithm.GetMTime()
        assert changed > before, name
        getattr(algorithm, name)(*values)
        assert algorithm.GetMTime() == changed, f"{name} again"

# Sizes that nothing can be made of.
for odd, text in (({"cell_size": 1e-3}, "GB of this machine"), ({"label_spacing": -1}, "at least 0"),
                  ({"triangles": 2**31}, "expected 0 to 2147483647"), ({"triangles": -1}, "expected 0 to")):
    try:
        mammoray.mesh(labels, (2, 2, 2), **odd)
        raise AssertionError(f"{odd} taken")
    except mammoray.Error as error:
        assert text in str(error), error

# Inputs that are no breast.
raises("breast: expected a Mesh or its points", mammoray.register, labels, "a.dcm", materials="victre")
raises("breast.spacing: ", mammoray.register, mammoray.LabelVolume(labels, (2, 2)), "a.dcm", materials="victre")
raises("breast.labels: ", mammoray.register, mammoray.LabelVolume(labels[0], (2, 2, 2)), "a.dcm", materials="victre")

# Ctrl-C stops the work, which is done anew when it is asked for.
table = {1: mammoray.Material(youngs_modulus=6), 2: mammoray.Material(fixed=True), 3: mammoray.Material(youngs_modulus=12)}
mesh = mammoray.mesh(labels, (2, 2, 2), origin=origin, cell_size=5, materials=table)
told = []


def interrupt(done):
    told.append(done)
    if len(told) == 2:
        os.kill(os.getpid(), signal.SIGINT)


try:
    mammoray.compress(mesh.points, mesh.cells, mesh.regions, materials=table, orientation="LAS", progress=interrupt)
    raise AssertionError("not interrupted")
except KeyboardInterrupt:
    pass
assert len(told) < 20 and signal.getsignal(signal.SIGINT) is signal.default_int_handler

# Another thread works, too, and has its errors for itself.
found = []


def work():
    try:
        mammoray.vtkMammogramReader(FileName="/elsewhere.dcm").Update()
    except mammoray.Error as error:
        found.append(str(error))


thread = threading.Thread(target=work)
thread.start()
thread.join()
assert len(found) == 1 and "elsewhere" in found[0]

# Warnings are Python's. Exit 125: no device.
try:
    print(mammoray.Projector().device)
except mammoray.DeviceError as error:
    print(error)
    sys.exit(125)
cube = vtkCubeSource()
triangles = vtkTriangleFilter()
triangles.SetInputConnection(cube.GetOutputPort())
triangles.Update()
open_cube = triangles.GetOutput()
open_cube.BuildLinks()
open_cube.DeleteCell(10)  # of the top
open_cube.RemoveDeletedCells()
leaking = mammoray.vtkXRayProjector(PixelSpacing=(0.1, 0.1), DetectorSize=(8, 8), DetectorOrigin=(-0.35, -0.35, -2),
                                    SourcePosition=(0, 0, 50))
leaking.SetInputData(open_cube)
leaking.SetKey("attenuations.1", "0.5/mm")
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    leaking.Update()
assert any("holes" in str(warning.message) for warning in caught), [str(warning.message) for warning in caught]
print("raised as expected")
