# SPDX-License-Identifier: Apache-2.0
"""Files that are whole and mean something else: none may be called a match, none may take for ever."""
import json
import os
import re
import struct

from dicomBytes import DicomBytes
from program import Count

MATCH = "The two mammograms match"
SPACINGS = ["3200", "65536", "1e9", "1e-320", "1e308", "0.001", "nan", "inf", "0"]


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, data):
    with open(path, "wb") as file:
        file.write(data)
    return path


def nrrd_with_spacing(data, spacing):
    """The labels with another spacing along the first axis."""
    lines = data.split(b"\n")
    for index, line in enumerate(lines):
        if line.startswith(b"spacings:"):
            lines[index] = b"spacings: " + b" ".join([spacing.encode()] + line.split()[2:])
        elif line.startswith(b"space directions:"):
            vectors = line.split(b":")[1].split()
            vectors[0] = b"(" + spacing.encode() + b",0,0)"
            lines[index] = b"space directions: " + b" ".join(vectors)
    return b"\n".join(lines)


def nrrd_scaled(data, factor):
    """The volume's spacings and origin times a factor."""
    lines = data.split(b"\n")
    for index, line in enumerate(lines):
        key = line.split(b":")[0]
        if key in (b"spacings", b"space directions", b"space origin"):
            lines[index] = re.sub(rb"-?[0-9][0-9.e+-]*", lambda number: b"%.9g" % (float(number.group()) * factor), line)
        if not line:
            break
    return b"\n".join(lines)


