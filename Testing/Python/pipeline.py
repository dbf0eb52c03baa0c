# SPDX-License-Identifier: Apache-2.0
"""Shared by the Python tests: numpy arrays to VTK and back, and a small breast."""
import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

TABLE = """{ "materials": [
  { "name": "air", "labels": [0] },
  { "name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92,
    "youngs_modulus_kpa": 6, "poisson_ratio": 0.48 },
  { "name": "gland", "labels": [3], "attenuation": "glandular", "density_g_per_cm3": 1.03,
    "youngs_modulus_kpa": 12, "poisson_ratio": 0.48 },
  { "name": "wall", "labels": [2], "attenuation": "muscle", "density_g_per_cm3": 1.05, "fixed": true } ] }"""


def half_ball_labels(radius=30.0, spacing=2.0):
    """Labels (k, j, i) of half a ball on the plane y = 0, its front towards +y, wall to y = 6 mm, two pieces of gland inside, as
    high and to the sides as a roll needs to be seen.

    Gives labels (uint16) and the place of voxel (0, 0, 0), mm; +x left, +y anterior, +z superior (orientation LAS)."""
    axis = numpy.arange(-radius - 3, radius + 3.1, spacing)
    z, y, x = numpy.meshgrid(axis, axis[axis > -3], axis, indexing="ij")
    labels = numpy.where((y > 0) & (x * x + y * y + z * z < radius * radius), 1, 0)
    for left, front, up in ((9, 14, 10), (-8, 16, -11)):
        labels[(labels == 1) & ((x - left) ** 2 + (y - front) ** 2 + (z - up) ** 2 < 64)] = 3
    labels[(labels > 0) & (y < 6)] = 2
    return labels.astype(numpy.uint16), (axis[0], axis[axis > -3][0], axis[0])


def image(array, origin, spacing):
    """vtkImageData of an array (k, j, i)."""
    data = vtkImageData()
    data.SetDimensions(*array.shape[::-1])
    data.SetOrigin(*origin)
    data.SetSpacing(spacing, spacing, spacing)
    data.GetPointData().SetScalars(numpy_to_vtk(array.ravel(), deep=True))
    return data


def points(grid):
    """Points of a grid, n x 3, mm."""
    return vtk_to_numpy(grid.GetPoints().GetData())


def cells(grid):
    """Corners of the tetrahedra of a grid, m x 4."""
    return vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)


def field(grid, name):
    """Field array of a grid."""
    return vtk_to_numpy(grid.GetFieldData().GetArray(name))
