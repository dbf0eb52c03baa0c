# SPDX-License-Identifier: Apache-2.0
"""Marks in every text of a header and in names of files: none comes out again unless it is asked for."""
import http.server
import os
import shutil
import subprocess
import threading

from dicomBytes import DicomBytes
from program import Count

TEXTS = {b"AE", b"CS", b"LO", b"LT", b"PN", b"SH", b"ST", b"UC", b"UT", b"UR"}
# Texts that a reader has to understand to take the file.
NEEDED = {(8, 0x60), (8, 0x68), (8, 0x08), (0x28, 4), (0x18, 0x5101), (0x20, 0x62), (0x20, 0x20), (0x28, 0x1040),
          (0x18, 0x5100), (8, 5), (0x18, 0x20), (0x18, 0x22), (0x18, 0x23), (0x28, 0x301), (0x28, 0x1056)}
# Texts that exports hold and our own files do not: of the patient, of who treats her, of the place, comments, private.
FURTHER = [((8, 0x50), b"SH"), ((8, 0x70), b"LO"), ((8, 0x80), b"LO"), ((8, 0x81), b"ST"), ((8, 0x90), b"PN"),
           ((8, 0x1010), b"SH"), ((8, 0x1030), b"LO"), ((8, 0x103E), b"LO"), ((8, 0x1040), b"LO"), ((8, 0x1048), b"PN"),
           ((8, 0x1050), b"PN"), ((8, 0x1070), b"PN"), ((8, 0x1090), b"LO"), ((0x10, 0x10), b"PN"), ((0x10, 0x20), b"LO"),
           ((0x10, 0x1000), b"LO"), ((0x10, 0x1001), b"PN"), ((0x10, 0x1005), b"PN"), ((0x10, 0x1040), b"LO"),
           ((0x10, 0x2154), b"SH"), ((0x10, 0x2160), b"SH"), ((0x10, 0x21B0), b"LT"), ((0x10, 0x4000), b"LT"),
           ((0x18, 0x1030), b"LO"), ((0x18, 0x1000), b"LO"), ((0x18, 0x1191), b"CS"), ((0x18, 0x7050), b"CS"),
           ((0x20, 0x10), b"SH"), ((0x20, 0x4000), b"LT"), ((0x32, 0x1060), b"LO"), ((0x40, 0x253), b"SH"),
           ((0x40, 0x254), b"LO"), ((0x9, 0x10), b"LO"), ((0x9, 0x1001), b"UT")]
# The attributes that --same-patient copies, because archives need them; the last three of the MRI's series.
COPIED = {(0x10, 0x10), (0x10, 0x20), (0x10, 0x40), (8, 0x50), (8, 0x90), (0x20, 0x10), (8, 0x70), (8, 0x103E), (0x18, 0x1030)}
MARK = "Zq%sxMark%d^Anna"
COMMON = b"xMark"


class Marks:
    def __init__(self, draws):
        self.draws = draws
        self.made = []
        self.copied = set()

    def new(self, tag=None):
        self.made.append(MARK % (self.draws.choice("abcdefgh"), 100000 + len(self.made)))
        if tag in COPIED:
            self.copied.add(self.made[-1])
        return self.made[-1]

    def plant(self, data):
        """In every text that need not be understood, and in the further ones."""
        file = DicomBytes(data)
        for tag, vr in FURTHER:
            if vr in TEXTS:
                file.set(tag, vr, self.new(tag))
        for entry in file.walk():
            if entry[1] in TEXTS and entry[0] not in NEEDED:
                entry[2] = self.new(entry[0]).encode()
        return file.bytes()

    def found_in(self, data):
        if COMMON not in data:  # hundreds of searches of hundreds of megabytes otherwise
            return []
        return [mark for mark in self.made if mark.encode() in data or mark.split("^")[0].encode() in data]


def outputs(folder):
    for place, _, names in os.walk(folder):
        for name in names:
            with open(os.path.join(place, name), "rb") as file:
                yield os.path.join(place, name), name.encode() + b"\n" + file.read()


