#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of the documentation from the program.

usage: make.py BIN-FOLDER [--demo FOLDER] [NAME ...]   all pictures, or those named (fibre.png); FOLDER: what `mammoray demo` has written
       make.py --check                                 exit 1: a picture is missing, changed, or drawn by other code than stands here

BIN-FOLDER: where mammoray and mammoray-validate are. drawn.json keeps which code has drawn which picture.
"""
import argparse
import functools
import gzip
import hashlib
import inspect
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
root = here.parents[1]
DRAWN = here / "drawn.json"
PICTURES = {}


def picture(*names):
    """Registers a function that draws these files: function(tools), with tools a Tools."""
    def register(function):
        for name in names:
            PICTURES[name] = function
        return function
    return register


def sum_of(data):
    return hashlib.sha256(data).hexdigest()


def code_of(function):
    """Sum of a function's source, or of the text of a script of the gallery."""
    if isinstance(function, functools.partial):
        return sum_of(function.keywords["script"].read_bytes())
    return sum_of(inspect.getsource(function).encode())


class Tools:
    """The program, a folder to work in, and the demo's result."""

    def __init__(self, programs, demo, work):
        self.programs, self.work, self._demo = programs, work, demo

    def run(self, *words, program="mammoray"):
        display = ["xvfb-run", "--auto-servernum", "--server-args=-screen 0 1600x1000x24"] if words[0] == "view" else []
        subprocess.run([*display, self.programs / program, *map(str, words)], check=True, stdout=subprocess.DEVNULL, cwd=self.work)

    @property
    def demo(self):
        if self._demo is None:
            self._demo = self.work / "demo"
            self.run("demo", "--output", self._demo)
        return self._demo

    def image(self, name):
        """Values of a .mha: (rows, columns), or (projections, rows, columns)."""
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        reader = vtk.vtkMetaImageReader()
        reader.SetFileName(str(self.work / name))
        reader.Update()
        columns, rows, count = reader.GetOutput().GetDimensions()
        values = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
        return values.reshape(count, rows, columns) if count > 1 else values.reshape(rows, columns)

    def breast(self, rows=432):
        """Options that place source and detector around the demo's compressed breast as it was registered; pixels of 0.25 mm."""
        result = json.loads((self.demo / "result.json").read_text())
        placed = result["placement"]

        def at(x, y, z):
            return [place + x * a + y * b + z * c for place, a, b, c in zip(placed["originMm"], placed["x"], placed["y"], placed["z"])]

        return ["--mesh", self.demo / "compressed.vtu", "--materials", "victre", "--orientation", "ALS", "--source",
                *at(0, 0, result["unit"]["sourceToDetectorMm"]), "--detector-origin", *at(0.125 * (rows - 1), 0.125, 0), "--column-direction",
                *placed["y"], "--row-direction", *(-value for value in placed["x"]), "--pixel-spacing", 0.25, "--columns", 288, "--rows", rows]


def pyplot():
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    return plt


def save_panels(path, panels, height):
    """Grey pictures in a row: (title, values, limits)."""
    plt = pyplot()
    figure, axes = plt.subplots(1, len(panels), figsize=(10.8, height), squeeze=False)
    for axis, (title, values, limits) in zip(axes[0], panels):
        axis.imshow(values, cmap="gray", vmin=limits[0], vmax=limits[1], interpolation="nearest")
        axis.set_title(title, fontsize=10)
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(path, dpi=100)
    plt.close(figure)


