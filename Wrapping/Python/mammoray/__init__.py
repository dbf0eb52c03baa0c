# SPDX-License-Identifier: Apache-2.0
"""MammoRay: synthetic X-rays of meshes and registration of breast MRI with mammograms.

    import mammoray as mr
    part = mr.Sample(mr.read_mesh("part.stl", unit="mm"), "Al")
    scene = mr.Scene(part, beam=mr.Beam(tube="W", kvp=40, filters=["Al:2"]))
    image = scene.expose()                 # image.transmission, image.path_lengths: numpy arrays
    image.save("part.png")

X-rays need numpy only: Scene of Sample (Mesh, Material), Source, Detector, Beam, Scatter and Refraction gives an Exposure; turn and
tomosynthesis a Series; dual_energy two; a Projector keeps a device for loops. `help(mammoray.Detector)` tells fields, units and ranges.

    mesh       labels -> tetrahedra with a material each
    compress   tetrahedra -> the same between the plates of a mammography unit
    register   labels or tetrahedra, and a mammogram -> the compression that matches it

The same as VTK algorithms, which work with everything in `vtkmodules` and take their properties as keywords:

    vtkBreastMesher        labels (vtkImageData) -> tetrahedra with a material each
    vtkBreastCompression   tetrahedra -> the same between two plates
    vtkXRayProjector       tetrahedra or triangles -> transmission and path lengths per material
    vtkBreastRegistration  tetrahedra or labels, and a mammogram -> the compression that matches it
    vtkMammogramReader     DICOM MG -> vtkImageData

Lengths are mm, pressures kPa, energies keV, angles degrees. What goes wrong is raised (Error, InputError, DeviceError) in one
line, also from Update(). What needs VTK says so where there is none.

Keep a source in a variable until it is connected: GetOutputPort() of a temporary crashes the interpreter, as in all of VTK 9.1.
"""
import importlib
import sys
from typing import TYPE_CHECKING, Any

from . import _build
from ._build import VERSION as __version__
from ._errors import DeviceError, Error, InputError

if sys.version_info[:2] != _build.PYTHON_VERSION:
    raise ImportError(f"mammoray was built for Python {'.'.join(map(str, _build.PYTHON_VERSION))}, run it with {_build.PYTHON}; "
                      f"this is Python {sys.version.split()[0]}, {sys.executable}")


def _find(module: str, package: str) -> None:
    """Imports a module, from the folder of the interpreter that this copy was built for where this one has none."""
    try:
        importlib.import_module(module)
        return
    except ImportError:
        pass
    sys.path.append(_build.PACKAGES)
    try:
        importlib.import_module(module)
    except ImportError as error:
        raise ImportError(f"expected {module} (Debian: {package}), run mammoray with {_build.PYTHON} if that has it; "
                          f"{sys.executable} has none: {error}") from None
    finally:
        sys.path.remove(_build.PACKAGES)


_find("numpy", "python3-numpy")
from ._mesh import Mesh, read_mesh  # noqa: E402  after numpy was found
from ._scene import (  # noqa: E402
    Beam, Derivatives, Detector, Dose, DualEnergy, Exposure, Gradient, Material, Placement, Projector, Refraction, Sample, Scatter,
    Scene, Series, Source, devices, dual_energy, load_scene, material_table, tomosynthesis, turn)

if TYPE_CHECKING:
    from ._breast import Compression, CompressionGradient, LabelVolume, Mammogram, Registration, compress, mesh, register
    from ._filters import (vtkBreastCompression, vtkBreastMesher, vtkBreastRegistration, vtkMammogramReader,
                           vtkXRayProjector)

# Names that need VTK, which is loaded at their first use.
_WITH_VTK = {
    **dict.fromkeys(("Compression", "CompressionGradient", "LabelVolume", "Mammogram", "Registration", "compress", "mesh", "register"),
                    "_breast"),
    **dict.fromkeys(("vtkBreastCompression", "vtkBreastMesher", "vtkBreastRegistration", "vtkMammogramReader",
                     "vtkXRayProjector"), "_filters")}

__all__ = ["__version__", "DeviceError", "Error", "InputError", "Beam", "Derivatives", "Detector", "Dose", "DualEnergy", "Exposure",
           "Gradient", "Material", "Mesh", "Placement", "Projector", "Refraction", "Sample", "Scatter", "Scene", "Series", "Source",
           "devices", "dual_energy", "load_scene", "material_table", "read_mesh", "tomosynthesis", "turn"] + (
               list(_WITH_VTK) if _build.WITH_VTK else [])


def __getattr__(name: str) -> Any:
    if name not in _WITH_VTK:
        raise AttributeError(f"module 'mammoray' has no attribute '{name}'")
    if not _build.WITH_VTK:
        raise AttributeError(f"mammoray.{name} needs VTK, and this copy is the projector alone: it is in the "
                             "package python3-mammoray and in a build of the whole project")
    _find("vtkmodules.util.numpy_support", "python3-vtk9")
    value = getattr(importlib.import_module("." + _WITH_VTK[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
