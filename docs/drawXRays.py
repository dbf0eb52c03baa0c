#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of docs/xrays.md: unit.png, fibre.png, sweep.png and iodine.png.

usage: drawXRays.py BIN-FOLDER DEMO-RESULT DOCS-FOLDER

BIN-FOLDER: where mammoray is. DEMO-RESULT: what `./quickstart demo` wrote, whose compressed breast is pictured.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (after the choice of what draws)


def image_of(path):
    reader = vtk.vtkMetaImageReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    columns, rows, count = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    return values.reshape(count, rows, columns) if count > 1 else values.reshape(rows, columns)


def write_surface(source, path):
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(source.GetOutputPort())
    writer = vtk.vtkSTLWriter()
    writer.SetInputConnection(triangles.GetOutputPort())
    writer.SetFileName(str(path))
    writer.Write()


def ball(centre, radius, path):
    source = vtk.vtkSphereSource()
    source.SetCenter(centre)
    source.SetRadius(radius)
    source.SetThetaResolution(48)
    source.SetPhiResolution(32)
    write_surface(source, path)


def save(path, panels, height=4.4):
    figure, axes = pyplot.subplots(1, len(panels), figsize=(10.8, height), squeeze=False)
    for axis, (title, values, limits) in zip(axes[0], panels):
        axis.imshow(values, cmap="gray", vmin=limits[0], vmax=limits[1], interpolation="nearest")
        axis.set_title(title, fontsize=9)
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    pyplot.close(figure)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    program = pathlib.Path(sys.argv[1]) / "mammoray"
    result, docs = pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    folder = tempfile.TemporaryDirectory(prefix="xrays-")
    work = pathlib.Path(folder.name)

    def project(*arguments):
        subprocess.run([program, "project", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)

    pose = json.loads((result / "result.json").read_text())
    breast = ["--mesh", result / "compressed.vtu", "--materials", "victre", "--orientation", "ALS", "--support-height", 17,
              "--pixel-spacing", 0.25, "--columns", 288, "--rows", 432, "--anchor", *pose["anchorMm"]]
    for parameter in pose["parameters"]:
        if parameter["name"] != "stiffness":
            breast += ["--" + parameter["name"].replace("_", "-"), f"{parameter['value']:.6g}"]

    project(*breast, "-o", work / "primary.mha")
    project(*breast, "--realistic", "-o", work / "unit.mha")
    project(*breast, "--realistic", "--display", "-o", work / "shown.mha")
    save(docs / "unit.png", [("primary radiation", image_of(work / "primary.mha"), (0, 1)),
                             ("--realistic", image_of(work / "unit.mha"), (0, 1)),
                             ("--realistic --display", image_of(work / "shown.mha"), (0, 1)),
                             ("the FDA's mammogram of it", pyplot.imread(docs / "demo" / "real.png"), (0, 1))])

    fibre = vtk.vtkCylinderSource()
    fibre.SetRadius(0.07)
    fibre.SetHeight(4)
    fibre.SetResolution(6000)
    write_surface(fibre, work / "fibre.stl")
    geometry = ["--surface", f"SiC@3.0={work / 'fibre.stl'}", "--kev", 20, "--beam-direction", 0, 0, -1, "--detector-origin",
                -0.1495, -0.0015, -500, "--column-direction", 1, 0, 0, "--row-direction", 0, 1, 0, "--columns", 300, "--rows", 4,
                "--pixel-spacing", 0.001]
    project(*geometry, "-o", work / "straight.mha")
    project(*geometry, "--set", "refraction.law=geometric", "--samples", 16, "-o", work / "bent.mha")
    # Along the fibre nothing changes.
    straight, bent = (numpy.repeat(image_of(work / f"{which}.mha"), 50, axis=0) for which in ("straight", "bent"))
    figure, axes = pyplot.subplots(1, 3, figsize=(10.8, 3))
    for axis, values, title in ((axes[0], straight, "a SiC fibre of 0.14 mm, straight rays"), (axes[1], bent, "refracted, 0.5 m")):
        axis.imshow(values, cmap="gray", vmin=0.8, vmax=1.2)
        axis.set_title(title, fontsize=9)
        axis.axis("off")
    place = numpy.arange(300) - 149.5
    axes[2].plot(place, straight[100], color="0.6", label="straight")
    axes[2].plot(place, bent[100], color="tab:blue", label="bent")
    axes[2].set(xlabel="micrometres", ylabel="I / I0", ylim=(0.6, 1.6))
    axes[2].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(docs / "fibre.png", dpi=100)

    project(*breast, "--tomosynthesis", 9, "--span", 50, "--realistic", "-o", work / "sweep.mha")
    sweep = -numpy.log(numpy.maximum(image_of(work / "sweep.mha"), 1e-4))
    save(docs / "sweep.png", [(title, sweep[number], (0.3, numpy.percentile(sweep[number], 99.5)))
                              for number, title in ((0, "-25 degrees"), (4, "0 degrees"), (8, "25 degrees"))])

    box = vtk.vtkCubeSource()
    box.SetBounds(-30, 30, -30, 30, 20, 60)
    write_surface(box, work / "fat.stl")
    generator = numpy.random.default_rng(3)
    for number in range(14):
        x, y = generator.uniform(-20, 20, 2)
        ball((x, y, generator.uniform(32, 48)), generator.uniform(5, 9), work / f"gland{number}.stl")
    ball((6, -4, 40), 4, work / "lesion.stl")
    table = {"name": "slab", "materials": [
        {"name": "air", "labels": [0]},
        {"name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92},
        {"name": "gland", "labels": [2], "attenuation": "glandular", "density_g_per_cm3": 1.04},
        {"name": "lesion", "labels": [3], "attenuation": "glandular", "density_g_per_cm3": 1.04}]}
    (work / "slab.json").write_text(json.dumps(table))
    scene = ["--materials", work / "slab.json", "--surface", f"fat={work / 'fat.stl'}"]
    for number in range(14):
        scene += ["--surface", f"gland={work / f'gland{number}.stl'}"]
    scene += ["--surface", f"lesion={work / 'lesion.stl'}", "--set", 'overlap-priority=["lesion", "gland", "fat"]']
    project(*scene, "--set", "iodine.lesion=2", "--tube", "W", "--kvp", 30, "--filter", "Rh:0.05", "--high", "kvp=42",
            "filter=Cu:0.3", "--cancel-thickness", 40, "--source", 0, 0, 650, "--detector-origin", -27.4, -27.4, 0, "--column-direction", 1, 0,
            0, "--row-direction", 0, 1, 0, "--columns", 275, "--rows", 275, "--pixel-spacing", 0.2, "--photons", 1e6, "-o",
            work / "iodine.mha")
    low, high = (-numpy.log(image_of(work / f"iodine_{which}.mha")) for which in ("low", "high"))
    recombined = image_of(work / "iodine.mha")
    save(docs / "iodine.png", [("30 kV", low, tuple(numpy.percentile(low, (1, 99)))), ("42 kV, 0.3 mm Cu", high, tuple(numpy.percentile(high, (1, 99)))),
                               ("recombined: 2 mg of iodine per ml in a ball of 8 mm", recombined,
                                (numpy.median(recombined) - 0.03, numpy.median(recombined) + 0.05))], 3.8)


main()
