#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The filters of MammoRay for ParaView 5.11 as its server manager's XML: writeFilters.py DATA FILTERS.xml, where DATA has the material tables
and spectra that users choose from. Properties are called as in the C++ classes. Lengths are mm, angles degrees."""
import pathlib
import sys
from xml.etree import ElementTree


def add(parent, tag, text=None, **attributes):
    child = ElementTree.SubElement(parent, tag, {name: str(value) for name, value in attributes.items()})
    child.text = text
    return child


def number(kind, name, default, help, *, advanced=False, range=None, only_if=None, unless=None):
    """A property of as many numbers as the default has. range: (least, most) or (least,), each as the default; only_if: (PROPERTY, VALUE) with
    which it shows; unless: with which it does not."""
    def make(proxy, data):
        entry = add(proxy, kind + "VectorProperty", name=name, command="Set" + name, number_of_elements=len(default.split()),
                    default_values=default, **({"panel_visibility": "advanced"} if advanced else {}))
        if range:
            add(entry, "DoubleRangeDomain", name="range", **dict(zip(("min", "max"), range)))
        add(entry, "Documentation", help)
        if only_if or unless:
            decorated, value = only_if or unless
            add(add(entry, "Hints"), "PropertyWidgetDecorator", type="GenericDecorator", mode="visibility", property=decorated,
                **({"inverse": 1} if unless else {}), value=value)
        return entry
    return make


def real(*arguments, **more):
    return number("Double", *arguments, **more)


def whole(*arguments, **more):
    return number("Int", *arguments, **more)


def yes_no(name, default, help, **more):
    def make(proxy, data):
        whole(name, default, help, **more)(proxy, data).insert(0, ElementTree.Element("BooleanDomain", name="bool"))
    return make


def one_of(name, texts, help, **more):
    """The first is the default."""
    def make(proxy, data):
        domain = ElementTree.Element("EnumerationDomain", name="enum")
        for value, choice in enumerate(texts):
            add(domain, "Entry", value=value).set("text", choice)
        whole(name, "0", help, **more)(proxy, data).insert(0, domain)
    return make


def text(name, default, help, *, advanced=False):
    def make(proxy, data):
        add(add(proxy, "StringVectorProperty", name=name, command="Set" + name, number_of_elements=1, default_values=default,
                **({"panel_visibility": "advanced"} if advanced else {})), "Documentation", help)
    return make


def shipped(name, default, pattern, label, help, *, empty=None, key=None):
    """One of what is shipped, and a file of one's own that goes before it. empty: what an empty choice means; key: that the file sets."""
    def make(proxy, data):
        entry = add(proxy, "StringVectorProperty", name=name, command="Set" + name, number_of_elements=1, default_values=default)
        domain = add(entry, "StringListDomain", name="shipped")
        for stem in ([""] if empty else []) + sorted(path.stem for path in data.glob(pattern)):
            add(domain, "String", value=stem)
        add(entry, "Documentation", f"{help}; one of your own: {label} File." + (f" Empty: {empty}." if empty else ""))
        add(add(entry, "Hints"), "NoDefault")
        extension = pattern.rpartition(".")[2]
        chosen(name + "File", extension, label.capitalize(),
               f"{help} of your own (.{extension}), which goes before {label}. Empty: none.".replace("shipped ", ""), key=key)(proxy, data)
    return make


def of_key(name, key, help, *, words=(), advanced=False):
    """A key of scene files as a text, empty where it is not set; words: to choose from."""
    def make(proxy, data):
        entry = add(proxy, "StringVectorProperty", name=name, command="SetKey", initial_string=key, number_of_elements=1, default_values="",
                    **({"panel_visibility": "advanced"} if advanced else {}))
        if words:
            domain = add(entry, "StringListDomain", name="words")
            for word in ("", *words):
                add(domain, "String", value=word)
        add(entry, "Documentation", help)
        add(add(entry, "Hints"), "NoDefault")
    return make


def chosen(name, extension, kind, help, *, key=None):
    """A file that users choose. key: of scene files, which it sets in place of a property."""
    def make(proxy, data):
        command = {"command": "SetKey", "initial_string": key} if key else {"command": "Set" + name}
        entry = add(proxy, "StringVectorProperty", name=name, number_of_elements=1, default_values="", **command)
        add(entry, "FileListDomain", name="files")
        add(entry, "Documentation", help)
        add(add(entry, "Hints"), "FileChooser", extensions=extension, file_description=kind)
    return make


