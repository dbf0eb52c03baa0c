# SPDX-License-Identifier: Apache-2.0
"""A breast between the plates: thickness, force, chest wall, elements."""
import sys
import tempfile

import mammoray
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy

from pipeline import TABLE, field, half_ball_labels, image, points

labels, origin = half_ball_labels()
with tempfile.NamedTemporaryFile("w", suffix=".json") as table:
    table.write(TABLE)
    table.flush()
    mesher = mammoray.vtkBreastMesher()
    mesher.SetInputData(image(labels, origin, 2.0))
    mesher.SetMaterialTable(table.name)
    mesher.ForMechanicsOn()
    mesher.SetCellSizeMm(11)
    compression = mammoray.vtkBreastCompression()
    compression.SetInputConnection(mesher.GetOutputPort())
    compression.SetMaterialTable(table.name)
    compression.SetOrientation("LAS")
    compression.SetElementToLinear()
    compression.SetThicknessMm(50)
    compression.Update()
    squeezed = points(compression.GetOutput())
    front = squeezed[squeezed[:, 1] > 12]
    assert numpy.ptp(front[:, 2]) < 50, "between the plates"
    assert field(compression.GetOutput(), "ThicknessMm")[0] == 50
    force = field(compression.GetOutput(), "PaddleForceN")[0]
    shift = vtk_to_numpy(compression.GetOutput().GetPointData().GetArray("Displacement"))
    assert numpy.allclose(points(mesher.GetOutput()) + shift, squeezed)

    compression.SetChestWallToSliding()
    compression.Update()
    assert field(compression.GetOutput(), "PaddleForceN")[0] < force, "a wall that gives way"
    compression.SetChestWallToFixed()
    compression.SetForceN(2 * force)
    compression.Update()
    assert field(compression.GetOutput(), "ThicknessMm")[0] < 50, "more force, less thickness"
# Beyond 20,000 cells the simulation runs on a coarse mesh that is made for it, as in the command: some seconds, where the fine mesh
# itself takes minutes. Its skin stands out of the coarse one's facets by some tenths of a millimetre.
materials = {1: mammoray.Material(youngs_modulus=6, poisson_ratio=0.48), 2: mammoray.Material(fixed=True),
             3: mammoray.Material(youngs_modulus=12, poisson_ratio=0.48)}
fine = mammoray.mesh(labels, (2, 2, 2), origin=origin, materials=materials, cell_size=2.2)
assert len(fine.cells) > 20000
told = []
carried = mammoray.compress(fine.points, fine.cells, fine.regions, materials=materials, orientation="LAS", thickness=50,
                            progress=told.append)
front = carried.points[carried.points[:, 1] > 12]
assert carried.thickness == 50 and numpy.ptp(front[:, 2]) < 50.5 and max(told) <= 1
assert numpy.allclose(fine.points + carried.displacement, carried.points)
# Held tissue stays; what is carried keeps its volume within some percent in the middle.
assert abs(carried.displacement[fine.points[:, 1] < 2]).max() < 0.5
assert abs(numpy.median(carried.volume_ratio) - 1) < 0.05
print(f"{force:.2f} N at 50 mm, {carried.force:.2f} N of the fine mesh")
sys.exit(0)