class Meanings:
    def __init__(self, program, draws):
        self.program = program
        self.draws = draws
        self.count = Count("meanings")
        self.mammogram = read(program.phantom("victre1_lcc_processing.dcm"))
        with open(os.path.join(program.data, "materials", "victre.json"), encoding="utf-8") as file:
            self.table = json.load(file)

    def changed(self, *elements):
        file = DicomBytes(self.mammogram)
        for tag, vr, value in elements:
            file.set(tag, vr, value)
        return write(self.program.path("meaning-%d.dcm" % self.count.tried), file.bytes())

    def table_with(self, **factors):
        table = json.loads(json.dumps(self.table))
        for material in table["materials"]:
            for key, factor in factors.items():
                if key == "unusual":
                    if material["name"] != "air":
                        material[key] = factor
                elif key in material:
                    material[key] *= factor
        path = self.program.path("meaning-%d.json" % self.count.tried)
        with open(path, "w", encoding="utf-8") as file:
            json.dump(table, file)
        return path

    def refused(self, what, answer):
        self.count.add(answer.refused(), what, answer.told())

    def doubted(self, what, answer):
        """Refused, or done and not called a match."""
        self.count.add(answer.refused() or (answer.done() and MATCH not in answer.out), what, answer.told())

    def at_once(self):
        """Tries files that are refused before any work."""
        register, out = self.program.register, self.program.path("meaning")
        factor = self.draws.choice([1000, 700, 2000, 1e-3])
        self.refused("moduli times %g" % factor, register(out, "--materials", self.table_with(youngs_modulus_kpa=factor)))
        self.refused("densities in kg/m3", register(out, "--materials", self.table_with(density_g_per_cm3=1000)))
        for code in ("ALI", "PLS", "ARS", "PRS", "ILA", "SAL"):
            self.refused("axes " + code, register(out, "--orientation", code))
        same = self.program.phantom("victre1_lcc_processing.dcm")
        self.refused("one picture as two views", register(out, "--mammogram", same, "--mammogram", same))
        for thickness in ("1e9", "0.05", "500", "nan", "inf"):
            self.count.add(register(out, "--thickness", thickness).status in (1, 2), "thickness " + thickness)
        for spacing in ("0.001", "70", "1e9"):
            self.refused("pixels of %s mm" % spacing, register(out, "--pixel-spacing", spacing))
        self.refused("another view than the header's", register(out, "--view", self.draws.choice(("MLO", "LMO", "ML", "LM", "FB"))))
        self.refused("an oblique view's directions of the other breast",
                     register(out, "--mammogram", self.changed(((0x18, 0x5101), b"CS", "MLO"), ((0x20, 0x20), b"CS", "A\\FL"))))
        for what, tag, vr, value in (("a magnification", (0x18, 0x1114), b"DS", "1.8"), ("a part", (0x28, 0x1350), b"CS", "YES"),
                                     ("an implant", (0x28, 0x1300), b"CS", "YES"), ("a spot paddle", (0x18, 0x11A4), b"LO", "SPOT 9CM")):
            self.refused("a picture of %s" % what, register(out, "--mammogram", self.changed((tag, vr, value))))
        self.refused("half an intent", register(out, "--mammogram", self.changed(((8, 0x68), b"CS", "FOR PRESENTATION"))))
        labels = read(self.program.phantom("labels.nrrd"))
        for spacing in SPACINGS:
            path = write(self.program.path("spacing.nrrd"), nrrd_with_spacing(labels, spacing))
            self.refused("voxels of %s mm, register" % spacing, register(out, "--labels", path, seconds=60))
            for words in (["mesh", "--labels", path, "--materials", "victre", "-o", self.program.path("spacing.vtu")],
                          ["segment", "--image", path, "-o", self.program.path("spacing-labels.nrrd")]):
                self.refused("voxels of %s mm, %s" % (spacing, words[0]), self.program.run(*words, seconds=60))
        self.other_units(labels)
        mesh = self.program.path("meaning.obj")
        for vertex in ("nan", "1e400", "inf"):
            write(mesh, ("v %s 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" % vertex).encode())
            self.refused("vertex " + vertex, self.program.run("mesh", "--check", mesh))

    def other_units(self, labels):
        """Whole volumes and headers in another unit, and rescaling that makes numbers none."""
        register, out = self.program.register, self.program.path("meaning")
        for unit, factor in (("m", 1e-3), ("cm", 0.1), ("um", 1e3)):
            path = write(self.program.path("unit.nrrd"), nrrd_scaled(labels, factor))
            self.refused("a volume in " + unit, register(out, "--labels", path))
        for tag, text, what in (((0x18, 0x1110), "66", "source distance in cm"), ((0x18, 0x1164), "0.01\\0.01", "pixels in cm"),
                                ((0x18, 0x11A0), "0.05", "thickness in m"), ((0x28, 0x1053), "0", "slope 0"),
                                ((0x28, 0x1053), "nan", "slope nan"), ((0x28, 0x1053), "1e308", "slope 1e308"),
                                ((0x28, 0x1052), "-1e308", "intercept -1e308")):
            self.refused(what, register(out, "--mammogram", self.changed((tag, b"DS", text))))

    def without_crash(self):
        """Tries files that are accepted on request; they still end well."""
        table = self.table_with(density_g_per_cm3=1000, unusual=True)
        mesh = self.program.path("dense.vtu")
        made = self.program.run("mesh", "--labels", self.program.phantom("labels.nrrd"), "--materials", "victre", "--label-spacing",
                                3, "-o", mesh, "--overwrite")
        self.count.add(made.done(), "mesh", made.told())
        image = ["project", "--mesh", mesh, "--orientation", "ALS", "--columns", 60, "--rows", 90, "--pixel-spacing", 1.2,
                 "-o", self.program.path("dense.mha"), "--overwrite", "--materials"]
        dense = self.program.run(*image, table)
        self.count.add(dense.done() or dense.refused(), "project, densities in kg/m3 as wanted", dense.told())
        self.refused("project --set attenuations, kg/m3", self.program.run(*image, "victre", "--set", "attenuations.fat=adipose@920"))
        self.doubted("register, densities in kg/m3 as wanted",
                     self.program.register(self.program.path("meaning"), "--materials", table))

    def searched(self, quick):
        """Tries files whose fault only a registration can find."""
        register, out = self.program.register, self.program.path("meaning")
        presentation = "1.2.840.10008.5.1.4.1.1.1.2"
        intent = [((8, 0x68), b"CS", "FOR PRESENTATION"), ((8, 0x16), b"UI", presentation), ((2, 2), b"UI", presentation)]
        self.doubted("For Processing called For Presentation", register(out, "--mammogram", self.changed(*intent)))
        if quick:
            return
        self.doubted("the same, its air saturated", register(out, "--mammogram", self.saturated(intent)))
        self.doubted("left called right", register(out, "--mammogram", self.changed(((0x20, 0x62), b"CS", "R"))))
        off = self.draws.choice([-1, 1]) * self.draws.uniform(12, 25)
        self.doubted("header's thickness off by %.0f mm" % off,
                     register(out, "--mammogram", self.changed(((0x18, 0x11A0), b"DS", "%.0f" % (50 + off)))))
        for factor in (1.3, self.draws.uniform(1.2, 1.5), self.draws.uniform(0.6, 0.8)):
            self.doubted("pixels %.2f times too large" % factor, register(out, "--pixel-spacing", "%.4f" % (0.1 * factor)))
        self.doubted("not the left side up", register(out, "--mammogram", self.changed(((0x20, 0x20), b"CS", "A\\L"))))

        self.doubted("CC called MLO", register(out, "--mammogram", self.changed(((0x18, 0x5101), b"CS", "MLO"))))
        self.doubted("the other sign of intensities", register(out, "--mammogram", self.changed(((0x28, 0x1041), b"SS", b"\xff\xff"))))
        self.doubted("signed pixels", register(out, "--mammogram", self.changed(((0x28, 0x103), b"US", b"\1\0"))))
        self.doubted("slope -1", register(out, "--mammogram", self.changed(((0x28, 0x1053), b"DS", "-1"))))
        self.doubted("a picture upside down", register(out, "--mammogram", self.turned(lambda rows: rows[::-1])))
        self.doubted("a picture seen from behind",
                     register(out, "--mammogram", self.turned(lambda rows: [row[::-1] for row in rows])))
        self.doubted("a picture turned about", register(out, "--mammogram", self.turned(lambda rows: [row[::-1] for row in rows[::-1]])))
        self.doubted("fat and gland exchanged", register(out, "--materials", self.exchanged("fat", "gland")))

    def turned(self, turn):
        """The pixels otherwise than the header says."""
        file = DicomBytes(self.mammogram)
        columns, = struct.unpack("<H", file.get((0x28, 0x11)))
        pixels = file.get((0x7FE0, 0x10))
        values = struct.unpack("<%dH" % (len(pixels) // 2), pixels)
        rows = turn([values[start:start + columns] for start in range(0, len(values), columns)])
        file.set((0x7FE0, 0x10), b"OW", b"".join(struct.pack("<%dH" % columns, *row) for row in rows))
        return write(self.program.path("turned-%d.dcm" % self.count.tried), file.bytes())

    def exchanged(self, one, other):
        """The table with the labels of two materials exchanged."""
        table = json.loads(json.dumps(self.table))
        named = {material["name"]: material for material in table["materials"]}
        named[one]["labels"], named[other]["labels"] = named[other]["labels"], named[one]["labels"]
        path = self.program.path("exchanged.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(table, file)
        return path

    def saturated(self, elements):
        """Values of the air at one level, as of a detector that takes no more."""
        file = DicomBytes(read(self.changed(*elements)))
        pixels = file.get((0x7FE0, 0x10))
        values = struct.unpack("<%dH" % (len(pixels) // 2), pixels)
        level = sorted(values)[int(0.9 * len(values))]  # of the air
        file.set((0x7FE0, 0x10), b"OW", struct.pack("<%dH" % len(values), *(min(value, int(0.8 * level)) for value in values)))
        return write(self.program.path("saturated.dcm"), file.bytes())


def try_meanings(program, draws, quick):
    meanings = Meanings(program, draws)
    meanings.at_once()
    meanings.without_crash()
    meanings.searched(quick)
    return meanings.count
