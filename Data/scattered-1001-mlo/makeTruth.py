#!/usr/bin/env python3
"""Makes mammogram.dcm and landmarks.csv: CalculiX compresses the phantom of labels.nrrd for an oblique mammogram.

Usage: makeTruth.py TDLU.csv WORKFOLDER

TDLU.csv: breastphantom-scattered-1001/tdlu_locations_mm.csv, the landmarks. Needs the Debian packages calculix-ccx dcmtk
gmsh python3-gmsh python3-numpy python3-scipy python3-vtk9; half an hour.

No code of MammoRay takes part: the mesh is gmsh's, the mechanics CalculiX's (quadratic tetrahedra, neo-Hookean, contact of
surfaces without friction), the picture is summed up voxel by voxel. Units: mm, kPa, mN.
"""
import gzip
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent

# The phantom's frame: x anterior, y the patient's left, z superior. In a left breast's MLO the source is turned towards
# the patient's right.
ROLL_DEG = -47.4
HEADER_ANGLE_DEG = 47  # whole degrees, as units write them
THICKNESS = 58.3
HEADER_THICKNESS = 60  # units read some millimetres beside it
EDGE = 15.0  # phantom's x at which the plates and the receptor begin
EDGE_RADIUS = 6.0
LATERAL = 5.5  # receptor's midline, along the plates' edge, from the phantom's axis
MIDDLE = -4.0  # plates' middle, along their normal, from the phantom's axis
SUPPORT_HEIGHT = 2.0  # of its face over the receptor
SOURCE_TO_DETECTOR = 650.0

# Data/materials/victre.json has 15 kPa for gland.
FAT_KPA, GLAND_KPA, POISSON = 5.0, 30.0, 0.49
GLAND = (29, 88, 95, 125, 150, 225)
MUSCLE = 40  # held

CELL = 8.0
CONTACT_KPA_PER_MM = 60.0

PIXEL = 0.2
QUANTA = 16000  # of an unattenuated pixel
SPECTRUM = "W30kVp_Rh50um_Be1mm"  # the model's is of 28 kVp
# Tables of Data/attenuation: the model tells fewer tissues apart.
TABLES = {1: "adipose", 2: "skin", 33: "skin", 29: "glandular", 95: "glandular", 125: "glandular", 88: "connective",
          150: "blood", 225: "blood", 40: "muscle"}

EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # nodes 5 to 10 of C3D10
FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # S1 to S4


class Labels:
    """A gzipped NRRD of bytes."""

    def __init__(self, path):
        header, data = Path(path).read_bytes().split(b"\n\n", 1)
        fields = dict(line.split(":", 1) for line in header.decode().splitlines() if ": " in line)
        size = [int(n) for n in fields["sizes"].split()]
        directions = fields["space directions"].split()
        self.spacing = np.array([float(v.strip("()").split(",")[i]) for i, v in enumerate(directions)])
        self.origin = np.array([float(v) for v in fields["space origin"].strip(" ()").split(",")])
        self.values = np.frombuffer(gzip.decompress(data), np.uint8).reshape(size[::-1])  # z, y, x

    def at(self, points):
        index = np.rint((points - self.origin) / self.spacing).astype(int)
        inside = np.all((index >= 0) & (index < np.array(self.values.shape[::-1])), axis=-1)
        index = np.where(inside[..., None], index, 0)
        return np.where(inside, self.values[index[..., 2], index[..., 1], index[..., 0]], 0)


def gantry_axes():
    """Rows: the gantry's x, y and z (before its shift) in the phantom's frame."""
    angle = np.radians(ROLL_DEG)
    return np.array([[0, np.cos(angle), -np.sin(angle)], [1, 0, 0], [0, np.sin(angle), np.cos(angle)]])


def write_skin(labels, path):
    """The closed surface of all tissue, smoothed, as STL."""
    import vtk
    from scipy import ndimage
    from vtk.util.numpy_support import numpy_to_vtk

    pad = 6
    mask = ndimage.gaussian_filter(np.pad(labels.values > 0, pad).astype(np.float32), 1.6)
    image = vtk.vtkImageData()
    image.SetDimensions(mask.shape[::-1])
    image.SetSpacing(labels.spacing)
    image.SetOrigin(labels.origin - pad * labels.spacing)
    image.GetPointData().SetScalars(numpy_to_vtk(mask.ravel(), deep=True))
    contour = vtk.vtkMarchingCubes()
    contour.SetInputData(image)
    contour.SetValue(0, 0.5)
    largest = vtk.vtkPolyDataConnectivityFilter()
    largest.SetInputConnection(contour.GetOutputPort())
    largest.SetExtractionModeToLargestRegion()
    decimated = vtk.vtkQuadricDecimation()
    decimated.SetInputConnection(largest.GetOutputPort())
    decimated.SetTargetReduction(0.93)
    writer = vtk.vtkSTLWriter()
    writer.SetInputConnection(decimated.GetOutputPort())
    writer.SetFileName(str(path))
    writer.SetFileTypeToBinary()
    writer.Write()


