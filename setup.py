# SPDX-License-Identifier: Apache-2.0
"""The projector alone as a Python package, without VTK: `pip install .` or `pip wheel .`, see Wrapping/Python/README.md.
Everything else is built by CMake (README.md)."""
import os
import pathlib
import platform
import re
import sys

import numpy
from skbuild import setup

root = pathlib.Path(__file__).parent
version = re.search(r"^project\(MammoRay VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE)
assert version, "CMakeLists.txt: expected project(MammoRay VERSION ...)"
# The wheel needs the GNU C library of this machine or a later one, and its tag says so.
name, _, release = (os.confstr("CS_GNU_LIBC_VERSION") or "").partition(" ")
tag = f"manylinux_{release.replace('.', '_')}_{platform.machine()}" if name == "glibc" else None
setup(
    name="mammoray",
    version=version.group(1),
    description="Synthetic X-rays of meshes by Vulkan: path lengths per material and the Beer-Lambert law",
    license="Apache-2.0",
    python_requires=">=3.9",
    # A pybind11 as old as numpy 1 (Debian 12) does not work with numpy 2.
    install_requires=["numpy" if int(numpy.__version__.split(".")[0]) > 1 else "numpy<2"],
    extras_require={"meshes": ["meshio"]},
    license_files=["LICENSE", "Packaging/copyright.projector", "Packaging/copyright.wheel"],
    options={"bdist_wheel": {"plat_name": tag}} if tag else {},
    packages=["mammoray"],
    package_dir={"": "Wrapping/Python"},
    package_data={"mammoray": ["_xray.pyi", "py.typed"]},
    cmake_source_dir="Wrapping/Python/projector",
    cmake_install_dir="Wrapping/Python",
    # Several sources at once: a third of the time.
    cmake_args=[f"-DPython3_EXECUTABLE={sys.executable}", "-DCMAKE_UNITY_BUILD=ON"],
)