def run_script(tools, script):
    """With the package of PYTHONPATH, or of the folder of the programs."""
    packages = next(iter((tools.programs.parent / "lib").glob("python3*/site-packages")), "")
    subprocess.run([sys.executable, script, tools.work], check=True, cwd=root, stdout=subprocess.DEVNULL, env={
        **os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": os.environ.get("PYTHONPATH", "") or str(packages)})


def read_mammogram(tools, path):
    """Values of a DICOM mammogram (rows, columns), by the package of the folder of the programs."""
    sys.path += map(str, (tools.programs.parent / "lib").glob("python3*/site-packages"))
    import mammoray
    from vtk.util.numpy_support import vtk_to_numpy
    reader = mammoray.vtkMammogramReader(FileName=str(path))
    reader.Update()
    columns, rows, _ = reader.GetOutput().GetDimensions()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetArray("Mammogram")).reshape(rows, columns)[::-1]


def write_surface(source, path):
    import vtk
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(source.GetOutputPort())
    writer = vtk.vtkSTLWriter()
    writer.SetInputConnection(triangles.GetOutputPort())
    writer.SetFileName(str(path))
    writer.Write()


BEARING = {"unit": "mm", "source": {"position": [0, -250, 433], "focal-spot": [0.3, 0.3]},
           "detector": {"origin": [-39.9, 15.45, -106.55], "column-direction": [1, 0, 0], "row-direction": [0, 0.866, 0.5],
                        "columns": 400, "rows": 400, "pixel-spacing": 0.2, "photons": 20000},
           "beam": {"kev": 150}, "samples": [{"file": str(root / "Data/parts/bearing.stl"), "material": "Fe"}]}


@picture("bearing.png")
def draw_bearing(tools):
    (tools.work / "bearing.json").write_text(json.dumps(BEARING))
    tools.run("project", "--scene", "bearing.json", "-o", here / "bearing.png", "--overwrite")


@picture("scene.png")
def draw_scene(tools):
    (tools.work / "bearing.json").write_text(json.dumps(BEARING))
    tools.run("view", "--scene", "bearing.json", "--pixel", 200, 140, "--size", 1100, 640, "--screenshot", here / "scene.png", "--overwrite")


@picture("frames.png")
def draw_frames(tools):
    plt = pyplot()
    import numpy
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.6))

    def arrow(axis, start, way, text, colour):
        axis.annotate("", xy=(start[0] + way[0], start[1] + way[1]), xytext=start,
                      arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 2, "shrinkA": 0, "shrinkB": 0})
        length = numpy.hypot(*way)
        axis.text(start[0] + way[0] * (1 + 8 / length), start[1] + way[1] * (1 + 8 / length), text, color=colour, fontsize=11,
                  ha="left" if way[0] > 0 else "center", va="center" if way[0] > 0 else "bottom")

    left.set_title("volume frame: DICOM LPS, seen from the patient's left", fontsize=10)
    y = numpy.linspace(-1, 1, 80)
    left.fill([0, 40, 40, 0], [-110, -110, 110, 110], color="0.85")
    left.text(20, -95, "body", ha="center", fontsize=9)
    left.fill(-75 * numpy.sqrt(1 - y**2), 60 * y, color="#f3d3c3")
    left.text(-35, -8, "breast", ha="center", fontsize=9)
    arrow(left, (0, 0), (0, 90), "+z superior", "tab:blue")
    arrow(left, (0, 0), (80, 0), "+y posterior", "tab:green")
    left.plot(0, 0, "o", color="tab:red", markersize=11, markerfacecolor="none")
    left.plot(0, 0, ".", color="tab:red")
    left.text(50, 22, "+x left, towards you", color="tab:red", fontsize=11)
    right.set_title("gantry frame, CC view, seen from the patient's left", fontsize=10)
    right.fill([0, 40, 40, 0], [-30, -30, 150, 150], color="0.85")
    x = numpy.linspace(0, 1, 60)
    right.fill_between(-90 * numpy.sqrt(1 - (2 * x - 1)**2), 17 + 50 * x, color="#f3d3c3", linewidth=0)
    right.fill([0, -90, -90, 0], [17, 17, 20, 20], color="0.5")
    right.fill([0, -90, -90, 0], [67, 67, 70, 70], color="0.5")
    right.text(-96, 68, "paddle", ha="right", va="center", fontsize=9)
    right.text(-96, 18, "support", ha="right", va="center", fontsize=9)
    right.plot([0, -110], [0, 0], color="k", linewidth=4)
    right.text(-116, 0, "receptor", ha="right", va="center", fontsize=9)
    right.plot([0, 0], [150, 0], color="gold", linewidth=1)
    right.plot([0, -110], [150, 0], color="gold", linewidth=1)
    right.plot(0, 150, "o", color="gold", markersize=10)
    right.text(-6, 150, "source (not to scale)", ha="right", va="center", fontsize=9)
    arrow(right, (0, 0), (0, 110), "+z", "tab:blue")
    arrow(right, (0, 0), (-75, 0), "+y", "tab:green")
    right.plot(0, 0, "o", color="tab:red", markersize=11, markerfacecolor="none")
    right.plot(0, 0, ".", color="tab:red")
    right.text(6, -18, "+x patient's left, towards you", color="tab:red", fontsize=10, ha="center")
    left.set(xlim=(-110, 190), ylim=(-115, 125), aspect="equal")
    right.set(xlim=(-170, 80), ylim=(-40, 165), aspect="equal")
    for axis in (left, right):
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(here / "frames.png", dpi=100)
    plt.close(figure)