def table(empty=None, key=None):
    return shipped("MaterialTable", "victre", "materials/*.json", "Material Table", "A shipped material table", empty=empty, key=key)


def spectrum(empty=None, key=None):
    return shipped("Spectrum", "W28kVp_Rh50um_Be1mm", "spectra/*.spc", "Spectrum", "A shipped spectrum", empty=empty, key=key)


def source(name, port, types, help, *, optional=False):
    """An input."""
    def make(proxy, data):
        entry = add(proxy, "InputProperty", name=name, command="SetInputConnection", port_index=port)
        groups = add(entry, "ProxyGroupDomain", name="groups")
        for group in ("sources", "filters"):
            add(groups, "Group", name=group)
        domain = add(entry, "DataTypeDomain", name="input_type")
        for value in types:
            add(domain, "DataType", value=value)
        if optional:
            add(add(entry, "Hints"), "Optional")
        add(entry, "Documentation", help)
    return make


def time_steps(proxy, data):
    add(add(proxy, "DoubleVectorProperty", name="TimestepValues", information_only=1, repeatable=1), "TimeStepsInformationHelper")


ORIENTATION = text("Orientation", "LPS",
                   "Directions of the data's +x, +y, +z in the patient: one letter each of L/R, A/P, S/I. LPS: DICOM; ALS: the FDA's phantoms.")
UNUSUAL = yes_no("AcceptUnusual", "0", "Take what no patient has, such as voxels of 100 mm, too.", advanced=True)
DEVICE = text("DeviceName", "", "Part of the wanted Vulkan device's name; empty: the most capable one.", advanced=True)
METHOD = one_of("ProjectionMethod", ("Auto", "Ray tracing", "Rasterisation"), "How path lengths are found. Auto traces rays on hardware that can, else "
                "rasterises.", advanced=True)
KERNELS = (
    real("AirGapMm", "17", "Of Scatter: from the back of the tissue to the detector.", range=("0", "200"), only_if=("Scatter", 1)),
    real("Grid", "0 31 65", "Of Scatter: anti-scatter grid of lead before the detector: ratio (0: no grid; else 1 to 30), lines per cm (5 to 200), "
         "micrometres of a septum. Transmissions are relative to air behind it.", range=("0 5 1", "30 200 2000"), only_if=("Scatter", 1)))

