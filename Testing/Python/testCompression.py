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
    compression.SetChestWallToHeld()
    compression.SetForceN(2 * force)
    compression.Update()
    assert field(compression.GetOutput(), "ThicknessMm")[0] < 50, "more force, less thickness"
print(f"{force:.2f} N at 50 mm")
sys.exit(0)