@picture("trust.png")
def draw_trust(tools):
    plt = pyplot()
    rows = []
    for line in (root / "Validation/reports/accuracy.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 7 and re.search(r"-?\d\.\d+ to -?\d\.\d+", cells[5]):
            spans = [tuple(map(float, part.split(" to "))) for part in cells[5].split(";")]
            rows.append((f"{cells[0].replace('-', ' ')} ({cells[1]})", spans))
    figure, axis = plt.subplots(figsize=(9, 0.42 * len(rows) + 1.2))
    axis.axvspan(-0.4, 0.3, color="#fde2e2")
    axis.axvspan(0.3, 0.55, color="#fff3d6")
    axis.axvspan(0.55, 1, color="#def7e5")
    for text, place in (("none", -0.05), ("doubtful", 0.425), ("good, if all else is", 0.775)):
        axis.text(place, -0.75, text, ha="center", va="center", fontsize=10)
    for number, (name, spans) in enumerate(rows):
        for low, high in spans:
            axis.plot((low, high), (number, number), color="tab:blue", linewidth=7, solid_capstyle="butt")
    axis.set(yticks=range(len(rows)), yticklabels=[name for name, _ in rows], xlim=(-0.4, 1), ylim=(len(rows) - 0.5, -1.2),
             xlabel="tissue correlation (range over the results)")
    figure.tight_layout()
    figure.savefig(here / "trust.png", dpi=100)
    plt.close(figure)


@picture("mammograms.png")
def draw_mammograms(tools):
    plt = pyplot()
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 4.9))
    for axis, title, name in zip(axes, ("target (FDA phantom, simulated)", "synthetic", "difference, standard deviations"),
                                 ("real", "synthetic", "difference")):
        axis.imshow(plt.imread(tools.demo / f"{name}.png"), cmap="gray")
        axis.set_title(title, fontsize=10)
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(here / "mammograms.png", dpi=100, bbox_inches="tight", pad_inches=0.1)
    plt.close(figure)


@picture("tutorial-mammograms.png")
def draw_tutorial(tools):
    run_script(tools, root / "docs/tutorials/python_registration.py")
    (here / "tutorial-mammograms.png").write_bytes((tools.work / "mammograms.png").read_bytes())


@picture("unit.png")
def draw_unit(tools):
    import numpy
    tools.run("project", *tools.breast(), "-o", "primary.mha")
    tools.run("project", *tools.breast(), "--realistic", "-o", "unit.mha")
    tools.run("project", *tools.breast(), "--realistic", "--display", "-o", "shown.mha")
    target = read_mammogram(tools, root / "Data/victre-phantom-1/victre1_lcc_processing.dcm")
    logs = [-numpy.log(numpy.maximum(values, 1e-4)) for values in (tools.image("primary.mha"), tools.image("unit.mha"), target / target.max())]
    limits = (0, float(numpy.percentile(logs[0], 99.5)))
    save_panels(here / "unit.png", [("primary radiation, -ln", logs[0], limits), ("--realistic, -ln", logs[1], limits),
                                    ("--realistic --display", tools.image("shown.mha"), (0, 1)),
                                    ("target (FDA phantom, simulated), -ln", logs[2], limits)], 4.4)


