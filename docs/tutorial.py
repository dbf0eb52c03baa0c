# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # From a label volume to a registered mammogram
#
# Labels are an array, meshes and pictures come back as arrays; in between stand VTK filters that work only on what has changed. Run it
# cell by cell, or as `python3 tutorial.py FOLDER`, where FOLDER receives the pictures. Lengths are mm.
import gzip
import pathlib
import sys

import mammoray
import matplotlib.pyplot as plt
import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

data = pathlib.Path(__file__).resolve().parent.parent / "Data" / "victre-phantom-1"
folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
folder.mkdir(exist_ok=True)

# %% [markdown]
# ## Labels
# An NRRD file is a header, an empty line, and the voxels, first axis fastest. These are the FDA's phantom 1: +x anterior, +y left,
# +z superior, which is the orientation code ALS. Any array (k, j, i) of whole numbers will do.
# %%
header, voxels = (data / "labels.nrrd").read_bytes().split(b"\n\n", 1)
fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line)
size = [int(number) for number in fields["sizes"].split()]
triples = lambda text: [[float(number) for number in vector.split(",")] for vector in text.strip("()").split(") (")]
steps, origin = triples(fields["space directions"]), triples(fields["space origin"])[0]
labels = numpy.frombuffer(gzip.decompress(voxels), numpy.uint8).reshape(size[::-1])

image = vtkImageData()
image.SetDimensions(*size)
image.SetSpacing(*(numpy.linalg.norm(step) for step in steps))
image.SetOrigin(*origin)
image.GetPointData().SetScalars(numpy_to_vtk(labels.ravel(), deep=True))

# %% [markdown]
# ## Meshes
# One of the anatomy, to be X-rayed, and a coarse one for the mechanics. Both are coarser here than for a real case, to be quick: leave
# LabelSpacingMm at 0.5 and the cell sizes at their defaults then.
# %%
anatomy = mammoray.vtkBreastMesher()
anatomy.SetInputData(image)
anatomy.SetMaterialTable("victre")
anatomy.SetLabelSpacingMm(1.5)
anatomy.SetCellSizeMm(8)
coarse = mammoray.vtkBreastMesher()
coarse.SetInputData(image)
coarse.SetMaterialTable("victre")
coarse.ForMechanicsOn()
coarse.SetCellSizeMm(22)
anatomy.Update()
points = vtk_to_numpy(anatomy.GetOutput().GetPoints().GetData())  # n x 3
material = vtk_to_numpy(anatomy.GetOutput().GetCellData().GetArray("Material"))
print(f"{len(points)} points, {len(material)} tetrahedra of the materials {numpy.unique(material)}")

# %% [markdown]
# ## Registration
# %%
mammogram = mammoray.vtkMammogramReader()
mammogram.SetFileName(str(data / "victre1_lcc_processing.dcm"))
registration = mammoray.vtkBreastRegistration()
registration.SetInputConnection(anatomy.GetOutputPort())
registration.SetMammogramConnection(mammogram.GetOutputPort())
registration.SetSimulationMeshConnection(coarse.GetOutputPort())
registration.SetMaterialTable("victre")
registration.SetOrientation("ALS")
registration.SetPixelSizesMm(6, 6)
registration.SetMaximumIterations(4)
registration.Update()
compressed = registration.GetOutput()
if compressed.GetNumberOfCells() == 0:
    sys.exit(125)  # no Vulkan device; the message is above
result = compressed.GetFieldData()
names = [result.GetAbstractArray("ParameterNames").GetValue(index) for index in range(9)]
values = vtk_to_numpy(result.GetArray("Parameters"))
deviations = vtk_to_numpy(result.GetArray("ParameterDeviations"))
for name, value, deviation in zip(names, values, deviations):
    print(f"{name:10} {value:8.2f}" + (f" +- {deviation:.2f}" if numpy.isfinite(deviation) else "  (fixed)"))
correlation = vtk_to_numpy(result.GetArray("Correlation"))[0]
print(f"correlation {correlation:.3f}, outline {vtk_to_numpy(result.GetArray('MeanOutlineDistanceMm'))[0]:.2f} mm")
assert correlation > 0.9

# %% [markdown]
# ## The synthetic mammogram
# "Placement" is where the unit stands: origin and axes of the gantry frame. The receptor is its plane z = 0; this picture's columns run along +y,
# its rows along -x, as the mammogram's do. Another beam or another source would not compress again.
# %%
gantry, x, y, z = vtk_to_numpy(result.GetArray("Placement"))
real = mammogram.GetOutput()
columns, rows, _ = real.GetDimensions()
spacing = real.GetSpacing()[0]
projector = mammoray.vtkXRayProjector()
projector.SetInputConnection(registration.GetOutputPort())
projector.SetSourcePosition(*(gantry + 650 * z))
projector.SetDetectorOrigin(*(gantry + 0.5 * (rows - 1) * spacing * x + 0.5 * spacing * y))
projector.SetColumnDirection(*y)
projector.SetRowDirection(*-x)
projector.SetPixelSpacing(spacing, spacing)
projector.SetDetectorSize(columns, rows)
projector.SetMonochromatic(20)
materials = anatomy.GetOutput().GetFieldData().GetAbstractArray("MaterialNames")
attenuation = {"fat": ("adipose", 0.92), "gland": ("glandular", 1.035), "skin": ("skin", 1.09), "muscle": ("muscle", 1.05)}
for index in range(1, materials.GetNumberOfValues()):
    projector.SetAttenuationTable(index, *attenuation[materials.GetValue(index)])
projector.Update()
synthetic = vtk_to_numpy(projector.GetOutput().GetPointData().GetArray("LogAttenuation")).reshape(rows, columns)
counts = vtk_to_numpy(real.GetPointData().GetScalars()).reshape(rows, columns)[::-1]  # row 0 at the bottom in VTK
measured = -numpy.log(numpy.maximum(counts, 1) / numpy.median(counts[:, -20:]))

# %%
breast = (synthetic > 0.1) & (measured > 0.1)
score = lambda picture: (picture - picture[breast].mean()) / picture[breast].std()
figure, axes = plt.subplots(1, 3, figsize=(10, 5.2))
for axis, picture, title in zip(axes, (score(measured), score(synthetic), score(synthetic) - score(measured)),
                                ("real", "synthetic", "synthetic - real, standard deviations")):
    difference = title.startswith("synthetic -")
    shown = axis.imshow(numpy.where(breast, picture, numpy.nan if difference else -3), vmin=-2.5, vmax=2.5,
                        cmap="RdBu_r" if difference else "gray")
    axis.set_title(title, fontsize=10)
    axis.axis("off")
figure.colorbar(shown, ax=axes, shrink=0.7)
figure.savefig(folder / "mammograms.png", dpi=90)

# %% [markdown]
# ## How the tissue moved
# %%
displacement = vtk_to_numpy(compressed.GetPointData().GetArray("Displacement"))
figure, axis = plt.subplots(figsize=(6, 4))
axis.scatter(points[::20, 0], points[::20, 2], s=2, c="0.7", label="MRI")
moved = points + displacement
axis.scatter(moved[::20, 0], moved[::20, 2], s=2, c="tab:blue", label="between the plates")
axis.set(aspect="equal", xlabel="anterior, mm", ylabel="superior, mm")
axis.legend()
figure.savefig(folder / "displacement.png", dpi=90)
