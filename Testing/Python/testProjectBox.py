# SPDX-License-Identifier: Apache-2.0
"""Imports the package and compares the projection of a box with its closed form. Exit 125: no device."""
import math
import sys

import mammoray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkCubeSource

box = vtkCubeSource()
box.SetBounds(-40, 40, -30, 30, 10, 30)
triangles = vtkTriangleFilter()
triangles.SetInputConnection(box.GetOutputPort())

projector = mammoray.vtkXRayProjector()
projector.SetInputConnection(triangles.GetOutputPort())
projector.SetSourcePosition(0, 0, 400)
projector.SetDetectorOrigin(-9.5, -4.5, 0)
projector.SetPixelSpacing(1, 1)
projector.SetDetectorSize(20, 10)
projector.SetKey("attenuations.1", "0.05/mm")

if not mammoray.devices():
    print("no Vulkan device")
    sys.exit(125)
projector.Update()
image = projector.GetOutput()
lengths = vtk_to_numpy(image.GetPointData().GetArray("PathLength_1"))
logarithm = vtk_to_numpy(image.GetPointData().GetArray("LogAttenuation"))
assert len(lengths) == 200
for pixel in range(200):
    x, y, _ = image.GetPoint(pixel)
    expected = 20 * math.sqrt(x * x + y * y + 400 * 400) / 400
    # The source's points are floats that hold the box exactly; the result is a float.
    assert abs(lengths[pixel] - expected) < 1e-5, (pixel, lengths[pixel], expected)
    assert abs(logarithm[pixel] - 0.05 * expected) < 1e-6
print("200 pixels as expected")