@picture("fibre.png")
def draw_fibre(tools):
    import numpy
    import vtk
    fibre = vtk.vtkCylinderSource()
    fibre.SetRadius(0.07)
    fibre.SetHeight(4)
    fibre.SetResolution(12000)
    write_surface(fibre, tools.work / "fibre.stl")
    geometry = ["--surface", "SiC@3.0=fibre.stl", "--kev", 20, "--beam-direction", 0, 0, -1, "--detector-origin",
                -0.14975, 0, -500, "--column-direction", 1, 0, 0, "--row-direction", 0, 1, 0, "--columns", 600, "--rows", 1,
                "--pixel-spacing", 0.0005, "--samples", 16]
    tools.run("project", *geometry, "-o", "straight.mha")
    tools.run("project", *geometry, "--set", "refraction.law=geometric", "-o", "bent.mha")
    # Pixels of 2 micrometres; nothing changes along the fibre.
    straight, bent = (numpy.repeat(tools.image(f"{which}.mha").reshape(1, 150, 4).mean(axis=2), 100, axis=0) for which in ("straight", "bent"))
    plt = pyplot()
    figure, axes = plt.subplots(1, 3, figsize=(10.8, 3))
    for axis, values, title in ((axes[0], straight, "SiC fibre of 0.14 mm, straight rays"), (axes[1], bent, "refracted, 0.5 m")):
        axis.imshow(values, cmap="gray", vmin=0.8, vmax=1.2)
        axis.set_title(title, fontsize=10)
        axis.axis("off")
    place = 2 * (numpy.arange(150) - 74.5)
    axes[2].plot(place, straight[0], color="0.6", label="straight")
    axes[2].plot(place, bent[0], color="tab:blue", label="refracted")
    axes[2].set(xlabel="micrometres", ylabel="I / I0")
    axes[2].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(here / "fibre.png", dpi=100)
    plt.close(figure)


@picture("sweep.png")
def draw_sweep(tools):
    import numpy
    tools.run("project", *tools.breast(720), "--tomosynthesis", 9, "--span", 50, "--realistic", "-o", "sweep.mha")
    sweep = -numpy.log(numpy.maximum(tools.image("sweep.mha"), 1e-4))
    save_panels(here / "sweep.png", [(title, sweep[number], (0, numpy.percentile(sweep[number], 99.5)))
                                     for number, title in ((0, "-25 degrees"), (4, "0 degrees"), (8, "25 degrees"))], 7.4)


