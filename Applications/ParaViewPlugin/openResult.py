# SPDX-License-Identifier: Apache-2.0
"""A result of 'mammoray register' in ParaView: the breast at rest and between the plates, the X-ray where the detector is, and the rays
through a lesion. Arrows of how the tissue moved are in the pipeline, hidden. Without the plugin the X-ray is the result's picture.

As a macro (Macros > Import new macro): open the result's uncompressed.vtu, select cells of the lesion if there is one, run.
Without a window: pvpython openResult.py RESULT [--lesion=X,Y,Z] [--radius MM] [--state FILE.pvsm] [--screenshot FILE.png]"""
import argparse
import json
import math
import os
import sys

from paraview import simple

RAYS = 4
FORMAT_VERSION = 5  # Data/result.schema.json


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def combine(origin, *terms):
    """origin + sum of factor * direction."""
    return [o + math.fsum(factor * direction[axis] for factor, direction in terms) for axis, o in enumerate(origin)]


def shown(source, view, **properties):
    display = simple.Show(source, view)
    for name, value in properties.items():
        setattr(display, name, value)
    return display


def plain(source, view, color, **properties):
    """Shown in one colour."""
    shown(source, view, ColorArrayName=["POINTS", ""], DiffuseColor=color, AmbientColor=color, **properties)


def choose(proxy, what, name):
    """A shipped table or spectrum by its name without extension, else the file."""
    shipped = os.path.splitext(name)[0] if os.path.dirname(name) == "" else name
    if shipped in proxy.GetProperty(what).Available:
        setattr(proxy, what, shipped)
    else:
        setattr(proxy, what + "File", name)


def add_xray(squeezed, result, view):
    """The picture on the detector as the registration left it."""
    placed, unit, grid = result["placement"], result["unit"], result["grid"]
    x, y, z, origin = placed["x"], placed["y"], placed["z"], placed["originMm"]
    column, row = grid["columnStepMm"], grid["rowStepMm"]
    spacing = [math.hypot(*column), math.hypot(*row)]
    source = combine(origin, (unit["sourceToDetectorMm"], z))
    corner = combine(origin, (grid["originMm"][0], x), (grid["originMm"][1], y))
    across = combine([0, 0, 0], (column[0] / spacing[0], x), (column[1] / spacing[0], y))
    down = combine([0, 0, 0], (row[0] / spacing[1], x), (row[1] / spacing[1], y))
    if hasattr(simple, "XrayProjector"):
        table = next(entry["file"] for entry in result["inputs"] if entry["role"] == "Material table")
        xray = simple.XrayProjector(registrationName="X-ray", Input=squeezed)
        choose(xray, "MaterialTable", table)
        choose(xray, "Spectrum", result["spectrum"])
        xray.PlacedByInput = 0
        xray.SourcePosition, xray.DetectorOrigin, xray.ColumnDirection, xray.RowDirection = source, corner, across, down
        xray.PixelSpacing = spacing
        xray.DetectorSize = [grid["columns"], grid["rows"]]
    else:
        picture = simple.MetaFileSeriesReader(FileNames=[os.path.join(os.path.dirname(squeezed.FileName[0]), "synthetic.mha")])
        xray = simple.ProgrammableFilter(registrationName="X-ray", Input=picture, OutputDataSetType="vtkImageData")
        normal = [across[1] * down[2] - across[2] * down[1], across[2] * down[0] - across[0] * down[2], across[0] * down[1] - across[1] * down[0]]
        # MetaFileSeriesReader forgets how the picture lies.
        place = f"output.SetOrigin({corner}); output.SetSpacing({spacing + [1]})\n"
        place += f"output.SetDirectionMatrix({[axis[row] for row in range(3) for axis in (across, down, normal)]})\n"
        xray.Script = ("output.DeepCopy(inputs[0].VTKObject)\n" + place + "output.GetPointData().GetScalars().SetName('LogAttenuation')")
        xray.RequestInformationScript = f"""
information = self.GetOutputInformation(0)
information.Set(vtk.vtkDataObject.ORIGIN(), {corner}, 3)
information.Set(vtk.vtkDataObject.SPACING(), {spacing + [1]}, 3)
"""
    display = shown(xray, view, Representation="Slice")
    simple.ColorBy(display, ("POINTS", "LogAttenuation"))
    simple.GetColorTransferFunction("LogAttenuation").ApplyPreset("Grayscale", True)
    display.RescaleTransferFunctionToDataRange(False, True)
    display.SetScalarBarVisibility(view, False)
    return xray


