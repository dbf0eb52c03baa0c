# SPDX-License-Identifier: Apache-2.0
"""testPip.py PROJECT: the projector alone by pip, offline, in an environment of its own; what it is tested by is testScene.py.
Exit 125: not asked for (MAMMORAY_LONG_TESTS), or nothing to build it with."""
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

if not os.environ.get("MAMMORAY_LONG_TESTS"):
    print("some minutes; set MAMMORAY_LONG_TESTS to run it")
    sys.exit(125)
missing = [module for module in ("pip", "skbuild", "pybind11") if importlib.util.find_spec(module) is None]
if missing and missing != ["pybind11"]:  # its CMake files are enough
    print(f"no {', '.join(missing)}")
    sys.exit(125)
root = pathlib.Path(sys.argv[1]).resolve()
environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    # A copy: building leaves files behind.
    for part in ("CMakeLists.txt", "LICENSE", "README.md", "setup.py", "pyproject.toml"):
        shutil.copy(root / part, folder)
    for part in ("Data", "Modules", "Wrapping", "shaders"):
        shutil.copytree(root / part, folder / part)
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder / "xray"], check=True)
    python = folder / "xray/bin/python3"
    subprocess.run([python, "-m", "pip", "install", "--no-index", "--no-build-isolation", "--no-deps", "."], cwd=folder, check=True,
                   env=environment)
    shutil.copy(pathlib.Path(__file__).parent / "testScene.py", folder / "xray")
    # Away from the sources, whose tables it must not need.
    shutil.rmtree(folder / "Data")
    sys.exit(subprocess.run([python, folder / "xray/testScene.py"], cwd="/", env=environment, check=False).returncode)