def tetrahedra(skin):
    """Linear tetrahedra within a surface."""
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.merge(str(skin))
    gmsh.model.mesh.classifySurfaces(np.radians(50), True, True, np.pi)
    gmsh.model.mesh.createGeometry()
    gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop([tag for _, tag in gmsh.model.getEntities(2)])])
    gmsh.model.geo.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", CELL)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.8 * CELL)
    gmsh.model.mesh.generate(3)
    tags, points, _ = gmsh.model.mesh.getNodes()
    cells = gmsh.model.mesh.getElementsByType(4)[1].reshape(-1, 4)
    gmsh.finalize()
    order = np.zeros(int(tags.max()) + 1, int)
    order[tags.astype(int)] = np.arange(len(tags))
    cells = order[cells.astype(int)]
    used = np.unique(cells)
    return points.reshape(-1, 3)[used], np.searchsorted(used, cells)


def with_edge_nodes(nodes, cells):
    pairs = np.sort(np.stack([cells[:, list(edge)] for edge in EDGES], 1).reshape(-1, 2), axis=1)
    unique, where = np.unique(pairs, axis=0, return_inverse=True)
    return np.vstack([nodes, nodes[unique].mean(1)]), np.hstack([cells, len(nodes) + where.reshape(-1, 6)])


def shares(labels, nodes, cells):
    """The parts of gland and of muscle in each cell, from 120 points in it."""
    weights = np.random.default_rng(1).dirichlet(np.ones(4), 120)
    found = labels.at(np.einsum("sk,nkd->nsd", weights, nodes[cells]))
    tissue = np.maximum((found > 0).sum(1), 1)
    return np.isin(found, GLAND).sum(1) / tissue, (found == MUSCLE).sum(1) / tissue


def plate(height, direction, first, radius):
    """Nodes and hexahedra of a plate whose face, at z = `height`, looks along `direction`; its edge, at y = 0, is round."""
    turns = np.radians([90, 67.5, 45, 22.5, 0])
    profiles = [[(radius - r * np.sin(a), r * np.cos(a) - radius) for a in turns] + [(150.0, r - radius)]
                for r in (radius, radius - 2)]
    nodes = np.array([(x, y, height + direction * h) for x in (-140.0, 140.0) for profile in profiles for y, h in profile])
    count, elements = len(profiles[0]), []
    for i in range(count - 1):
        base = [count + i, count + i + 1, 3 * count + i + 1, 3 * count + i]
        face = [i, i + 1, 2 * count + i + 1, 2 * count + i]
        p = nodes[[base[0], base[1], base[3], face[0]]]
        if np.linalg.det(p[1:] - p[0]) < 0:
            base, face = [base[n] for n in (0, 3, 2, 1)], [face[n] for n in (0, 3, 2, 1)]
        elements.append([first + node for node in base + face])
    return nodes, elements


