# SPDX-License-Identifier: Apache-2.0
"""Type hints: mypy finds the package without fault, and in typed.py the lines that are marked as wrong. Exit 125: no mypy."""
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

mypy = shutil.which("mypy")
if mypy is None:
    print("no mypy")
    sys.exit(125)
packages = pathlib.Path(importlib.util.find_spec("mammoray").origin).parents[1]
program = pathlib.Path(__file__).with_name("typed.py")
with tempfile.TemporaryDirectory() as folder:
    # VTK as Debian packs it has no hints.
    common = [mypy, "--ignore-missing-imports", "--cache-dir", os.path.join(folder, "cache")]
    environment = {**os.environ, "MYPYPATH": str(packages)}
    package = subprocess.run([*common, "-p", "mammoray"], cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert package.returncode == 0, package.stdout
    user = subprocess.run([*common, str(program)], cwd=folder, env=environment, capture_output=True, text=True, check=False)
found = {int(line) for line in re.findall(r"typed\.py:(\d+): error", user.stdout)}
wrong = {number for number, line in enumerate(program.read_text().splitlines(), 1) if "# wrong" in line}
assert found == wrong and len(wrong) == 4, user.stdout
print(package.stdout.strip())
