# SPDX-License-Identifier: Apache-2.0
"""JSON files that are JSON still, but lack a part, hold one twice, or hold something else there, and results whose meshes
are others': each command that reads them does its work or refuses in a line, with no output left."""
import copy
import json
import os
import shutil
import time

from program import COARSELY, Count

VALUES = (None, True, -1, 0, 1, 1.5, -1e9, 1e9, 1e308, 1e-308, 2**32, 2**63, "", "x", "\x1b[2J\nmammoray: forged", [], {}, [[]],
          "../../etc/passwd", "A" * 5000)
FACTORS = (-1, 10, 1000, 1e-3, 1e30, -1e6)

BOX = "".join("v %d %d %d\n" % (x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)) + "".join(
    "f %s\n" % face for face in ("1 3 2", "2 3 4", "5 6 7", "6 8 7", "1 2 5", "2 6 5", "3 7 4", "4 7 8", "1 5 3", "3 5 7",
                                 "2 4 6", "4 8 6"))
SCENE = {"description": "two boxes", "unit": "mm", "source": {"position": [0, -500, 0], "focal-spot": [0.3, 0.3]},
         "detector": {"origin": [-4, 60, 3], "column-direction": [1, 0, 0], "row-direction": [0, 0, -1], "columns": 80, "rows": 60,
                      "pixel-spacing": 0.1},
         "beam": {"kev": 20},
         "samples": [{"file": "box.obj", "unit": "mm", "material": "SiO2@2.2"},
                     {"file": "box.obj", "unit": "um", "material": "SiC@3.2",
                      "rotation": {"axis": [0, 1, 0], "angle": 30}, "translation": [0.5, 0, 0]}],
         "overlap-priority": ["SiC@3.2", "SiO2@2.2"]}


def places(node, path=()):
    """The paths of all parts within."""
    parts = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, part in parts:
        yield path + (key,)
        yield from places(part, path + (key,))


def changed(whole, draws):
    """A copy with one to three parts changed, and what was."""
    document = copy.deepcopy(whole)
    said = []
    for _ in range(draws.choice((1, 1, 1, 2, 3))):
        path = draws.choice(list(places(document)) or [()])
        if not path:
            break
        parent = document
        for key in path[:-1]:
            parent = parent[key]
        part = parent[path[-1]]
        how = draws.randrange(6)
        if how == 0:
            del parent[path[-1]]
            said.append("no %s" % (path,))
        elif how == 1 and isinstance(part, list) and part:
            del part[draws.randrange(len(part)):]
            said.append("%s cut" % (path,))
        elif how == 2 and isinstance(part, list) and part:
            part.extend(copy.deepcopy(part))
            said.append("%s twice" % (path,))
        elif how == 3 and isinstance(part, (int, float)) and not isinstance(part, bool):
            factor = draws.choice(FACTORS)
            parent[path[-1]] = part * factor
            said.append("%s times %g" % (path, factor))
        else:
            value = draws.choice(VALUES)
            parent[path[-1]] = copy.deepcopy(value)
            said.append("%s: %r" % (path, value if not isinstance(value, str) else value[:10]))
    return document, "; ".join(said)


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def registration(program, *words):
    """Words of a short one."""
    return ["register", "--labels", program.phantom("labels.nrrd"), "--materials", "victre", "--mammogram",
            program.phantom("victre1_lcc_processing.dcm"), "--orientation", "ALS", *COARSELY, "--iterations", 1, *words,
            "-o", "{}"]


def checkpoint_of(program, output):
    """The checkpoint of a registration that was killed after its first step; none if it was done before."""
    path = output + ".checkpoint.json"
    words = [output if word == "{}" else 6 if word == 1 else word for word in registration(program)]
    process = program.start(*words)
    while process.poll() is None and not os.path.exists(path):
        time.sleep(0.05)
    process.kill()
    process.wait()
    return read(path) if os.path.exists(path) else None