def check(count, marks, what, answer, *paths):
    count.add(answer.done(), what, answer.told())
    found = marks.found_in(answer.out.encode() + answer.err.encode())
    count.add(not found, what + ", terminal", found)
    for path in filter(os.path.exists, paths):
        for name, data in outputs(path) if os.path.isdir(path) else [(path, open(path, "rb").read())]:
            found = marks.found_in(data)
            count.add(not found, what + ", " + os.path.basename(name), found)


def try_one_picture(program, marks, count):
    """Files given by hand, with a patient's name in each of their names."""
    folder = program.path("patient")
    os.makedirs(folder)
    names = {}
    for option, source in (("--labels", program.phantom("labels.nrrd")),
                           ("--materials", os.path.join(program.data, "materials", "victre.json"))):
        names[option] = os.path.join(folder, marks.new() + os.path.splitext(source)[1])
        shutil.copy(source, names[option])
    names["--mammogram"] = os.path.join(folder, marks.new() + ".dcm")
    with open(program.phantom("victre1_lcc_processing.dcm"), "rb") as source, open(names["--mammogram"], "wb") as file:
        file.write(marks.plant(source.read()))
    result = program.path("private")
    given = [word for pair in names.items() for word in pair]
    check(count, marks, "register", program.register(result, *given), result)
    synthetic = program.path("private.dcm")
    check(count, marks, "dicom", program.run("dicom", "--result", result, "--mammogram", names["--mammogram"], "-o", synthetic),
          synthetic)
    check(count, marks, "locate", program.run("locate", "--result", result, "--point", 30, 12, -10))
    check(count, marks, "fuse", program.run("fuse", "--result", result, "--image", names["--labels"], "--axes-as-given", "-o",
                                            program.path("private.nrrd")), program.path("private.nrrd"))
    lesion = small_lesion(os.path.join(folder, marks.new() + ".nrrd"))
    check(count, marks, "locate --lesion", program.run("locate", "--result", result, "--lesion", lesion, "--axes-as-given"))
    for extension in (".nrrd", ".mha", ".nii.gz", ".h5", ".tfm"):
        field = program.path("private-field" + extension)
        check(count, marks, "displacement " + extension,
              program.run("displacement", "--result", result, "--spacing", 8, "-o", field), field)
    asked = program.path("named")
    named = program.register(asked, *given, "--name-inputs")
    texts = b"".join(data for _, data in outputs(asked))
    stems = {os.path.basename(path) for path in names.values()}
    count.add(named.done() and any(stem.encode() in texts for stem in stems), "--name-inputs names", named.told())
    beyond = [mark for mark in marks.found_in(texts) if not any(mark in stem for stem in stems)]
    count.add(not beyond, "--name-inputs names files only", beyond)
    try_objects(program, marks, count, ["--result", result, "--mammogram", names["--mammogram"], "--point", 30, 12, -10, "--lesion",
                                        lesion, "--axes-as-given", "--mri", planted_series(program, marks, names["--mammogram"])])


def small_lesion(path):
    """A label of 8 mm about the point that is asked for, in the frame of the labels."""
    with open(path, "wb") as file:
        file.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nspace dimension: 3\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                   b"space origin: (26,8,-14)\nencoding: raw\n\n" + b"\1" * 512)
    return path


def planted_series(program, marks, mammogram):
    """Slices of an MRI with marks; one series of the mammogram's patient."""
    whole = program.path("formats")
    subprocess.run([os.path.join(program.binaries, "damageFiles"), "--write", whole], check=True)
    series = os.path.join(program.path("patient"), marks.new())
    os.makedirs(series)
    with open(mammogram, "rb") as file:
        patient = DicomBytes(file.read())
    shared = {tag: patient.get(tag) for tag in ((0x10, 0x10), (0x10, 0x20))}
    for name in ("slice", "2", "3", "4", "5", "6", "7"):
        with open(os.path.join(whole, name + ".dcm"), "rb") as file:
            planted = DicomBytes(marks.plant(file.read()))
        for entry in planted.walk():
            if entry[1] in TEXTS and entry[0] not in NEEDED:
                entry[2] = shared.setdefault(entry[0], entry[2])
        with open(os.path.join(series, marks.new() + ".dcm"), "wb") as file:
            file.write(planted.bytes())
    return series