@picture("iodine.png")
def draw_iodine(tools):
    import numpy
    import vtk

    def ball(centre, radius, name):
        source = vtk.vtkSphereSource()
        source.SetCenter(centre)
        source.SetRadius(radius)
        source.SetThetaResolution(48)
        source.SetPhiResolution(32)
        write_surface(source, tools.work / name)

    box = vtk.vtkCubeSource()
    box.SetBounds(-30, 30, -30, 30, 20, 60)
    write_surface(box, tools.work / "fat.stl")
    scene = ["--surface", "fat=fat.stl"]
    generator = numpy.random.default_rng(3)
    for number in range(14):
        x, y = generator.uniform(-20, 20, 2)
        ball((x, y, generator.uniform(32, 48)), generator.uniform(5, 9), f"gland{number}.stl")
        scene += ["--surface", f"gland=gland{number}.stl"]
    ball((6, -4, 40), 4, "lesion.stl")
    scene += ["--surface", "lesion=lesion.stl"]
    (tools.work / "slab.json").write_text(json.dumps({"name": "slab", "materials": [
        {"name": "air", "labels": [0]},
        {"name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92},
        {"name": "gland", "labels": [2], "attenuation": "glandular", "density_g_per_cm3": 1.04},
        {"name": "lesion", "labels": [3], "attenuation": "glandular", "density_g_per_cm3": 1.04}]}))
    tools.run("project", "--materials", "slab.json", *scene, "--set", 'overlap-priority=["lesion", "gland", "fat"]',
              "--set", "iodine.lesion=2", "--tube", "W", "--kvp", 30, "--filter", "Rh:0.05", "--high", "kvp=42", "filter=Cu:0.3",
              "--cancel", "fat", "gland", "--cancel-thickness", 40, "--source", 0, 0, 650, "--detector-origin", -27.4, -27.4, 0,
              "--column-direction", 1, 0, 0, "--row-direction", 0, 1, 0, "--columns", 275, "--rows", 275, "--pixel-spacing", 0.2,
              "--photons", 1e6, "-o", "iodine.mha")
    low, high = (-numpy.log(tools.image(f"iodine_{which}.mha")) for which in ("low", "high"))
    left = tools.image("iodine.mha")
    middle = numpy.median(left)
    save_panels(here / "iodine.png", [("30 kV", low, tuple(numpy.percentile(low, (1, 99)))),
                                      ("42 kV, 0.3 mm Cu", high, tuple(numpy.percentile(high, (1, 99)))),
                                      ("recombined: a ball of 8 mm with 2 mg/ml of iodine", left, (middle - 0.03, middle + 0.05))], 3.8)


@picture("film.webp")
def draw_film(tools):
    """The breast closes between the plates (a cut through a lesion), its X-ray, and the target with the place of the lesion."""
    import io
    import numpy
    import vtk
    from PIL import Image
    from vtk.util.numpy_support import vtk_to_numpy
    plt = pyplot()
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Ellipse
    steps, lesion = 20, numpy.array([30.0, 12.0, -10.0])
    pose = {one["name"]: one["value"] for one in json.loads((tools.demo / "result.json").read_text())["parameters"]}
    if not (tools.work / "closing.pvd").exists():
        tools.run("compress", "--mesh", tools.demo / "uncompressed.vtu", "--labels", root / "Data/victre-phantom-1/labels.nrrd", "--materials",
                  "victre", "--orientation", "ALS", "--thickness", pose["thickness"], "--anterior", pose["anterior"], "--series",
                  "closing.pvd", "--series-steps", steps, "-o", "closed.vtu")
    colours = numpy.array([(0, 0, 0), (0.98, 0.86, 0.62), (0.86, 0.42, 0.40), (0.80, 0.62, 0.50), (0.55, 0.38, 0.55)])
    target = plt.imread(tools.demo / "real.png")
    frames = []
    for step in range(steps):
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(tools.work / f"closing_{step:03d}.vtu"))
        reader.Update()
        grid = reader.GetOutput()
        points = vtk_to_numpy(grid.GetPoints().GetData())
        moved = vtk_to_numpy(grid.GetPointData().GetArray("Displacement"))
        place = lesion + moved[numpy.argmin(numpy.linalg.norm(points - moved - lesion, axis=1))]
        thickness = vtk_to_numpy(grid.GetFieldData().GetArray("ThicknessMm"))[0]
        origin = vtk_to_numpy(grid.GetFieldData().GetArray("Placement"))[0]
        plane = vtk.vtkPlane()
        plane.SetOrigin(place)
        plane.SetNormal(0, 1, 0)
        cutter = vtk.vtkCutter()
        cutter.SetCutFunction(plane)
        cutter.SetInputData(grid)
        cutter.Update()
        cut = cutter.GetOutput()
        corners = vtk_to_numpy(cut.GetPoints().GetData())
        triangles = vtk_to_numpy(cut.GetPolys().GetData()).reshape(-1, 4)[:, 1:]
        material = vtk_to_numpy(cut.GetCellData().GetArray("Material")).astype(int)
        tools.run("project", "--mesh", f"closing_{step:03d}.vtu", "--materials", "victre", "--orientation", "ALS", "--thickness", thickness,
                  "--anterior", pose["anterior"], "--columns", 180, "--rows", 260, "--pixel-spacing", 0.42, "-o", "film.mha", "--overwrite")
        shadow = -numpy.log(numpy.maximum(tools.image("film.mha"), 1e-4))
        figure, axes = plt.subplots(1, 3, figsize=(9.6, 4.2), facecolor="#14171c", gridspec_kw={"width_ratios": [1.25, 1, 1]})
        body = PolyCollection(
            corners[triangles][:, :, [0, 2]], facecolors=colours[numpy.clip(material, 0, 4)], edgecolors="face", linewidths=0.2)
        axes[0].add_collection(body)
        middle = origin[2] + 2 + 0.5 * pose["thickness"]  # the support's face is 2 mm above the receptor; both plates move
        for low in (middle - 0.5 * thickness - 3, middle + 0.5 * thickness):
            axes[0].fill([origin[0], 85, 85, origin[0]], [low, low, low + 3, low + 3], color="#9fb4c7")
        axes[0].plot(place[0], place[2], "o", markersize=10, markerfacecolor="none", markeredgecolor="#19e36b", markeredgewidth=2)
        axes[0].set(xlim=(-14, 86), ylim=(-62, 66), aspect="equal")
        axes[1].imshow(shadow, cmap="gray", vmin=0, vmax=numpy.percentile(shadow, 99.5))
        axes[2].imshow(target, cmap="gray")
        last = step == steps - 1
        for axis, title in zip(axes, (f"compression: {thickness:.0f} mm", "synthetic mammogram", "target (FDA phantom, simulated)")):
            axis.set_title(title, color="white", fontsize=10)
            axis.axis("off")
        figure.tight_layout()
        repeats = [False, True] if last else [False]
        for marked in repeats:
            if marked:
                located = subprocess.run([tools.programs / "mammoray", "locate", "--result", tools.demo, "--point", *map(str, lesion)], check=True,
                                         capture_output=True, text=True).stdout
                column, row = map(float, re.search(r"pixel +(\S+) +(\S+)", located).groups())
                wide, high = (2.45 * 10 * float(value) for value in re.search(r"uncertainty +(\S+) x (\S+)", located).groups())
                across = target.shape[1] / 720
                ellipse = Ellipse(
                    (column * across, row * across), 2 * wide * across, 2 * high * across, fill=False, color="#19e36b", linewidth=2)
                axes[2].add_patch(ellipse)
                axes[2].annotate("lesion, 95 %", (column * across, row * across), (12, -26), textcoords="offset points", color="#19e36b")
            data = io.BytesIO()
            figure.savefig(data, dpi=100, facecolor=figure.get_facecolor())
            frames.append(Image.open(data).convert("RGB"))
        plt.close(figure)
    durations = [400] + [140] * (len(frames) - 3) + [700, 2400]
    frames[0].save(here / "film.webp", save_all=True, append_images=frames[1:], duration=durations, loop=0, quality=75, method=4)