def add_breasts(folder, view):
    """Uncompressed and compressed mesh, and arrows from the one to the other."""
    def reader(name):
        return simple.XMLUnstructuredGridReader(registrationName=name, FileName=[os.path.join(folder, name + ".vtu")])
    rest, squeezed = reader("uncompressed"), reader("compressed")
    plain(rest, view, [0.9, 0.75, 0.65], Representation="Surface", Opacity=0.12)
    gland = simple.Threshold(registrationName="inner tissue", Input=squeezed)
    gland.Scalars = ["CELLS", "Material"]
    materials = squeezed.CellData["Material"].GetRange(0)
    # The first material is fat; the others lie in it, or are its skin.
    gland.LowerThreshold, gland.UpperThreshold = materials[0] + 1, materials[0] + 1
    plain(gland, view, [0.8, 0.3, 0.35], Representation="Surface", Opacity=0.15)
    plain(squeezed, view, [0.6, 0.75, 0.95], Representation="Surface", Opacity=0.3)
    arrows = simple.Glyph(registrationName="displacement", Input=rest, GlyphType="Arrow")
    arrows.OrientationArray = arrows.ScaleArray = ["POINTS", "Displacement"]
    arrows.ScaleFactor = 1.0
    arrows.GlyphMode = "Uniform Spatial Distribution (Bounds Based)"
    arrows.MaximumNumberOfSamplePoints = 400
    display = shown(arrows, view)
    simple.ColorBy(display, ("POINTS", "Displacement", "Magnitude"))
    simple.Hide(arrows, view)
    return rest, squeezed


def displaced(rest, place):
    """Where a place of the breast at rest is between the plates."""
    probe = simple.ProbeLocation(Input=rest, ProbeType="Fixed Radius Point Source")
    probe.ProbeType.Center, probe.ProbeType.NumberOfPoints, probe.ProbeType.Radius = place, 1, 0.0
    data = simple.servermanager.Fetch(probe).GetPointData()
    simple.Delete(probe)
    if not data.GetArray("vtkValidPointMask").GetValue(0):
        raise SystemExit(f"lesion: expected a place in the breast at rest, found {place}")
    return [value + shift for value, shift in zip(place, data.GetArray("Displacement").GetTuple3(0))]


def add_rays(rest, result, lesion, radius, view):
    """From the source to the detector through the lesion's middle and around it, between the plates."""
    placed = result["placement"]
    source = combine(placed["originMm"], (result["unit"]["sourceToDetectorMm"], placed["z"]))
    around = [[radius * math.cos(angle), radius * math.sin(angle)]
              for angle in (2 * math.pi * ray / RAYS for ray in range(RAYS))]
    lines = []
    middle = displaced(rest, lesion)
    for u, v in [[0, 0]] + around:
        through = combine(middle, (u, placed["x"]), (v, placed["y"]))
        height = math.fsum(a * b for a, b in zip(subtract(through, placed["originMm"]), placed["z"]))
        share = result["unit"]["sourceToDetectorMm"] / (result["unit"]["sourceToDetectorMm"] - height)
        # Drawn from somewhat above the paddle: the source is half a metre away.
        above = combine(through, (-0.12, subtract(through, source)))
        lines.append(simple.Line(Point1=above, Point2=combine(source, (share, subtract(through, source)))))
    rays = simple.GroupDatasets(registrationName="rays through the lesion", Input=lines)
    plain(rays, view, [1.0, 0.85, 0.1], LineWidth=3.0)
    ball = simple.Sphere(registrationName="lesion", Center=middle, Radius=radius)
    plain(ball, view, [0.1, 0.8, 0.3])


