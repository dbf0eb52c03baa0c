"""MammoRay: synthetic X-rays of meshes and registration of breast MRI with mammograms.

The classes here are VTK algorithms and work with everything in `vtkmodules`:

    vtkBreastMesher        labels (vtkImageData) -> tetrahedra with a material each
    vtkBreastCompression   tetrahedra -> the same between two plates
    vtkXRayProjector       tetrahedra or triangles -> transmission and path lengths per material
    vtkBreastRegistration  tetrahedra or labels, and a mammogram -> the compression that matches it
    vtkMammogramReader     DICOM MG -> vtkImageData

Lengths are mm, pressures kPa, energies keV, angles degrees. `help(vtkBreastMesher)` tells shapes, units
and frames. Arrays go in and out by `vtkmodules.util.numpy_support`: points are n x 3 doubles, an array
(k, j, i) of labels becomes an image by `numpy_to_vtk(labels.ravel())` and SetDimensions(i, j, k).

Keep a source in a variable until it is connected: GetOutputPort() of a temporary crashes the
interpreter, as in all of VTK 9.1. An error is printed and leaves the output empty; AddObserver
("ErrorEvent", ...) tells a program.
"""
from .mammorayFilters import *  # noqa: F401,F403