@picture("viewer.png")
def draw_viewer(tools):
    tools.run("view", "--result", tools.demo, "--mammogram", root / "Data/victre-phantom-1/victre1_lcc_processing.dcm", "--point", 30, 12, -10,
              "--size", 1500, 940, "--screenshot", here / "viewer.png", "--overwrite")


def run_app(tools, *words):
    """The desktop application on a screen of 96 dots per inch, with settings of its own."""
    display = ["xvfb-run", "--auto-servernum", "--server-args=-screen 0 1600x1000x24 -dpi 96"]
    program = tools.programs / "mammoray-app"
    settings = {**os.environ, "XDG_CONFIG_HOME": str(tools.work / "settings")}
    subprocess.run([*display, program, *map(str, words)], check=True, cwd=tools.work, env=settings)


@picture("app-result.png")
def draw_app_result(tools):
    run_app(tools, "--mammogram", root / "Data/victre-phantom-1/victre1_lcc_processing.dcm", "--pixel", "300,700", "--size", "1400,860",
            "--screenshot", here / "app-result.png", tools.demo)


@picture("app-scene.png")
def draw_app_scene(tools):
    (tools.work / "bearing.json").write_text(json.dumps(BEARING))
    run_app(tools, "--size", "1200,720", "--screenshot", here / "app-scene.png", "bearing.json")


