"""MammoRay: synthetic X-rays of meshes and registration of breast MRI with mammograms.

The classes here are VTK algorithms and work with everything in `vtkmodules`.
"""
from .mammorayMammography import *  # noqa: F401,F403
