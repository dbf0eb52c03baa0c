# SPDX-License-Identifier: Apache-2.0
"""Which interpreters take the package, and what the others are told."""
import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile

package = pathlib.Path(importlib.util.find_spec("mammoray").origin).parent


def run(interpreter, folder, program):
    return subprocess.run([interpreter, "-c", f"import sys; sys.path.insert(0, {str(folder)!r}); {program}"], capture_output=True,
                          text=True, check=False, env={})


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    # An environment without packages of its own finds those of the interpreter that the package was built for.
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder / "bare"], check=True)
    bare = folder / "bare/bin/python3"
    assert run(bare, folder, "import numpy").returncode != 0, "nothing there"
    answer = run(bare, package.parent, "import mammoray; print(mammoray.vtkXRayProjector().GetClassName(), 'vtk' in sys.path[-1])")
    assert answer.stdout == "vtkXRayProjector False\n", answer
    # Copies that were built for another interpreter, or for one that has no packages either: a line says which has them.
    copy = folder / "other/mammoray"
    shutil.copytree(package, copy, ignore=shutil.ignore_patterns("__pycache__"))
    built = (copy / "_build.py").read_text()
    (copy / "_build.py").write_text(built + "PYTHON_VERSION = (3, 1)\n")
    answer = run(sys.executable, copy.parent, "import mammoray")
    last = answer.stderr.splitlines()[-1]
    assert answer.returncode == 1 and "built for Python 3.1, run it with " in last and sys.executable in last, last
    (copy / "_build.py").write_text(built + "PACKAGES = '/nowhere'\n")
    answer = run(bare, copy.parent, "import mammoray")
    last = answer.stderr.splitlines()[-1]
    assert answer.returncode == 1 and last.startswith("ImportError: expected numpy (Debian: python3-numpy), run mammoray with "), last
    # The projector alone has no filters, and says where they are.
    (copy / "_build.py").write_text(built + "WITH_VTK = False\n")
    answer = run(sys.executable, copy.parent, "import mammoray; mammoray.compress")
    last = answer.stderr.splitlines()[-1]
    assert answer.returncode == 1 and "mammoray.compress needs VTK" in last and "python3-mammoray" in last, last
print("found, or told")