def files(program, makers, count):
    """[(path, what it holds, commands that read it, times)]; in commands {} is the output."""
    mesh = ["project", "--mesh", makers.mesh, "--orientation", "ALS", "--columns", 40, "--rows", 60, "--pixel-spacing", 2,
            "--thickness", 50]
    found = []
    result = program.path("changed")
    shutil.copytree(program.path("made"), result)
    named = ["--result", result]
    found.append((os.path.join(result, "result.json"), [
        ["locate", *named, "--pixel", 300, 500], ["locate", *named, "--point", 30, 12, -10],
        ["evaluate", *named, "--landmarks", program.phantom("landmarks.csv")],
        ["displacement", *named, "--spacing", 12, "-o", "{}.nrrd"],
        ["fuse", *named, "--image", program.phantom("labels.nrrd"), "--axes-as-given", "--spacing", 4, "-o", "{}.nrrd"],
        ["dicom", *named, "--mammogram", program.phantom("victre1_lcc_processing.dcm"), "-o", "{}.dcm"]], 4 * count))
    found.append((found[0][0], [registration(program, "--resume", result)], count // 8))
    table = program.path("changed-table.json")
    shutil.copy(os.path.join(program.data, "materials", "victre.json"), table)
    found.append((table, [[*mesh, "--materials", table, "-o", "{}.mha"],
                          ["mesh", "--labels", program.phantom("labels.nrrd"), "--materials", table, "--label-spacing", 4,
                           "-o", "{}.vtu"]], 2 * count))
    scene = program.path("changed-scene.json")
    with open(program.path("box.obj"), "w", encoding="utf-8") as file:
        file.write(BOX)
    with open(scene, "w", encoding="utf-8") as file:
        json.dump(SCENE, file)
    found.append((scene, [["project", "--scene", scene, "-o", "{}.mha"]], 4 * count))
    configuration = program.path("changed-options.json")
    with open(configuration, "w", encoding="utf-8") as file:
        file.write(program.run(*mesh, "--materials", "victre", "-o", "x", "--print-config").out)
    found.append((configuration, [["project", "--config", configuration, "-o", "{}.mha"]], 2 * count))
    killed = program.path("killed-registration")
    if checkpoint_of(program, killed):
        found.append((killed + ".checkpoint.json", [registration(program, "--resume", killed)], count // 8))
    return [(path, read(path), commands, times) for path, commands, times in found]


def try_structures(program, makers, draws, count):
    structures = Count("structures")
    done = []

    def add(how, words, may_be_done=True):
        output = program.path("structure-%d" % structures.tried)
        before = set(os.listdir(program.scratch))
        answer = program.run(*[word.replace("{}", output) if isinstance(word, str) else word for word in words], seconds=200)
        left = set(os.listdir(program.scratch)) - before
        done.append(answer.done())
        structures.add((answer.done() and may_be_done) or ((answer.refused() or answer.misused()) and not left), "%s, %s" % (words[0], how),
                       answer.told() + ("; left %s" % sorted(left) if left else ""))
        for name in left:
            program.remove(program.path(name))

    found = files(program, makers, count)
    for path, whole, commands, times in found:
        for _ in range(times):
            document, how = changed(whole, draws)
            with open(path, "w", encoding="utf-8") as file:
                json.dump(document, file)
            add("%s: %s" % (os.path.basename(path), how), draws.choice(commands))
        with open(path, "w", encoding="utf-8") as file:
            json.dump(whole, file)
    # Meshes that are whole, in the place of a result's.
    result, commands = os.path.dirname(found[0][0]), found[0][2]
    made = {name: program.path("made", name) for name in ("uncompressed.vtu", "compressed.vtu")}
    for name, others in (("uncompressed.vtu", (made["compressed.vtu"], makers.mesh)),
                         ("compressed.vtu", (made["uncompressed.vtu"], makers.mesh))):
        for other in others:
            shutil.copy(other, os.path.join(result, name))
            for words in commands:
                # The picture is a file of its own.
                add("%s in the place of %s" % (os.path.basename(other), name), words, words[0] == "dicom")
        shutil.copy(made[name], os.path.join(result, name))
    structures.notes.append("%d done" % sum(done))
    return structures