def try_objects(program, marks, count, words):
    """All objects of a result, which hold of the patient what archives need, and what of them goes over the wire."""
    refused = program.run("dicom", *words, "-o", program.path("objects-of-nobody"))
    count.add(refused.refused(), "objects, which refer to the mammogram, unasked", refused.told())
    objects = program.path("objects")
    asked = program.run("dicom", *words, "--same-patient", "-o", objects)
    count.add(asked.done(), "dicom --same-patient", asked.told())
    written = list(outputs(objects))
    for path, data in written:
        found = set(marks.found_in(data))
        count.add(bool(found & marks.copied), "--same-patient, %s: of the patient" % os.path.basename(path), "nothing")
        count.add(found <= marks.copied, "--same-patient, %s: no more" % os.path.basename(path), found - marks.copied)
    named = os.path.join(program.path("patient"), marks.new())
    shutil.copytree(objects, named)
    heard = []

    class Archive(http.server.BaseHTTPRequestHandler):
        def do_POST(self):
            heard.append(str(self.headers).encode() + self.path.encode() + self.rfile.read(int(self.headers["Content-Length"])))
            self.send_response(200)
            self.send_header("Content-Length", "2")
            self.end_headers()
            self.wfile.write(b"{}")

        def log_message(self, *_):
            pass

    server = http.server.HTTPServer(("127.0.0.1", 0), Archive)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    sent = program.run("send", "--files", named, "--web", "http://127.0.0.1:%d/dicom-web" % server.server_port)
    server.shutdown()
    found = set(marks.found_in(b"".join(heard))) - marks.copied
    count.add(sent.done() and len(heard) == len(written) >= 6 and not found, "send of all objects", sent.told() + str(found))


def try_meshes(program, marks, count):
    """Tries outputs made of labels alone, whose name is a patient's."""
    labels = os.path.join(program.path("patient"), marks.new() + ".nrrd")
    shutil.copy(program.phantom("labels.nrrd"), labels)
    path = program.path("private-mesh.vtu")
    check(count, marks, "mesh", program.run("mesh", "--labels", labels, "--materials", "victre", "--label-spacing", 3, "-o", path), path)
    mesh = os.path.join(program.path("patient"), marks.new() + ".vtu")
    shutil.copy(path, mesh)
    for name in ("image.dcm", "image.nrrd", "image.mha", "image.png", "image.vti"):
        path = program.path("private-" + name)
        check(count, marks, "project -o " + name,
              program.run("project", "--mesh", mesh, "--materials", "victre", "--orientation", "ALS", "--columns", 60, "--rows", 90,
                          "--pixel-spacing", 1.2, "--thickness", 50, "--side", "left", "-o", path), path)


def try_export(program, marks, count):
    """A clinic's export: what intake prints is asked for, what register writes is not."""
    study = program.path("study")
    made = program.run("study", "-o", study, "--seed", marks.draws.randrange(1, 9), seconds=1800, program="mammoray-validate")
    count.add(made.done(), "mammoray-validate study", made.told())
    export = program.path("export-of-a-patient")
    patient = (marks.new(), marks.new())
    for _, data in outputs(os.path.join(study, "export")):
        data = data[data.index(b"\n") + 1:]
        os.makedirs(export, exist_ok=True)
        if data[128:132] == b"DICM":
            file = DicomBytes(marks.plant(data))
            # One patient, and one description a series, as a clinic has them.
            file.set((0x10, 0x10), b"PN", patient[0]).set((0x10, 0x20), b"LO", patient[1])
            original = DicomBytes(data)
            for tag in ((8, 0x103E), (0x18, 0x1030)):
                if original.get(tag):
                    file.set(tag, b"LO", original.get(tag).decode().strip()[:30] + " " + marks.made[0])
            data = file.bytes()
        with open(os.path.join(export, marks.new() + ".dcm"), "wb") as file:
            file.write(data)
    result = program.path("private-study")
    answer = program.run("register", "--study", export, "--side", "left", "--iterations", 2, "-o", result, seconds=3600)
    check(count, marks, "register --study", answer, result)


def try_privacy(program, draws, quick):
    count = Count("privacy")
    marks = Marks(draws)
    try_one_picture(program, marks, count)
    try_meshes(program, marks, count)
    if not quick:
        try_export(program, marks, count)
    count.notes.append("%d marks" % len(marks.made))
    return count
