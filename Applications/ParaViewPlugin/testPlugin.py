# SPDX-License-Identifier: Apache-2.0
"""The plugin in pvpython, without a window: its filters in a pipeline, its reader, a series, and openResult.py on a result.

testPlugin.py FOLDER: receives pictures and the state. Exit 125: no Vulkan device."""
import json
import os
import shutil
import sys

import vtk
from paraview import simple
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import numpy

here = os.path.dirname(os.path.abspath(__file__))
root = os.path.dirname(os.path.dirname(here))
sys.path.insert(0, here)
import openResult

folder = sys.argv[1]
os.makedirs(folder, exist_ok=True)
plugin = os.path.join(os.environ["PV_PLUGIN_PATH"], "MammoRay.so")
simple.LoadPlugin(plugin, remote=False, ns=globals())
openResult.simple.LoadPlugin(plugin, remote=False, ns=vars(simple))

# The reader, and the filters' names in the menu.
mammogram = simple.MammogramReader(FileName=os.path.join(root, "Data/victre-phantom-1/victre1_lcc_processing.dcm"))
mammogram.UpdatePipeline()
assert mammogram.GetDataInformation().GetPointDataInformation().GetArrayInformation("Mammogram")
manager = simple.servermanager.vtkSMProxyManager.GetProxyManager().GetActiveSessionProxyManager()
for name, label in (("BreastMesher", "Breast Mesher"), ("BreastCompression", "Breast Compression"),
                    ("XRayProjector", "X-ray Projector"), ("BreastRegistration", "Breast Registration")):
    prototype = manager.GetPrototypeProxy("filters", name)
    assert prototype.GetXMLLabel() == label and prototype.GetHints().FindNestedElementByName("ShowInMenu")

# Shipped tables and spectra are there to choose from.
def shipped(kind, extension):
    return {os.path.splitext(name)[0] for name in os.listdir(os.path.join(root, "Data", kind)) if name.endswith(extension)}


for name in ("BreastMesher", "BreastCompression", "XrayProjector", "BreastRegistration"):
    chosen = getattr(simple.servermanager.filters, name)()
    assert set(chosen.GetProperty("MaterialTable").Available) - {""} == shipped("materials", ".json")
    assert chosen.MaterialTable == "victre"
    if hasattr(chosen, "Spectrum"):
        assert set(chosen.GetProperty("Spectrum").Available) - {""} == shipped("spectra", ".spc")

