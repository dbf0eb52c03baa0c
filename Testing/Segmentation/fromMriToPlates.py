#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Patients' MRI by the commands as a user would type them: segment, mesh for mechanics, check, compress from prone to standing, CC and MLO,
at 45 % of the breast's height across the plates. Prints a Markdown table of what each said; exit 1 where one refuses.

fromMriToPlates.py MAMMORAY FOLDER [SERIES/SIDE ...]: FOLDER gets meshes and pictures to look at; by default the series of shared/data,
left and right. Exit 125: no series there."""
import pathlib
import re
import resource
import subprocess
import sys

import vtk
from vtk.util.numpy_support import vtk_to_numpy

program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
data = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"
series = [data / "uta11-breast-mri-CC-BY-SA-4.0" / name for name in ("a/t1-fat-suppressed", "a/t1-tse", "b/t1-fat-suppressed")]
series.append(data / "duke-breast-mri-153-CC-BY-NC-4.0" / "t1_tse")
cases = [argument.rpartition("/")[::2] for argument in sys.argv[3:]]
cases = cases or [(str(path), side) for path in series if path.exists() for side in ("left", "right")]
if not cases:
    sys.exit(125)
TURNED_PER_VIEW = {"CC": 0.0, "MLO": 45.0}


def run(*words):
    """Runs a command; gives its output and its seconds of processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    (folder / "log").open("a").write(f"$ {' '.join(map(str, words))}\n{done.stdout}{done.stderr}\n")
    if done.returncode:
        raise RuntimeError(f"{words[0]}: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else done.returncode}")
    return done.stdout, after.ru_utime - before.ru_utime


def height_across(mesh, degrees, side):
    """Extent of what is not held, mm, in the direction in which the plates of this view close (LPS)."""
    from math import cos, radians, sin
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(mesh))
    reader.Update()
    grid = reader.GetOutput()
    points = vtk_to_numpy(grid.GetPoints().GetData())
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    material = vtk_to_numpy(grid.GetCellData().GetArray("Material"))
    names = grid.GetFieldData().GetAbstractArray("MaterialNames")
    wall = [names.GetValue(i) for i in range(names.GetNumberOfValues())].index("chest-wall")
    breast = points[sorted(set(cells[material != wall].ravel()))]
    towards = sin(radians(degrees)) * (1 if side == "left" else -1)
    across = breast[:, 2] * cos(radians(degrees)) - breast[:, 0] * towards
    return across.max() - across.min()


def part(pattern, text, otherwise="?"):
    """The groups of the pattern in the output of a command."""
    found = re.search(pattern, text)
    return " ".join(group for group in found.groups() if group) if found else otherwise


folder.mkdir(parents=True, exist_ok=True)
print("| series, side | breast | segment | mesh | CC at | compress | MLO at | compress |\n|---|---|---|---|---|---|---|---|")
failed = False
for path, side in cases:
    where = "/".join(pathlib.Path(path).parts[-2:])
    name = f"{where}-{side}".replace("/", "-")
    labels, mesh = folder / f"{name}.nii.gz", folder / f"{name}.vtu"
    row = [f"{where}, {side}"]
    try:
        told, seconds = run("segment", "--image", path, "--side", side, "-o", labels, "--picture", folder / f"{name}.png", "--overwrite")
        row += [part(r"breast (\S+ cm3), (\S+ % gland)", told), f"{seconds:.0f} s"]
        told, seconds = run("mesh", "--labels", labels, "--materials", "segment", "--for-mechanics", "-o", mesh, "--overwrite")
        checked, _ = run("mesh", "--check", mesh)
        cells, sound = part(r"([0-9]+) tetrahedra", told), part(r"(sound):", checked, "NOT SOUND")
        row += [f"{cells} cells, {sound}, {seconds:.0f} s"]
        for view, degrees in TURNED_PER_VIEW.items():
            thickness = 0.45 * height_across(mesh, degrees, side)
            told, seconds = run("compress", "--mesh", mesh, "--labels", labels, "--materials", "segment", "--mri-position", "prone", "--chest-wall",
                                "sliding", "--view", view, "--side", side, "--thickness", f"{thickness:.1f}", "-o",
                                folder / f"{name}-{view}.vtu", "--picture", folder / f"{name}-{view}.png", "--overwrite")
            forces = part(r"paddle (\S+) N, support (\S+) N", told).replace(" ", " and ")
            inverted = part(r"(\d+ of \d+) cells of the mesh .* in the breast", told, "none")
            row += [f"{thickness:.1f} mm", f"{forces} N, J {part(r'J ([0-9].+)', told)}, inside out {inverted}, {seconds:.0f} s"]
    except RuntimeError as refusal:
        row.append(f"REFUSED {refusal}")
        failed = True
    print("| " + " | ".join(row) + " |", flush=True)
sys.exit(failed)