@picture("paraview.png")
def draw_paraview(tools):
    """By the ParaView of ./quickstart paraview, or the one that PVPYTHON names; it needs no plugin."""
    from PIL import Image, ImageChops
    shot = tools.work / "paraview.png"
    tools.run(root / "Applications/ParaViewPlugin/openResult.py", tools.demo, "--lesion=30,12,-10", "--screenshot", shot,
              program=os.environ.get("PVPYTHON", root / "Applications/ParaViewPlugin/pvpython.sh"))
    whole = Image.open(shot).convert("RGB")
    left, top, right, bottom = ImageChops.invert(whole).getbbox()
    whole.crop((left - 20, top - 20, right + 20, bottom + 20)).save(here / "paraview.png", optimize=True)


@picture("report.png")
def draw_report(tools):
    subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1000,1000",
                    f"--screenshot={here / 'report.png'}", f"file://{tools.demo.resolve()}/report.html"], check=True, capture_output=True)


@picture("correct-before.png", "correct-after.png", "correct-changed.png")
def draw_correction(tools):
    """A ball of gland in the phantom's MRI is called fat; the correction paints what the segmentation had found."""
    import numpy
    plt = pyplot()
    colours = {1: (230, 159, 0), 2: (86, 180, 233), 3: (0, 158, 115), 4: (240, 228, 66)}
    names = {1: "fat", 2: "gland", 3: "skin", 4: "chest wall"}

    def read(path):
        header, voxels = path.read_bytes().split(b"\n\n", 1)
        fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line and ":=" not in line)
        size = [int(number) for number in fields["sizes"].split()]
        axes = [[float(number) for number in axis.strip("()").split(",")] for axis in fields["space directions"].split()]
        kind = {"unsigned char": numpy.uint8, "uint8": numpy.uint8, "float": numpy.float32}[fields["type"]]
        values = numpy.frombuffer(gzip.decompress(voxels), kind).reshape(size[::-1])
        return values, [float(numpy.linalg.norm(axis)) for axis in axes]

    def draw(name, slice_of_mri, tissue, spacing, marked=None):
        shown = numpy.repeat(numpy.clip(255 * slice_of_mri / numpy.quantile(slice_of_mri, 0.995), 0, 255)[:, :, None], 3, axis=2)
        if marked is None:
            for label, colour in colours.items():
                shown[tissue == label] = 0.55 * shown[tissue == label] + 0.45 * numpy.array(colour)
        else:
            shown[marked] = (230, 25, 75)
        figure, axes = plt.subplots(figsize=(4.6, 3.4), dpi=100)
        axes.imshow(shown.astype(numpy.uint8), aspect=spacing[1] / spacing[0], interpolation="nearest")
        if marked is None:
            for label, colour in colours.items():
                axes.plot([], [], "s", color=numpy.array(colour) / 255, label=names[label])
            axes.legend(loc="upper right", fontsize=7, framealpha=0.9)
        axes.axis("off")
        figure.savefig(here / name, bbox_inches="tight", pad_inches=0.02)
        plt.close(figure)

    tools.run("study", "--mri-pixel", 1, "--mri-slice", 2, "--mammogram-pixel", 0.3, "--label-spacing", 1, "--anatomy-cell", 8,
              "--gravity-fineness", 5, "--compression-fineness", 7, "-o", "study", program="mammoray-validate")
    tools.run("register", "--study", "study/export", "--side", "left", "--anatomy-cell-size", 8, "--simulation-cell-size", 16,
              "--pixel-sizes", 6, "--iterations", 1, "--free", "thickness", "-o", "corrected")
    labels, spacing = read(tools.work / "corrected/labels.seg.nrrd")
    mri, _ = read(tools.work / "corrected/mri.nrrd")
    k = int(numpy.argmax((labels == 2).sum(axis=(1, 2))))
    places = numpy.argwhere(labels[k] == 2)
    centre = places[numpy.argmin(numpy.abs(places - numpy.median(places, axis=0)).sum(axis=1))]
    rows, columns = numpy.indices(labels[k].shape)
    wrong = (labels[k] == 2) & (numpy.hypot((rows - centre[0]) * spacing[1], (columns - centre[1]) * spacing[0]) < 12)
    tissue = numpy.argwhere(labels[k] != 0)
    low, high = numpy.maximum(tissue.min(axis=0) - 8, 0), tissue.max(axis=0) + 9
    cut = tuple(slice(first, last) for first, last in zip(low, high))
    draw("correct-before.png", mri[k][cut], numpy.where(wrong, 1, labels[k])[cut], spacing)
    draw("correct-after.png", mri[k][cut], labels[k][cut], spacing)
    draw("correct-changed.png", mri[k][cut], labels[k][cut], spacing, wrong[cut])


