#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tries what must not harm: damaged files, wrong meanings, kills, full disks, a failing device, hostile
texts, patients' names. A line for each class: how many were tried, how many were not survived. Exit status 1 where any
was not. `harden.py build/release/bin --seed 7`; README.md of this folder's parent says what each class tries."""
import argparse
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

from dicomBytes import DicomBytes
from meanings import try_meanings
from options import try_options
from privacy import try_privacy
from program import Count, Program
from structures import try_structures

FAULTS = {"submit": "VK_ERROR_DEVICE_LOST", "memory": "VK_ERROR_OUT_OF_DEVICE_MEMORY"}


def try_files(program, seed, count):
    """Damage to files of every format (damageFiles), and to those that were found (replayCorpus)."""
    classes = []
    answer = Count("files")
    run = subprocess.run([os.path.join(program.binaries, "damageFiles"), "--seed", str(seed), "--count", str(count)],
                         stdout=subprocess.PIPE, text=True, check=False)
    for line in run.stdout.splitlines():
        words = line.split()
        if len(words) == 7 and words[0] not in ("format", "all"):
            counts = list(map(int, words[1:]))
            answer.tried += sum(counts)
            answer.bad += ["%s: %d" % (words[0], sum(counts[2:]))] * sum(counts[2:])
        elif words and words[0] == "all":
            answer.notes.append("%s taken, %s refused in one line" % (words[1], words[2]))
    answer.add(run.returncode in (0, 1) and answer.tried > 0, "damageFiles", "exit status %d" % run.returncode)
    classes.append(answer)
    corpus = Count("corpus")
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Corpus")
    run = subprocess.run([os.path.join(program.binaries, "replayCorpus"), folder, str(count), str(seed)],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    corpus.tried = sum(map(int, re.findall(r"(\d+) inputs survived", run.stdout)))
    corpus.add(run.returncode == 0, "replayCorpus", run.stdout[-300:])
    classes.append(corpus)
    return classes


class Makers:
    """Commands that write, of one to five seconds each; those that begin with a result `quick` leaves out. {} is the output."""

    def __init__(self, program, quick):
        self.program = program
        self.mesh = program.path("breast.vtu")
        labels = ["--labels", program.phantom("labels.nrrd"), "--materials", "victre"]
        made = program.run("mesh", *labels, "--label-spacing", 3, "-o", self.mesh, "--overwrite")
        assert made.done(), made.told()
        project = ["project", "--mesh", self.mesh, "--materials", "victre", "--orientation", "ALS", "--columns", 60,
                   "--rows", 90, "--pixel-spacing", 1.2, "--thickness", 50, "-o"]
        self.commands = {
            "mesh.vtu": ["mesh", *labels, "--label-spacing", 3, "-o", "{}"],
            "example": ["example", "test", "-o", "{}"],
            "image.mha": [*project, "{}"],
            "image.nrrd": [*project, "{}"],
            "image.png": [*project, "{}"],
            "image.vti": [*project, "{}"],
            "image.dcm": [*project, "{}", "--side", "left"],
        }
        if quick:
            return
        if os.environ.get("DISPLAY"):
            self.commands["view.png"] = ["view", "--mesh", self.mesh, "--materials", "victre", "--screenshot", "{}"]
        result = ["--result", program.path("made")]
        made = program.register(program.path("made"))
        assert made.done(), made.told()
        self.commands.update({
            "compressed.vtu": ["compress", "--mesh", self.mesh, "--materials", "victre", "--orientation", "ALS", "--thickness",
                               85, "--anterior", 5, "--simulation-cell-size", 12, "-o", "{}"],
            "fused.nrrd": ["fuse", *result, "--image", program.phantom("labels.nrrd"), "--axes-as-given", "--spacing", 2, "-o", "{}"],
            "field.nrrd": ["displacement", *result, "--spacing", 8, "-o", "{}"],
            "segmented.seg.nrrd": ["segment", "--image", program.phantom("labels.nrrd"), "--axes-as-given", "-o", "{}"],
            "curve.csv": ["locate", *result, "--pixel", 300, 500, "-o", "{}"],
            "field.h5": ["displacement", *result, "--spacing", 8, "-o", "{}"],
            "synthetic.dcm": ["dicom", *result, "--mammogram", program.phantom("victre1_lcc_processing.dcm"), "-o", "{}"],
        })

    def words(self, name, output, *rest):
        return [output if word == "{}" else word for word in self.commands[name]] + list(rest)


def contents(folder):
    return sorted(os.path.relpath(os.path.join(place, name), folder)
                  for place, folders, names in os.walk(folder) for name in folders + names)


def size_of(path):
    return sum(os.path.getsize(os.path.join(path, name)) for name in contents(path)) if os.path.isdir(path) \
        else os.path.getsize(path)


def try_kills(program, makers, seed, count):
    """Killed at each system call of a writer (TestIO), and commands at random times."""
    kills = Count("kills")
    run = subprocess.run([os.path.join(program.binaries, "TestIO"), "--gtest_filter=AtomicFile.SurvivesBeingKilled*"],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    points = sum(map(int, re.findall(r"^(\d+) kills", run.stdout, re.M)))
    kills.tried += points
    kills.notes.append("%d at system calls" % points)
    if points or run.returncode != 0 or "SKIPPED" not in run.stdout:
        kills.add(run.returncode == 0, "TestIO", run.stdout[-300:])
    else:
        kills.notes[-1] = "tracing is not allowed here"
    draws = random.Random(seed)
    for name in makers.commands:
        folder = program.path("killed-" + name)
        os.makedirs(folder)
        output = os.path.join(folder, name)
        begun = time.monotonic()
        whole = program.run(*makers.words(name, output))
        lasts = time.monotonic() - begun
        kills.add(whole.done(), name, whole.told())
        size = size_of(output)
        for _ in range(count):
            old = draws.random() < 0.5
            if not old:
                program.remove(output)
            process = program.start(*makers.words(name, output, "--overwrite"))
            try:
                process.wait(draws.uniform(0, 1.1 * lasts))
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            left = os.path.exists(output)
            # Identifiers make files of DICOM differ by a few bytes.
            kills.add(abs(size_of(output) - size) < 64 if left else not old, name + ", killed",
                      "left %s" % ("a cut one" if left else "nothing of the old one"))
            again = program.run(*makers.words(name, output, "--overwrite"))
            kills.add(again.done(), name + ", after a kill", again.told())
        left = [other for other in os.listdir(folder) if other != name]
        kills.add(not left, name + ", leftovers", left)
    return kills


def try_disk(program, makers):
    """A full disk, a read-only one, no permission, mount points, links, and what is printed to a full disk."""
    disk = Count("disk")
    place = program.path("disk")
    os.makedirs(place)
    within = "unshare %s-m bash -c 'mount -t tmpfs -o size=1m none %s; %%s; cd %s; \"$@\"; s=$?; ls -A %s >%s; exit $s' bash {}" % (
        "" if os.geteuid() == 0 else "-r ", place, place, place, program.path("list"))
    allowed = subprocess.run(["unshare", *([] if os.geteuid() == 0 else ["-r"]), "-m", "true"], check=False,
                             stderr=subprocess.DEVNULL).returncode == 0
    for name in makers.commands:
        output = os.path.join(place, name)
        if allowed:
            full = program.run(*makers.words(name, output), shell=within % ("head -c 1044480 /dev/zero >%s/fill" % place))
            with open(program.path("list"), encoding="utf-8") as listed:
                left = listed.read().split()
            disk.add(full.refused() and left == ["fill"], name + " on a full disk", full.told() + str(left))
            locked = program.run(*makers.words(name, output), shell=within % ("mount -o remount,ro %s" % place))
            disk.add(locked.refused(), name + " on a read-only disk", locked.told())
        if os.geteuid() == 0:
            nobody = program.run(*makers.words(name, output), environment={"HOME": "/nonexistent"},
                                 shell="setpriv --reuid 65534 --regid 65534 --clear-groups {}")
            disk.add(nobody.refused() and not os.listdir(place), name + " without permission", nobody.told())
        elsewhere = program.path("target-" + name)
        link = program.path("link-" + name)
        if name == "example":
            os.makedirs(elsewhere)
        os.symlink(elsewhere, link)
        linked = program.run(*makers.words(name, link))
        disk.add(linked.done() and os.path.islink(link) and size_of(elsewhere) > 0, name + " through a link", linked.told())
    if allowed:
        mounted = program.run(*makers.words("example", place), shell=within % ":")
        with open(program.path("list"), encoding="utf-8") as listed:
            disk.add(mounted.done() and len(listed.read().split()) == 3, "a mount point", mounted.told())
    else:
        disk.notes.append("mounting is not allowed here")
    for words in (["devices"], ["--help"], ["register", "--help"], ["mesh", "--print-config", "--labels", "x", "-o", "y"],
                  ["mesh", "--check", makers.mesh]):
        answer = program.run(*words, shell="{} >/dev/full")
        disk.add(answer.status in (1, 2) and len(answer.lines) == 1, "%s to /dev/full" % words[0], answer.told())
    return disk


# Odd surroundings of a process, in which the work is done.
SURROUNDINGS = (("SIGCHLD ignored", "trap '' CHLD; exec {}"),
                ("no home", "unset XDG_CACHE_HOME; HOME=/dev/null exec {}"),
                ("a stack of 1 MiB", "ulimit -s 1024; exec {}"),
                ("16 open files", "ulimit -n 16; exec {}"),
                ("no locale that is there", "exec env LC_ALL=xx_YY.none {}"))


def at_most(kind, limit):
    """Leaves a process no more of a kind (resource.RLIMIT_...), as ulimit does."""
    return lambda: resource.setrlimit(kind, (limit, limit))


def try_file_sizes(program, makers, draws, quick, machine):
    """Limits on the size of files, among them those that drivers map: from no file at all to large ones."""
    for _ in range(2 if quick else 10):
        limit = int(2 ** draws.uniform(12, 28))
        small = at_most(resource.RLIMIT_FSIZE, limit)
        names = ["example", "image.mha", "mesh.vtu", *([] if quick else ("compressed.vtu", "fused.nrrd", "synthetic.dcm"))]
        answers = [program.run("devices", limits=small)]
        answers += [program.run(*makers.words(name, program.path("small-" + name), "--overwrite"), limits=small) for name in names]
        answers += [] if quick else [program.register(program.path("small-result"), limits=small)]
        for answer in answers:
            machine.add(answer.done() or answer.refused(), "files of at most %d KiB" % (limit >> 10), answer.told())


def try_machine(program, makers, draws, quick):
    """Closed streams, odd surroundings, limits on file sizes, and a device that is lost or full at each of its calls."""
    machine = Count("machine")
    for name in makers.commands:
        for closed in ("<&- >&- 2>&-",) if quick else ("<&-", ">&-", "2>&-", "<&- >&- 2>&-"):
            output = program.path("closed-" + name)
            answer = program.run(*makers.words(name, output, "--overwrite"), shell="{} " + closed)
            machine.add(answer.done(), "%s with %s" % (name, closed), answer.told())
        for how, shell in SURROUNDINGS[:2 if quick else None]:
            answer = program.run(*makers.words(name, program.path("around-" + name), "--overwrite"), shell=shell)
            machine.add(answer.done(), "%s with %s" % (name, how), answer.told())
    try_file_sizes(program, makers, draws, quick, machine)
    layer = os.path.join(program.binaries, "..", "Testing", "Hardening", "layer")
    if not os.path.isdir(layer):
        machine.notes.append("no fault layer built")
        return machine
    faults = 0
    for kind, name in FAULTS.items():
        for projector in ("rasterisation", "ray-tracing"):
            for point in range(1, 500):
                words = makers.words("image.mha", program.path("fault.mha"), "--overwrite", "--projector", projector)
                answer = program.run(*words, seconds=120, environment={
                    "VK_LAYER_PATH": layer, "VK_INSTANCE_LAYERS": "VK_LAYER_MAMMORAY_fault",
                    "MAMMORAY_FAULT": "%s %d" % (kind, point)})
                if answer.done() or "ray tracing" in answer.err:
                    break
                faults += 1
                machine.add(answer.refused() and name in answer.err, "%s at call %d" % (name, point), answer.told())
                if quick and point > 3:
                    break
    for kind, name in () if quick else FAULTS.items():
        point = draws.randrange(5, 60)
        answer = program.register(program.path("fault-result"), environment={
            "VK_LAYER_PATH": layer, "VK_INSTANCE_LAYERS": "VK_LAYER_MAMMORAY_fault",
            "MAMMORAY_FAULT": "%s %d" % (kind, point)})
        faults += 1
        machine.add(answer.done() or (answer.refused() and name in answer.err), "register, %s at call %d" % (name, point),
                    answer.told())
    machine.notes.append("%d device faults" % faults)
    return machine


HOSTILE = ["\x1b[2J", "\x1b]0;x\x07", "a\nmammoray: forged", "\r", "\x9b31m", "%s%n", "\u202e", "\x00"]


def try_texts(program, makers):
    """Control characters and line feeds in names of files and in what files hold."""
    texts = Count("texts")

    def add(what, answer):
        plain = all(line.isprintable() for line in answer.err.splitlines() + answer.out.splitlines())
        forged = any(line.startswith("mammoray: forged") for line in answer.err.splitlines())
        texts.add(answer.status in (0, 1, 2) and plain and not forged, what, answer.told())

    with open(program.phantom("victre1_lcc_processing.dcm"), "rb") as file:
        mammogram = file.read()
    with open(os.path.join(program.data, "materials", "victre.json"), encoding="utf-8") as file:
        table = json.load(file)
    for text in HOSTILE:
        if "\x00" not in text:
            for option in ("--labels", "--materials", "--mammogram", "--resume", "--mask", "--anatomy-mesh", "-o"):
                words = {"--labels": program.phantom("labels.nrrd"), "--materials": "victre",
                         "--mammogram": program.phantom("victre1_lcc_processing.dcm"), "-o": program.path("none", "x")}
                words[option] = program.path("absent " + text)
                if option == "-o":
                    words["--labels"] = program.path("absent")
                add("name after " + option, program.run("register", *[word for pair in words.items() for word in pair]))
        for tag, vr in (((0x18, 0x5101), b"CS"), ((0x28, 4), b"CS"), ((8, 0x60), b"CS"), ((8, 0x68), b"CS"),
                        ((0x20, 0x62), b"CS"), ((0x20, 0x20), b"CS"), ((0x28, 0x1040), b"CS"), ((0x18, 0x1191), b"CS")):
            path = program.path("hostile.dcm")
            with open(path, "wb") as file:
                file.write(DicomBytes(mammogram).set(tag, vr, text).bytes())
            add("DICOM element %04x,%04x" % tag, program.run(
                "register", "--labels", program.path("absent.nrrd"), "--materials", "victre", "--mammogram", path,
                "--orientation", "ALS", "-o", program.path("never")))
            folder = program.path("export")
            os.makedirs(folder, exist_ok=True)
            shutil.copy(path, folder)
            add("intake of element %04x,%04x" % tag, program.run("intake", folder))
        if "\x00" in text:
            continue
        changed = json.loads(json.dumps(table))
        changed["materials"][1]["name"] = text
        changed["materials"][2]["attenuation"] = text
        for key in ("name", text):
            path = program.path("table.json")
            with open(path, "w", encoding="utf-8") as file:
                json.dump(dict(changed, **{key: text}), file)
            add("material table", program.run("project", "--mesh", makers.mesh, "--materials", path, "-o",
                                              program.path("texts.mha"), "--overwrite"))
        with open(program.path("hostile.nrrd"), "w", encoding="utf-8", newline="") as file:
            file.write("NRRD0004\ntype: %s\ndimension: 3\nsizes: 2 2 2\nencoding: %s\nspace: %s\n\n" % (text, text, text))
        add("NRRD", program.run("mesh", "--labels", program.path("hostile.nrrd"), "--materials", "victre", "-o",
                                program.path("texts.vtu")))
        with open(program.path("landmarks.csv"), "w", encoding="utf-8", newline="") as file:
            file.write("name,x,y,z\n%s,%s,1,2\n" % (text, text))
        add("landmarks", program.run("evaluate", "--result", program.path("absent"), "--landmarks",
                                     program.path("landmarks.csv")))
        with open(program.path("config.json"), "w", encoding="utf-8") as file:
            json.dump({text: text, "labels": text}, file)
        add("configuration", program.run("mesh", "--config", program.path("config.json")))
    return texts


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("binaries", help="folder with mammoray, damageFiles, replayCorpus and TestIO")
    parser.add_argument("--data", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "Data"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=150, help="damaged files of each format; a tenth of it kills of each "
                        "command, a fortieth of it values of each option")
    parser.add_argument("--only", default="files,structures,kills,disk,machine,texts,options,meanings,privacy")
    parser.add_argument("--quick", action="store_true", help="fewer limits and faults")
    arguments = parser.parse_args()
    program = Program(arguments.binaries, arguments.data)
    os.chmod(program.scratch, 0o755)
    draws = random.Random(arguments.seed)
    classes = arguments.only.split(",")
    makers = Makers(program, arguments.quick) if set(classes) & {"structures", "kills", "disk", "machine", "texts", "options"} else None
    counts = []
    for name in classes:
        begun = time.monotonic()
        if name == "files":
            found = try_files(program, arguments.seed, arguments.count)
        elif name == "structures":
            found = [try_structures(program, makers, draws, arguments.count)]
        elif name == "kills":
            found = [try_kills(program, makers, arguments.seed, max(1, arguments.count // 10))]
        elif name == "disk":
            found = [try_disk(program, makers)]
        elif name == "machine":
            found = [try_machine(program, makers, draws, arguments.quick)]
        elif name == "texts":
            found = [try_texts(program, makers)]
        elif name == "options":
            found = [try_options(program, makers, draws, arguments.count)]
        elif name == "meanings":
            found = [try_meanings(program, draws, arguments.quick)]
        elif name == "privacy":
            found = [try_privacy(program, draws, arguments.quick)]
        else:
            parser.error("no class '%s'" % name)
        found[-1].notes.append("%.0f s" % (time.monotonic() - begun))
        for count in found:
            count.report()
            sys.stdout.flush()
        counts += found
    bad = sum(len(count.bad) for count in counts)
    print("all        %6d tried, %d bad; seed %d" % (sum(count.tried for count in counts), bad, arguments.seed))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