# Label, one line of help, what it does, properties.
FILTERS = {
    "BreastMesher": (
        "Breast Mesher", "Label volume to tetrahedra",
        "Meshes a label volume: tetrahedra with the cell array Material. ForMechanics makes the coarse mesh that Breast Compression and Breast "
        "Registration simulate on.",
        source("Input", 0, ["vtkImageData"], "Labels: whole numbers, one component."),
        table("labels are material indices"),
        real("LabelSpacingMm", "0", "Voxel size to which finer labels are resampled first; 0 keeps them."),
        real("CellSizeMm", "4", "Largest circumradius of the cells; 0 with For mechanics: by the size of the breast."),
        whole("NumberOfTriangles", "0", "Number of triangles between materials to end with, within 10 %; 0 takes the sizes as they are.", advanced=True),
        yes_no("ForMechanics", "0", "A coarse mesh to simulate on."),
        UNUSUAL),
    "BreastCompression": (
        "Breast Compression", "Breast between the plates",
        "Squeezes a breast between the plates of a mammography unit. The output has displacement, contact pressure, stress, and where the unit "
        "stands; with more than one time step it is a series from open plates to closed ones.",
        source("Input", 0, ["vtkUnstructuredGrid"], "Linear tetrahedra with the cell array Material."),
        source("SimulationMesh", 1, ["vtkUnstructuredGrid"], "A coarse mesh to simulate on, which carries the input along. Without it the simulation "
               "runs on the input: some thousand cells.", optional=True),
        table(),
        ORIENTATION,
        real("ThicknessMm", "50", "Distance between the faces of support and paddle."),
        real("ForceN", "0", "Of the paddle, in place of the thickness; 0: the thickness counts."),
        real("RollDeg", "0", "Turn of the unit about the anterior axis; 0 is CC, positive to the left."),
        real("PitchDeg", "0", "Turn of the rolled unit about its lateral axis; positive turns the source to the front.", advanced=True),
        real("YawDeg", "0", "Turn of the unit about its vertical axis; positive turns it to the patient's left (CC).", advanced=True),
        real("LateralMm", "0", "Of the receptor along its chest-wall edge."),
        real("AnteriorMm", "0", "Of the receptor away from the chest wall."),
        real("VerticalMm", "0", "Of the plates' mid-plane towards the source.", advanced=True),
        real("TiltDeg", "0", "Turn of the paddle about its chest-wall edge; positive opens it towards the nipple.", advanced=True),
        whole("NumberOfTimeSteps", "1", "Of a series from open plates to closed ones; 1: none."),
        one_of("Element", ("Quadratic", "Linear"), "Of the simulation. Linear takes a tenth of the time and is less accurate."),
        one_of("ChestWall", ("Fixed", "Sliding", "Elastic"), "How the breast is attached to the fixed materials.", advanced=True),
        real("WallStiffness", "1000 1", "Of a sliding or elastic wall against being left, and of an elastic one against gliding.", advanced=True),
        real("Friction", "0", "Coefficient between breast and plates.", advanced=True),
        real("PullN", "0", "Force that draws the breast forwards onto the receptor, spread over its volume.", advanced=True),
        one_of("ImagePosition", ("None", "Prone", "Supine"), "Prone and supine breasts are first unloaded of their weight, then compressed under that "
               "of the standing patient.", advanced=True),
        yes_no("Gravity", "0", "The weight of the standing patient counts even where the position is None.", advanced=True),
        real("SupportEdgeMm", "0", "Chest-wall edge of the support, in front of the receptor's.", advanced=True),
        real("PaddleEdgeMm", "0", "Chest-wall edge of the paddle, in front of the receptor's.", advanced=True),
        real("EdgeRadiusMm", "3", "Of the plates' chest-wall edges.", advanced=True),
        time_steps,
        UNUSUAL),
    "XRayProjector": (
        "X-ray Projector", "Synthetic X-ray of a mesh",
        "X-rays tetrahedra with materials or closed surfaces. The picture lies where the detector is; its arrays are transmission, log attenuation "
        "and the path length in every material.",
        source("Input", 0, ["vtkUnstructuredGrid", "vtkPolyData"], "Tetrahedra with the cell array Material, or closed triangulated surfaces."),
        table(key="materials"),
        spectrum("20 keV", key="beam.spectrum"),
        yes_no("PlacedByInput", "1", "Source and detector stand as the input says, which Breast Compression and Breast Registration do; only pixel "
               "spacing, detector size and the distance of the source count then."),
        real("SourceToDetectorMm", "650", "Where the input places the detector."),
        real("SourcePosition", "0 0 650", "Where the input does not place it."),
        real("DetectorOrigin", "0 0 0", "Centre of the pixel in column 0 and row 0."),
        real("ColumnDirection", "1 0 0", "Unit vector from a pixel to that of the next column.", advanced=True),
        real("RowDirection", "0 1 0", "Unit vector from a pixel to that of the next row.", advanced=True),
        real("PixelSpacing", "0.5 0.5", "Along rows and columns."),
        whole("DetectorSize", "240 400", "Of the detector."),
        of_key("BeamDirection", "source.beam-direction", "Parallel X-rays that travel this way, '[0, 0, -1]', in place of a point source.", advanced=True),
        of_key("Samples", "detector.samples", "Samples x samples rays per pixel; 1 to 16. Empty: 1.", advanced=True),
        of_key("Response", "detector.response", "What the detector adds up. Empty: energy.", words=("energy", "counting"), advanced=True),
        of_key("PhotonsPerPixel", "detector.photons", "Mean number of photons that meet a pixel without the object, whose quantum noise is added; empty: no "
               "noise. Not with Refraction."),
        of_key("NoiseSeed", "detector.seed", "The same seed gives the same noise. Empty: 0.", advanced=True),
        of_key("Scatter", "scatter.method", "Adds what is scattered onto the detector: by kernels, from the thickness along each ray, or by following "
               "photons through the materials. Not with Refraction.", words=("kernels", "monte-carlo")),
        of_key("AirGapMm", "scatter.air-gap", "Of Scatter by kernels: from the back of the tissue to the detector, 0 to 200. Empty: 17."),
        of_key("GridRatio", "scatter.grid.ratio", "Of Scatter: anti-scatter grid of lead before the detector, 1 to 30. Transmissions are relative to air "
               "behind it. Empty: no grid."),
        of_key("GridLinesPerCm", "scatter.grid.lines-per-cm", "Of the grid; 5 to 200. Empty: 31.", advanced=True),
        of_key("GridSeptumUm", "scatter.grid.septum-um", "Thickness of the grid's septa. Empty: 65.", advanced=True),
        of_key("Refraction", "refraction.law", "Bends rays where they pass bodies, whose attenuations must be compositions (H2O, Water, Liquid). geometric: "
               "each ray carries its intensity to where it goes; near-field: transport of intensity. Without noise and scatter; adds the array Deflection.",
               words=("geometric", "near-field")),
        of_key("BendDistanceMm", "refraction.distance", "Of Refraction: from the bodies to the detector. Empty: from their middle."),
        METHOD,
        DEVICE),
    "BreastRegistration": (
        "Breast Registration", "Breast to mammogram",
        "Finds the compression and pose whose synthetic mammogram matches a mammogram. The output is the breast compressed, with displacement, "
        "parameters, covariance and placement of the unit.",
        source("Input", 0, ["vtkUnstructuredGrid", "vtkImageData"], "The breast at rest: tetrahedra with materials, or labels."),
        source("Mammogram", 1, ["vtkImageData"], "A mammogram as its reader gives it."),
        source("SimulationMesh", 2, ["vtkUnstructuredGrid"], "A coarse mesh to simulate on; made of the input where it is missing.", optional=True),
        table(),
        spectrum(),
        yes_no("Scatter", "0", "The picture that is compared has what breast tissue scatters onto the detector, by the thickness along each ray."),
        *KERNELS,
        ORIENTATION,
        text("FreeParameters", "thickness roll lateral anterior", "Names of what is found, with blanks between: thickness, roll, pitch, yaw, lateral, "
             "anterior, vertical, tilt, stiffness."),
        real("ThicknessMm", "0", "0: the mammogram's, else 50."),
        real("RollDeg", "0", "Beside that of the mammogram's view."),
        real("AnteriorMm", "5", "Of the receptor's edge from the chest wall.", advanced=True),
        real("SourceToDetectorMm", "0", "0: the mammogram's, else 650.", advanced=True),
        real("EdgeRadiusMm", "8", "Of the plates' chest-wall edges: wider than a unit's, which is what a breast's mechanics can follow.", advanced=True),
        real("PixelSizesMm", "3 1.5", "In which the pictures are compared, first coarse, then fine.", advanced=True),
        whole("MaximumIterations", "15", "At each pixel size, at most.", advanced=True),
        DEVICE,
        UNUSUAL)}


