# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # From a label volume to a registered mammogram
#
# Labels are an array, meshes and pictures come back as arrays; between them stand VTK filters that work only on what has changed.
# Run it cell by cell, or as `python3 docs/tutorials/python_registration.py FOLDER`: FOLDER receives the pictures. Lengths are mm.

# %%
import gzip
import pathlib
import sys

import mammoray
import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

try:
    import matplotlib.pyplot as plt
except ImportError:
    print("no matplotlib: apt install python3-matplotlib")
    sys.exit(125)

data = pathlib.Path("Data/victre-phantom-1")
folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
folder.mkdir(exist_ok=True)

# %% [markdown]
# ## Labels
#
# An NRRD file is a header, an empty line and the voxels, first axis fastest. These are of the FDA's phantom 1: +x to the front, +y to
# the left, +z up, which is the orientation ALS. Any array (k, j, i) of whole numbers will do.

# %%
header, voxels = (data / "labels.nrrd").read_bytes().split(b"\n\n", 1)
fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line)
size = [int(number) for number in fields["sizes"].split()]
origin = [float(number) for number in fields["space origin"].strip("()").split(",")]
spacing = float(fields["space directions"].strip("(").split(",")[0])  # the same along all three axes
labels = numpy.frombuffer(gzip.decompress(voxels), numpy.uint8).reshape(size[::-1])

image = vtkImageData()
image.SetDimensions(size)
image.SetSpacing(spacing, spacing, spacing)
image.SetOrigin(origin)
image.GetPointData().SetScalars(numpy_to_vtk(labels.ravel(), deep=True))

# %% [markdown]
# ## Two meshes
#
# One of the anatomy, to be X-rayed, and a coarse one for the mechanics. Both are coarser here than for a real case, so that it takes
# seconds: for one leave the cell sizes at their defaults and LabelSpacingMm at 0.5.

# %%
anatomy = mammoray.vtkBreastMesher()
anatomy.SetInputData(image)
anatomy.SetMaterialTable("victre")
anatomy.SetLabelSpacingMm(2.5)
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
# ## Between the plates
#
# The coarse mesh is compressed and carries the anatomy along. "Displacement" is an array of the result; its field arrays tell forces,
# and where the unit stands.

# %%
compression = mammoray.vtkBreastCompression()
compression.SetInputConnection(anatomy.GetOutputPort())
compression.SetSimulationMeshConnection(coarse.GetOutputPort())
compression.SetMaterialTable("victre")
compression.SetOrientation("ALS")
compression.SetThicknessMm(60)
compression.SetAnteriorMm(5)  # as far in front of the chest wall, which does not move
compression.Update()
displacement = vtk_to_numpy(compression.GetOutput().GetPointData().GetArray("Displacement"))
force = vtk_to_numpy(compression.GetOutput().GetFieldData().GetArray("PaddleForceN"))[0]
print(f"60 mm, {force:.1f} N, tissue moves by up to {numpy.linalg.norm(displacement, axis=1).max():.1f} mm")

figure, axis = plt.subplots(figsize=(6, 4))
near = numpy.flatnonzero(numpy.abs(points[:, 1] - numpy.median(points[:, 1])) < 4)[::8]
axis.quiver(points[near, 0], points[near, 2], displacement[near, 0], displacement[near, 2], angles="xy", scale_units="xy",
            scale=1, width=0.003, color="tab:blue")
axis.set(aspect="equal", xlabel="to the front, mm", ylabel="up, mm", title="how the tissue moves (8 mm in the middle)")
figure.savefig(folder / "displacement.png", dpi=90, bbox_inches="tight")

# %% [markdown]
# ## Registration
#
# Which compression and pose of the unit explain this mammogram? The header tells view, side and thickness; the search starts there.

# %%
mammogram = mammoray.vtkMammogramReader()
mammogram.SetFileName(str(data / "victre1_lcc_processing.dcm"))
registration = mammoray.vtkBreastRegistration()
registration.SetInputConnection(anatomy.GetOutputPort())
registration.SetMammogramConnection(mammogram.GetOutputPort())
registration.SetSimulationMeshConnection(coarse.GetOutputPort())
registration.SetMaterialTable("victre")
registration.SetOrientation("ALS")
registration.SetPixelSizesMm(6, 3)
registration.Update()
result = registration.GetOutput().GetFieldData()
if result.GetArray("Parameters") is None:
    sys.exit(125)  # no Vulkan device, as the message above says
names = [result.GetAbstractArray("ParameterNames").GetValue(index) for index in range(9)]
values, deviations = (vtk_to_numpy(result.GetArray(name)) for name in ("Parameters", "ParameterDeviations"))
for name, value, deviation in zip(names, values, deviations):
    print(f"{name:10} {value:8.2f}" + (f" +- {deviation:.2f}" if numpy.isfinite(deviation) else "  (fixed)"))
correlation = vtk_to_numpy(result.GetArray("Correlation"))[0]
outline = vtk_to_numpy(result.GetArray("MeanOutlineDistanceMm"))[0]
print(f"correlation {correlation:.3f}, outlines {outline:.2f} mm apart")

# %% [markdown]
# ## The synthetic mammogram
#
# Taken on the mammogram's own pixels. Another beam, or another place of the source, would not compress again.

# %%
real = mammogram.GetOutput()
columns, rows, _ = real.GetDimensions()
projector = mammoray.vtkXRayProjector()
projector.SetInputConnection(registration.GetOutputPort())
projector.PlacedByInputOn()
projector.SetPixelSpacing(real.GetSpacing()[:2])
projector.SetDetectorSize(columns, rows)
projector.SetMaterialTable("victre")
projector.SetSpectrum("W28kVp_Rh50um_Be1mm")
projector.Update()
synthetic = vtk_to_numpy(projector.GetOutput().GetPointData().GetArray("LogAttenuation")).reshape(rows, columns)
counts = vtk_to_numpy(real.GetPointData().GetScalars()).reshape(rows, columns)[::-1]  # VTK has row 0 at the bottom
measured = -numpy.log(numpy.maximum(counts, 1) / numpy.median(counts[:, -20:]))  # of air

breast = (synthetic > 0.1) & (measured > 0.1)
score = lambda picture: numpy.where(breast, (picture - picture[breast].mean()) / picture[breast].std(), numpy.nan)
figure, axes = plt.subplots(1, 3, figsize=(10, 5.2))
for axis, picture, title in zip(axes, (score(measured), score(synthetic), score(synthetic) - score(measured)),
                                ("target (FDA phantom, simulated)", "synthetic", "difference, sd")):
    axis.set_facecolor("black")
    shown = axis.imshow(picture, vmin=-2.5, vmax=2.5, cmap="RdBu_r" if title.startswith("difference") else "gray")
    axis.set(title=title, xticks=[], yticks=[])
figure.colorbar(shown, ax=axes, shrink=0.7)
figure.savefig(folder / "mammograms.png", dpi=90, bbox_inches="tight")

# %%
# The tests check this.
assert correlation > 0.9 and outline < 2
assert 45 < values[0] < 55  # the FDA's own compression: 49.8 mm
