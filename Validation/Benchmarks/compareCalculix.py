#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compresses the FDA's phantom 1 with MammoRay and with CalculiX: the same mesh of quadratic tetrahedra, material and
plates, one after the other on the same machine. Prints time and force of both, and how far apart they move the nodes.

usage: compareCalculix.py MAMMORAY WORKFOLDER [CELL-SIZE-MM]

MAMMORAY: the program. Needs the Debian packages calculix-ccx, python3-numpy and python3-vtk9; CalculiX takes minutes to
hours. What differs: contact (CalculiX: from surface to surface, 60 kPa/mm; MammoRay: a layer of 0.05 mm) and how the
plates' edges are round (in CalculiX four flat facets).
"""
import json
import os
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

DATA = Path(__file__).resolve().parents[2] / "Data"
sys.dont_write_bytecode = True  # Data is installed as it is
sys.path.insert(0, str(DATA / "scattered-1001-mlo"))
import makeTruth  # noqa: E402

THICKNESS = 50.0
SUPPORT_HEIGHT = 2.0  # of mammoray's unit
EDGE_RADIUS = 3.0
LARGEST_STEP = 0.1  # of CalculiX's time, 1: the whole way; it takes smaller ones where it has to


def read(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def timed(command, **options):
    """Seconds of the clock, and of the processor."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(command, check=True, **options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, time.monotonic() - began, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def paddle_force(path):
    """N, of the last total in CalculiX's output, mN."""
    lines = path.read_text().split("total force (fx,fy,fz) for set NPADDLE")[-1].splitlines()
    return abs(float(next(line for line in lines[1:] if line.strip()).split()[2])) / 1000


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    for program in (sys.argv[1], "ccx"):
        if not shutil.which(program):
            sys.exit(f"compareCalculix.py: {program}: expected a program, found none")
    mammoray, work = str(Path(shutil.which(sys.argv[1])).resolve()), Path(sys.argv[2])
    work.mkdir(exist_ok=True)
    labels, mesh, squeezed = DATA / "victre-phantom-1" / "labels.nrrd", work / "breast.vtu", work / "compressed.vtu"
    size = ["--cell-size", sys.argv[3]] if len(sys.argv) == 4 else []
    subprocess.run([mammoray, "mesh", "--labels", labels, "--materials", "victre", "--for-mechanics", *size, "-o", mesh,
                    "--overwrite"], check=True, stdout=subprocess.DEVNULL)
    settings = work / "compress.json"
    settings.write_text(f'{{"edge-radius": {EDGE_RADIUS}}}')
    ours, clock, processor = timed([
        mammoray, "compress", "--mesh", mesh, "--materials", "victre", "--orientation", "ALS", "--thickness", f"{THICKNESS}",
        "--anterior", "7", "--config", settings, "-o", squeezed, "--overwrite"], stdout=subprocess.PIPE, text=True)
    grid = read(squeezed)
    fields = grid.GetFieldData()
    names = [fields.GetAbstractArray("MaterialNames").GetValue(n)
             for n in range(fields.GetAbstractArray("MaterialNames").GetNumberOfValues())]
    placement = vtk_to_numpy(fields.GetArray("Placement")).reshape(4, 3)  # origin and axes of the gantry
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    materials = vtk_to_numpy(grid.GetCellData().GetArray("Material")).astype(int)
    moved = vtk_to_numpy(grid.GetPoints().GetData())
    rest = moved - vtk_to_numpy(grid.GetPointData().GetArray("Displacement"))

    def in_gantry(points):
        return (points - placement[0]) @ placement[1:].T

    # The gantry's frame is left-handed.
    nodes, elements = makeTruth.with_edge_nodes(in_gantry(rest), cells[:, [0, 2, 1, 3]])
    table = {each["name"]: each for each in json.loads((DATA / "materials" / "victre.json").read_text())["materials"]}
    young = np.array([table[name].get("youngs_modulus_kpa", 0.0) for name in names])[materials]
    soft = np.array([not table[name].get("held", False) for name in names])[materials]
    ends = SUPPORT_HEIGHT, SUPPORT_HEIGHT + THICKNESS
    makeTruth.write_input(nodes, elements, young, soft, ends, EDGE_RADIUS, LARGEST_STEP, work / "breast.inp")
    threads = {**os.environ, "OMP_NUM_THREADS": str(os.cpu_count())}
    with open(work / "ccx.log", "w") as log:
        _, their_clock, their_processor = timed(["ccx", "-i", "breast"], cwd=work, stdout=log, env=threads)
    theirs = nodes + makeTruth.read_displacements(work / "breast.dat", len(nodes))
    increments = (work / "breast.sta").read_text().strip().splitlines()[-1].split()[1]

    free = np.zeros(len(rest), bool)
    free[np.unique(cells[soft])] = True
    free[np.unique(cells[~soft])] = False
    apart = np.linalg.norm(in_gantry(moved) - theirs[:len(rest)], axis=1)[free]
    way = np.linalg.norm(theirs[:len(rest)] - nodes[:len(rest)], axis=1)[free]
    force = vtk_to_numpy(fields.GetArray("PaddleForceN"))[0]
    print(f"{len(cells)} quadratic cells, {3 * (len(nodes))} coordinates; to {THICKNESS:g} mm\n")
    print("| program | s | processor s | paddle, N |\n|---|---|---|---|")
    print(f"| MammoRay, with reading and writing | {clock:.1f} | {processor:.1f} | {force:.2f} |")
    print(f"| CalculiX, {increments} increments | {their_clock:.1f} | {their_processor:.1f} | {paddle_force(work / 'breast.dat'):.2f} |")
    print(f"\n{free.sum()} nodes, moved by {np.median(way):.2f} mm (median), are {np.median(apart):.2f} mm apart (median; 95 %: "
          f"{np.percentile(apart, 95):.2f}, largest {apart.max():.2f})")
    print("\n".join(line for line in ours.stdout.splitlines() if "Newton" in line or "penetration" in line))


if __name__ == "__main__":
    main()