GALLERY = {f"gallery-{script.stem}.png": script for kind in ("*.py", "*.cxx") for script in sorted((root / "docs/gallery").glob(kind))}


def draw_gallery(tools, script):
    """The picture that a script or a program of the gallery writes. The test Docs.Gallery.Build builds the programs."""
    from PIL import Image
    if script.suffix == ".py":
        run_script(tools, script)
    else:
        program = tools.programs.parent / "Testing/Docs/programs" / script.stem
        subprocess.run([program, tools.work], check=True, cwd=root, stdout=subprocess.DEVNULL)
    made = next(tools.work.glob(f"{script.stem}.p?m"), tools.work / f"{script.stem}.png")
    drawn = Image.open(made)
    drawn.thumbnail((672, 480))
    drawn.save(here / f"gallery-{script.stem}.png", optimize=True)


for name, script in GALLERY.items():
    PICTURES[name] = functools.partial(draw_gallery, script=script)


def check():
    drawn = json.loads(DRAWN.read_text())
    wrong = [f"{name}: no function draws it" for name in drawn if name not in PICTURES]
    for name, function in PICTURES.items():
        path = here / name
        if name not in drawn or not path.exists():
            wrong.append(f"{name}: was never drawn")
        elif drawn[name]["code"] != code_of(function):
            wrong.append(f"{name}: is older than the code that draws it ({getattr(function, '__name__', name)})")
        elif drawn[name]["picture"] != sum_of(path.read_bytes()):
            wrong.append(f"{name}: is not the picture that was drawn")
    for line in wrong:
        print(line + "; docs/pictures/make.py draws it")
    return 1 if wrong else 0


def main():
    if sys.argv[1:] == ["--check"]:
        sys.exit(check())
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("--demo", type=pathlib.Path)
    parser.add_argument("names", nargs="*")
    given = parser.parse_intermixed_args()
    for name in set(given.names) - set(PICTURES):
        parser.error(f"expected one of {', '.join(PICTURES)}, found {name}")
    drawn = json.loads(DRAWN.read_text()) if DRAWN.exists() else {}
    done = []
    with tempfile.TemporaryDirectory(prefix="pictures-") as folder:
        tools = Tools(given.programs.absolute(), given.demo.resolve() if given.demo else None, pathlib.Path(folder))
        for name in given.names or PICTURES:
            function = PICTURES[name]
            if function not in done:
                print(getattr(function, "__name__", name), flush=True)
                function(tools)
                done.append(function)
            for made in (other for other, by in PICTURES.items() if by is function):
                drawn[made] = {"code": code_of(function), "picture": sum_of((here / made).read_bytes())}
            DRAWN.write_text(json.dumps(dict(sorted(drawn.items())), indent=1) + "\n")


main()