def write_input(nodes, cells, young, soft, ends, radius, largest_step, path):
    """CalculiX's input; `nodes` in the gantry's axes. For each cell Young's modulus, kPa, and whether it is not held; where
    the plates' faces end, along z."""
    middle = np.mean(ends)
    held = np.unique(cells[~soft]) + 1
    faces = np.sort(np.stack([cells[:, list(face)] for face in FACES], 1).reshape(-1, 3), axis=1)
    _, where, count = np.unique(faces, axis=0, return_inverse=True, return_counts=True)
    outer = (count[where] == 1).reshape(-1, 4) & soft[:, None]
    centre = np.stack([nodes[cells[:, list(face)]].mean(1) for face in FACES], 1)
    outer &= centre[..., 1] > -7
    height = nodes[np.unique(cells[soft]), 2]
    low, high = height.min() - 0.5, height.max() + 0.5
    plates = {}
    first = len(nodes) + 1
    for name, at, direction, end in (("SUPPORT", low, 1, ends[0]), ("PADDLE", high, -1, ends[1])):
        corners, elements = plate(at, direction, first, radius)
        plates[name] = (first, corners, elements, end - at)
        first += len(corners)
    with open(path, "w") as file:
        say = lambda text: file.write(text + "\n")
        rows = lambda numbers: say(", ".join(str(n) for n in numbers))
        say("*NODE")
        for i, p in enumerate(np.vstack([nodes, *(each[1] for each in plates.values())])):
            say(f"{i + 1}, {p[0]:.9g}, {p[1]:.9g}, {p[2]:.9g}")
        for part, modulus in enumerate(np.unique(young)):
            say(f"*ELEMENT, TYPE=C3D10, ELSET=TISSUE{part}")
            for cell in np.flatnonzero(young == modulus):
                rows([cell + 1, *(cells[cell] + 1)])
            say(f"*MATERIAL, NAME=M{part}\n*HYPERELASTIC, NEO HOOKE")
            # mu / 2 and 2 / kappa
            say(f"{modulus / (4 * (1 + POISSON)):.9g}, {6 * (1 - 2 * POISSON) / modulus:.9g}")
            say(f"*SOLID SECTION, ELSET=TISSUE{part}, MATERIAL=M{part}")
        say("*MATERIAL, NAME=STIFF\n*ELASTIC\n1e6, 0.3")
        say("*SURFACE INTERACTION, NAME=SMOOTH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR")
        say(f"{CONTACT_KPA_PER_MM}, 0.01")
        number = len(cells)
        for name, (begin, corners, elements, _) in plates.items():
            say(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
            for element in elements:
                number += 1
                rows([number, *element])
            say(f"*SOLID SECTION, ELSET={name}, MATERIAL=STIFF")
            say(f"*NSET, NSET=N{name}, GENERATE\n{begin}, {begin + len(corners) - 1}, 1")
            say(f"*SURFACE, NAME=F{name}\n{name}, S2")
        for name, side in (("SUPPORT", centre[..., 2] < middle + 12), ("PADDLE", centre[..., 2] > middle - 12)):
            say(f"*SURFACE, NAME=SKIN{name}")
            for cell, face in np.argwhere(outer & side):
                say(f"{cell + 1}, S{face + 1}")
            say(f"*CONTACT PAIR, INTERACTION=SMOOTH, TYPE=SURFACE TO SURFACE\nSKIN{name}, F{name}")
        say(f"*NSET, NSET=BREAST, GENERATE\n1, {len(nodes)}, 1\n*NSET, NSET=HELD")
        for i in range(0, len(held), 8):
            rows(held[i : i + 8])
        say("*BOUNDARY\nHELD, 1, 3, 0")
        say(f"*STEP, NLGEOM, INC=2000\n*STATIC\n0.01, 1.0, 1e-6, {largest_step:g}\n*BOUNDARY")
        for name, (*_, way) in plates.items():
            say(f"N{name}, 1, 2, 0\nN{name}, 3, 3, {way:.9g}")
        say("*NODE PRINT, NSET=BREAST, FREQUENCY=1000\nU")
        say("*NODE PRINT, NSET=NPADDLE, TOTALS=ONLY, FREQUENCY=1000\nRF\n*END STEP")


def read_displacements(path, count):
    moved = np.full((count, 3), np.nan)
    for line in path.read_text().split("displacements (vx,vy,vz)")[-1].splitlines():
        words = line.split()
        if len(words) == 4 and words[0].isdigit():
            moved[int(words[0]) - 1] = [float(word) for word in words[1:]]
    if not np.isfinite(moved).all():
        sys.exit(f"{path}: expected displacements of {count} nodes")
    return moved


def write_landmarks(units, nodes, cells, compressed, path):
    """Each unit is carried by the cell that holds it."""
    corners = nodes[cells[:, :4]]
    frames = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
    with open(path, "w") as file:
        file.write("ux,uy,uz,cx,cy,cz,imaged\n")
        for point in units:
            w = np.einsum("nij,nj->ni", frames, point - corners[:, 0])
            w = np.hstack([1 - w.sum(1, keepdims=True), w])
            cell = np.argmax(w.min(1))
            if w[cell].min() < -1e-9:
                continue
            w = w[cell]
            shape = np.array([*(w * (2 * w - 1)), *(4 * w[i] * w[j] for i, j in EDGES)])
            place = shape @ compressed[cells[cell]]
            imaged = place[1] > 0 and SUPPORT_HEIGHT < place[2] < SUPPORT_HEIGHT + THICKNESS
            # As "ALS" of the unit: its y, x and z, a right-handed frame as the phantom's.
            file.write(",".join(f"{v:.3f}" for v in [*point, *place[[1, 0, 2]]]) + f",{int(imaged)}\n")


def rest_places(x, rest, cells, origin, spacing, size):
    """For each voxel (z, y, x) of a grid in the compressed breast the place at rest, NaN outside; each cell is taken as eight
    linear ones. Where none holds a voxel, cells reach a little over their faces: the labels' skin is not the mesh's."""
    parts = [(0, 4, 6, 7), (4, 1, 5, 8), (6, 5, 2, 9), (7, 8, 9, 3), (4, 5, 6, 8), (4, 6, 7, 8), (6, 5, 9, 8), (6, 9, 7, 8)]
    reach = 0.25
    found = np.full((*size[::-1], 3), np.nan, np.float32)
    nearest = np.full(size[::-1], -np.inf, np.float32)
    for tetrahedron in cells[:, parts].reshape(-1, 4):
        p = x[tetrahedron]
        grown = p + reach * (p - p.mean(0))
        low = np.maximum(np.ceil((grown.min(0) - origin) / spacing).astype(int), 0)
        high = np.minimum(np.floor((grown.max(0) - origin) / spacing).astype(int), size - 1)
        if np.any(high < low) or abs(np.linalg.det(p[1:] - p[0])) < 1e-9:
            continue
        k, j, i = (each.ravel() for each in np.meshgrid(*(np.arange(l, h + 1) for l, h in zip(low[::-1], high[::-1])), indexing="ij"))
        w = np.linalg.solve((p[1:] - p[0]).T, (np.stack([i, j, k]).T * spacing + origin - p[0]).T).T
        w = np.hstack([1 - w.sum(1, keepdims=True), w])
        inside = np.minimum(w.min(1), 0)
        better = (inside >= -reach) & (inside > nearest[k, j, i])
        k, j, i = k[better], j[better], i[better]
        nearest[k, j, i] = inside[better]
        found[k, j, i] = w[better] @ rest[tetrahedron]
    return found


def photograph(labels, origin, spacing, rows, columns):
    """The signal of a detector that adds up energy, 1 without breast; row 0 has the largest x, column 0 is at y = 0."""
    spectrum = np.loadtxt(HERE.parent / "spectra" / f"{SPECTRUM}.spc", comments="#")
    spectrum = spectrum[spectrum[:, 1] > 0]
    half_kev = np.rint(spectrum[:, 0] / 500)
    photons = np.array([spectrum[half_kev == b, 1].sum() for b in np.unique(half_kev)])
    energies = np.array([np.average(spectrum[half_kev == b, 0], weights=spectrum[half_kev == b, 1]) for b in np.unique(half_kev)])
    names = sorted(set(TABLES.values()))
    attenuation = []  # 1/mm
    for name in names:
        table = np.loadtxt(HERE.parent / "attenuation" / f"{name}.csv", delimiter=",", skiprows=2, usecols=(0, 5))
        attenuation.append(np.exp(np.interp(np.log(energies), np.log(table[:, 0]), np.log(table[:, 1]))) / 10)
    kinds = np.full(256, -1)
    for label, name in TABLES.items():
        kinds[label] = names.index(name)
    x, y = np.meshgrid(((rows - 1) / 2 - np.arange(rows)) * PIXEL, (np.arange(columns) + 0.5) * PIXEL, indexing="ij")
    lengths = np.zeros((len(names), rows, columns))
    for k, part in enumerate(labels):
        # Where each pixel's ray crosses the middle of the slice.
        scale = 1 - (origin[2] + k * spacing) / SOURCE_TO_DETECTOR
        i = np.rint((x * scale - origin[0]) / spacing).astype(int)
        j = np.rint((y * scale - origin[1]) / spacing).astype(int)
        there = (i >= 0) & (i < part.shape[1]) & (j >= 0) & (j < part.shape[0])
        kind = np.where(there, kinds[part[np.where(there, j, 0), np.where(there, i, 0)]], -1)
        for n in range(len(names)):
            lengths[n] += kind == n
    lengths *= spacing * np.sqrt(x**2 + y**2 + SOURCE_TO_DETECTOR**2) / SOURCE_TO_DETECTOR
    signal = sum(energy * count * np.exp(-np.tensordot(mu, lengths, 1))
                 for energy, count, mu in zip(energies, photons, np.transpose(attenuation)))
    return signal / (energies * photons).sum()


def write_mammogram(signal, work, path):
    noise = np.random.default_rng(1001).normal(size=signal.shape) * np.sqrt(signal / QUANTA)
    np.clip(np.rint((signal + noise) * 12000), 0, 16383).astype("<u2").tofile(work / "pixels.raw")
    rows, columns = signal.shape
    root = "1.2.826.0.1.3680043.8.498.1001"
    elements = {
        "0008,0008 CS": "ORIGINAL\\PRIMARY", "0008,0016 UI": "1.2.840.10008.5.1.4.1.1.1.2.1", "0008,0018 UI": f"{root}.3",
        "0008,0020 DA": "", "0008,0030 TM": "", "0008,0050 SH": "", "0008,0060 CS": "MG", "0008,0068 CS": "FOR PROCESSING",
        "0008,0090 PN": "", "0010,0010 PN": "PHANTOM^SCATTERED", "0010,0020 LO": "SCATTERED-1001", "0010,0030 DA": "",
        "0010,0040 CS": "F", "0018,0015 CS": "BREAST", "0018,0060 DS": "30", "0018,1110 DS": f"{SOURCE_TO_DETECTOR:g}",
        "0018,1164 DS": f"{PIXEL}\\{PIXEL}", "0018,1191 CS": "TUNGSTEN", "0018,11a0 DS": f"{HEADER_THICKNESS}",
        "0018,11a2 DS": "", "0018,1508 CS": "MAMMOGRAPHIC", "0018,1510 DS": f"{HEADER_ANGLE_DEG}", "0018,5101 CS": "MLO",
        "0018,7004 CS": "DIRECT", "0018,7050 CS": "RHODIUM", "0018,7052 DS": "0.05", "0018,7054 DS": "0.05",
        "0020,000d UI": f"{root}.1", "0020,000e UI": f"{root}.2", "0020,0010 SH": "1", "0020,0011 IS": "1", "0020,0013 IS": "1",
        "0020,0020 CS": "A\\FR", "0020,0062 CS": "L", "0028,0002 US": "1", "0028,0004 CS": "MONOCHROME1",
        "0028,0010 US": rows, "0028,0011 US": columns, "0028,0100 US": "16", "0028,0101 US": "14", "0028,0102 US": "13",
        "0028,0103 US": "0", "0028,0301 CS": "NO", "0028,1040 CS": "LIN", "0028,1041 SS": "1", "0028,1052 DS": "0",
        "0028,1053 DS": "1", "0028,1054 LO": "US", "0028,2110 CS": "00", "7fe0,0010 OW": f"={work / 'pixels.raw'}",
    }
    dump = "".join(f"({key[:9]}) {key[10:]} {value}\n" for key, value in elements.items())
    (work / "mammogram.dump").write_text(dump)
    subprocess.run(["dump2dcm", "+te", work / "mammogram.dump", path], check=True)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    units, work = np.loadtxt(sys.argv[1], delimiter=","), Path(sys.argv[2])
    work.mkdir(exist_ok=True)
    labels = Labels(HERE / "labels.nrrd")
    write_skin(labels, work / "skin.stl")
    nodes, cells = tetrahedra(work / "skin.stl")
    gland, muscle = shares(labels, nodes, cells)
    # The gantry's frame is left-handed.
    nodes, cells = with_edge_nodes(nodes, cells[:, [0, 2, 1, 3]])
    gantry = nodes @ gantry_axes().T - [LATERAL, EDGE, 0]
    young = FAT_KPA + np.rint(gland * 20) / 20 * (GLAND_KPA - FAT_KPA)
    ends = MIDDLE - THICKNESS / 2, MIDDLE + THICKNESS / 2
    write_input(gantry, cells, young, muscle <= 0.5, ends, EDGE_RADIUS, 0.03, work / "breast.inp")
    if not (work / "breast.dat").exists() or not (work / "breast.dat").read_text().strip():
        with open(work / "ccx.log", "w") as log:
            subprocess.run(["ccx", "-i", "breast"], cwd=work, check=True, stdout=log)
    compressed = gantry + read_displacements(work / "breast.dat", len(nodes))
    compressed[:, 2] += SUPPORT_HEIGHT - (MIDDLE - THICKNESS / 2)
    write_landmarks(units, nodes, cells, compressed, HERE / "landmarks.csv")

    spacing = 0.4
    shown = compressed[compressed[:, 1] > -2]
    side, tip = np.abs(shown[:, 0]).max() + 4, shown[:, 1].max() + 4
    origin = np.array([-side, -2, SUPPORT_HEIGHT - 10])
    size = np.ceil(np.array([2 * side, tip + 2, THICKNESS + 20]) / spacing).astype(int)
    rest = rest_places(compressed, nodes, cells, origin, spacing, size)
    pictured = np.where(np.isfinite(rest[..., 0]), labels.at(np.nan_to_num(rest)), 0)
    # The shadow is a tenth larger than the breast, with air about it.
    signal = photograph(pictured, origin, spacing, int(2 * (1.1 * side + 8) / PIXEL), int((1.1 * tip + 20) / PIXEL))
    write_mammogram(signal, work, HERE / "mammogram.dcm")


if __name__ == "__main__":
    main()