def add_proxy(group, name, label, short, long, kind=None):
    proxy = add(group, "SourceProxy", name=name, label=label)
    proxy.set("class", "vtk" + (kind or name))
    add(proxy, "Documentation", long, short_help=short, long_help=short)
    return proxy


def server_manager(data):
    """The root element. data: the folder of what is shipped."""
    root = ElementTree.Element("ServerManagerConfiguration")
    group = add(root, "ProxyGroup", name="filters")
    for name, (label, short, long, *properties) in FILTERS.items():
        proxy = add_proxy(group, name, label, short, long)
        for make in properties:
            make(proxy, data)
        add(add(proxy, "Hints"), "ShowInMenu", category="MammoRay")
    sources = add(root, "ProxyGroup", name="sources")
    scene = add_proxy(sources, "SceneProjector", "X-ray of a Scene", "Synthetic X-ray of a scene file",
                      "X-rays the samples of a scene file as its source, detector and beam say.", "XRayProjector")
    for make in (chosen("SceneFile", "json", "Scene", "Path of the scene file."), METHOD, DEVICE):
        make(scene, data)
    add(add(scene, "Hints"), "ShowInMenu", category="MammoRay")
    reader = add_proxy(sources, "MammogramReader", "Mammogram Reader", "Reads a DICOM mammogram",
                       "One frame of modality MG; the first row of the picture on top.")
    entry = add(reader, "StringVectorProperty", name="FileName", command="SetFileName", number_of_elements=1, animateable=0, panel_visibility="never")
    add(entry, "FileListDomain", name="files")
    add(entry, "Documentation", "Path of the DICOM file.")
    add(add(reader, "Hints"), "ReaderFactory", extensions="dcm", file_description="DICOM mammogram")
    return root


if __name__ == "__main__":
    tree = ElementTree.ElementTree(server_manager(pathlib.Path(sys.argv[1])))
    ElementTree.indent(tree)
    tree.write(sys.argv[2], encoding="utf-8", xml_declaration=True)
