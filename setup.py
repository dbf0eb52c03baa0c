# SPDX-License-Identifier: Apache-2.0
"""The projector alone as a Python package, without VTK: `pip install .`, see Wrapping/Python/README.md. Everything else is built
by CMake (README.md)."""
import pathlib
import re
import sys

from skbuild import setup

root = pathlib.Path(__file__).parent
version = re.search(r"^project\(MammoRay VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE)
assert version, "CMakeLists.txt: expected project(MammoRay VERSION ...)"
setup(
    name="mammoray",
    version=version.group(1),
    description="Synthetic X-rays of meshes by Vulkan: path lengths per material and the Beer-Lambert law",
    license="Apache-2.0",
    python_requires=">=3.9",
    install_requires=["numpy"],
    packages=["mammoray"],
    package_dir={"": "Wrapping/Python"},
    package_data={"mammoray": ["_xray.pyi", "py.typed"]},
    cmake_source_dir="Wrapping/Python/projector",
    cmake_install_dir="Wrapping/Python",
    cmake_args=[f"-DPython3_EXECUTABLE={sys.executable}"],
)