# Labels to meshes, between the plates in steps, to an X-ray. LAS: +y to the front.
axis = numpy.arange(-33, 33.1, 2.0)
z, y, x = numpy.meshgrid(axis, axis[axis > -3], axis, indexing="ij")
labels = numpy.where((y > 0) & (x * x + y * y + z * z < 900), 1, 0)
labels[(labels == 1) & ((x - 9) ** 2 + (y - 14) ** 2 + (z - 10) ** 2 < 64)] = 2
labels[(labels > 0) & (y < 6)] = 3
table = os.path.join(folder, "table.json")
with open(table, "w", encoding="utf-8") as file:
    json.dump({"materials": [
        {"name": "air", "labels": [0]},
        {"name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92, "youngs_modulus_kpa": 6, "poisson_ratio": 0.48},
        {"name": "gland", "labels": [2], "attenuation": "glandular", "density_g_per_cm3": 1.03, "youngs_modulus_kpa": 12, "poisson_ratio": 0.48},
        {"name": "wall", "labels": [3], "attenuation": "muscle", "density_g_per_cm3": 1.05, "fixed": True}]}, file)
volume = vtk.vtkImageData()
volume.SetDimensions(labels.shape[::-1])
volume.SetOrigin(axis[0], axis[axis > -3][0], axis[0])
volume.SetSpacing(2, 2, 2)
scalars = numpy_to_vtk(labels.astype(numpy.uint16).ravel(), deep=True)
scalars.SetName("Labels")
volume.GetPointData().SetScalars(scalars)
source = simple.TrivialProducer(registrationName="labels")
source.GetClientSideObject().SetOutput(volume)
anatomy = simple.BreastMesher(Input=source, MaterialTableFile=table, CellSizeMm=8)
coarse = simple.BreastMesher(Input=source, MaterialTableFile=table, CellSizeMm=11, ForMechanics=1)
compression = simple.BreastCompression(Input=anatomy, SimulationMesh=coarse, MaterialTableFile=table, Orientation="LAS",
                                       ThicknessMm=52, NumberOfTimeSteps=3)
compression.UpdatePipeline(1.0)
assert list(compression.TimestepValues) == [0.0, 0.5, 1.0]
closed = simple.ForceTime(Input=compression, ForcedTime=1.0)
squeezed = simple.servermanager.Fetch(closed)
assert squeezed.GetNumberOfCells() > 1000
displacement = vtk_to_numpy(squeezed.GetPointData().GetArray("Displacement"))
furthest = numpy.abs(displacement[:, 2]).max()
# 58 mm high where the plates begin, and 60 at the chest wall, which is held.
assert 1.5 < furthest < 4, f"58 mm to 52: {furthest} mm"
xray = simple.XrayProjector(Input=closed, MaterialTableFile=table, PixelSpacing=[1, 1], DetectorSize=[45, 90])
xray.UpdatePipeline()
picture = simple.servermanager.Fetch(xray)
if picture.GetNumberOfPoints() == 0 or not picture.GetPointData().GetArray("LogAttenuation"):
    print("no X-ray: no Vulkan device")
    sys.exit(125)
logarithm = vtk_to_numpy(picture.GetPointData().GetArray("LogAttenuation"))
# 52 mm of fat and muscle at about 18 keV, and air beside it.
assert logarithm.min() == 0 and 2 < logarithm.max() < 5, logarithm.max()
# Scatter adds to it, a grid takes most of that away; noise is on top.
xray.Scatter = "kernels"
xray.UpdatePipeline()
scattered = vtk_to_numpy(simple.servermanager.Fetch(xray).GetPointData().GetArray("LogAttenuation"))
xray.GridRatio = "5"
xray.PhotonsPerPixel = "1e5"
xray.UpdatePipeline()
behind = vtk_to_numpy(simple.servermanager.Fetch(xray).GetPointData().GetArray("LogAttenuation"))
middle = logarithm > 0.8 * logarithm.max()
assert scattered[middle].mean() + 0.05 < behind[middle].mean() < logarithm[middle].mean() - 0.01
xray.Scatter, xray.GridRatio, xray.PhotonsPerPixel = "", "", ""
low = numpy.array(picture.GetBounds()[::2])
assert low[2] < -25, "below the support, in place"

# A scene from its file: a water ball of 10 mm in parallel rays of 20 keV, its chord by Euclid.
ball = vtk.vtkSphereSource()
ball.SetRadius(10)
ball.SetThetaResolution(200)
ball.SetPhiResolution(200)
writer = vtk.vtkSTLWriter()
writer.SetInputConnection(ball.GetOutputPort())
writer.SetFileName(os.path.join(folder, "ball.stl"))
assert writer.Write() == 1
with open(os.path.join(folder, "scene.json"), "w", encoding="utf-8") as file:
    json.dump({"samples": [{"file": "ball.stl", "material": "H2O@1"}], "beam": {"kev": 20},
               "source": {"beam-direction": [0, 0, -1]},
               "detector": {"origin": [-15, 0, -50], "column-direction": [1, 0, 0], "row-direction": [0, 1, 0], "columns": 31, "rows": 1,
                            "pixel-spacing": 1}}, file)
scene = simple.XrayofaScene(SceneFile=os.path.join(folder, "scene.json"))
scene.UpdatePipeline()
chords = vtk_to_numpy(simple.servermanager.Fetch(scene).GetPointData().GetArray("PathLength_H2O@1"))
exact = 2 * numpy.sqrt(numpy.maximum(0, 100 - numpy.arange(-15, 16) ** 2.0))
inside = numpy.abs(numpy.arange(-15, 16)) < 9
assert numpy.abs(chords - exact)[inside].max() < 0.005, "the ball's triangles lie up to 0.0013 mm inside it"

# A result as 'mammoray register' writes it, made of the above; its series.
result = os.path.join(folder, "result")
os.makedirs(result, exist_ok=True)
rest = simple.servermanager.Fetch(anatomy)
rest.GetPointData().AddArray(squeezed.GetPointData().GetArray("Displacement"))
for name, grid in (("uncompressed", rest), ("compressed", squeezed)):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(os.path.join(result, name + ".vtu"))
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()  # inline, as MammoRay writes it: VTK 9.1 cannot read what it appends raw with a newer expat
    assert writer.Write() == 1
placement = vtk_to_numpy(squeezed.GetFieldData().GetArray("Placement")).tolist()
with open(os.path.join(result, "result.json"), "w", encoding="utf-8") as file:
    json.dump({"formatVersion": openResult.FORMAT_VERSION, "placement": dict(zip(("originMm", "x", "y", "z"), placement)),
               "unit": {"sourceToDetectorMm": 650}, "mammogram": {"laterality": "L"},
               "inputs": [{"role": "Material table", "file": table}], "spectrum": "W28kVp_Rh50um_Be1mm",
               "grid": {"columns": 90, "rows": 180, "originMm": [44.75, 0.25], "columnStepMm": [0, 0.5], "rowStepMm": [-0.5, 0]}},
              file)
series = os.path.join(folder, "series.pvd")
for step, name in enumerate(("uncompressed", "compressed")):
    shutil.copy(os.path.join(result, name + ".vtu"), os.path.join(folder, f"series_{step:03}.vtu"))
with open(series, "w", encoding="utf-8") as file:
    file.write('<VTKFile type="Collection" version="0.1"><Collection>'
               + "".join(f'<DataSet timestep="{step}" part="0" file="series_{step:03}.vtu"/>' for step in range(2))
               + "</Collection></VTKFile>")
opened = simple.OpenDataFile(series)
opened.UpdatePipeline(1.0)
assert list(opened.TimestepValues) == [0.0, 1.0]

def start_again():
    simple.ResetSession()
    simple.LoadPlugin(plugin, remote=False, ns=vars(simple))


def source_names():
    # A loaded state calls readers as their files.
    return {name.removesuffix(".vtu") for name, _ in simple.GetSources()}


parts = {"uncompressed", "compressed", "displacement", "X-ray", "rays through the lesion", "lesion"}
state = os.path.join(folder, "result.pvsm")
start_again()
view = openResult.open_result(result, [9, 14, 10], 4)
view.ViewSize = [900, 600]
simple.SaveScreenshot(os.path.join(folder, "result.png"), view)
assert parts <= source_names(), source_names()
simple.SaveState(state)
start_again()
simple.LoadState(state)
assert parts <= source_names(), source_names()
simple.SaveScreenshot(os.path.join(folder, "state.png"), simple.GetActiveView())
# The state's picture is the same: a few pixels may differ where surfaces cross.
pictures = []
for name in ("result.png", "state.png"):
    reader = vtk.vtkPNGReader()
    reader.SetFileName(os.path.join(folder, name))
    reader.Update()
    pictures.append(reader.GetOutput())
assert vtk_to_numpy(pictures[0].GetPointData().GetScalars()).std() > 20, "something is shown"
assert pictures[0].GetDimensions() == pictures[1].GetDimensions()
difference = numpy.abs(numpy.subtract(*(vtk_to_numpy(picture.GetPointData().GetScalars()).astype(float) for picture in pictures)))
assert difference.mean() < 2, difference.mean()
print("filters, reader, series, result and state as expected")