def look(view, result):
    """From the front, a little from the side and above, so that nothing hides the detector."""
    placed = result["placement"]
    side = -1 if result["mammogram"].get("laterality") == "R" else 1
    simple.ResetCamera(view)
    focus = list(view.CameraFocalPoint)
    view.CameraPosition = combine(focus, (350 * side, placed["x"]), (420, placed["y"]), (260, placed["z"]))
    view.CameraViewUp = placed["z"]
    simple.ResetCamera(view)
    simple.GetActiveCamera().Dolly(1.15)
    view.OrientationAxesVisibility = 0


def open_result(folder, lesion=None, radius=3.0):
    """Everything of a result folder; lesion: a place in the breast at rest, mm. Gives the view."""
    with open(os.path.join(folder, "result.json"), encoding="utf-8") as file:
        result = json.load(file)
    if result.get("formatVersion") != FORMAT_VERSION:
        raise SystemExit(f"{folder}/result.json: field 'formatVersion': expected {FORMAT_VERSION}, found {result.get('formatVersion')}")
    view = simple.GetActiveViewOrCreate("RenderView")
    rest, squeezed = add_breasts(folder, view)
    add_xray(squeezed, result, view)
    if lesion:
        add_rays(rest, result, lesion, radius, view)
    look(view, result)
    simple.Render(view)
    return view


def selected_middle(source):
    """Middle of what is selected of a source; None where nothing is."""
    selection = source.GetSelectionInput(0)
    if not selection:
        return None
    extract = simple.ExtractSelection(Input=source, Selection=selection)
    bounds = extract.GetDataInformation().GetBounds()
    simple.Delete(extract)
    return [0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]) for axis in range(3)] if bounds[0] <= bounds[1] else None


def run_macro():
    """On the folder of the active source, with the lesion that is selected in it."""
    source = simple.GetActiveSource()
    names = source.FileName if source and hasattr(source, "FileName") else None
    if not names:
        raise SystemExit("open the uncompressed.vtu of a result first, then run this macro")
    name = names if isinstance(names, str) else names[0]
    open_result(os.path.dirname(os.path.abspath(name)), selected_middle(source))


def place(text):
    """Three numbers of a text like 30,12,-10."""
    numbers = [float(number) for number in text.split(",")]
    if len(numbers) != 3:
        raise ValueError
    return numbers


def run_command():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", help="folder that 'mammoray register' wrote")
    # With commas: pvpython takes a word like -10 for an option of its own.
    parser.add_argument("--lesion", type=place, metavar="X,Y,Z", help="in the breast at rest, mm")
    parser.add_argument("--radius", type=float, default=3.0, help="of the lesion, mm")
    parser.add_argument("--plugin", help="MammoRay.so, where ParaView does not load it by itself")
    parser.add_argument("--state", help="state file to write (.pvsm), which ParaView's File > Load State opens")
    parser.add_argument("--screenshot", help="picture to write (.png)")
    arguments = parser.parse_args()
    if not os.path.isfile(os.path.join(arguments.result, "result.json")):
        raise SystemExit(f"{arguments.result}: expected a folder with result.json")
    if arguments.plugin:
        simple.LoadPlugin(arguments.plugin, remote=False, ns=vars(simple))
    view = open_result(os.path.abspath(arguments.result), arguments.lesion, arguments.radius)
    if arguments.state:
        simple.SaveState(arguments.state)
    if arguments.screenshot:
        view.ViewSize = [1200, 800]
        simple.SaveScreenshot(arguments.screenshot, view, ImageResolution=[1200, 800], OverrideColorPalette="WhiteBackground")


if __name__ == "__main__":
    # ParaView's window runs a macro without arguments.
    if len(sys.argv) > 1:
        run_command()
    else:
        run_macro()
