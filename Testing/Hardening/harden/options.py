# SPDX-License-Identifier: Apache-2.0
"""Options with values that nobody means: each is refused in a line or two, or the command does its work."""
import json
import os

from program import COARSELY, Count

VALUES = ("", "-", "--", "-h", "=", "a=", "=a", "a=b", " 5", "5 ", "5mm", "1,5", "0x10", "\u0663", "true", "~", "@/etc/passwd",
          "nan", "inf", "-inf", "-1", "0", "-0", "0.5", "2", "1000", "1e9", "1e-9", "1e308", "-1e308", "1e-308", "1e400",
          "4294967296", "18446744073709551616", "9" * 400, "A" * 10000, "%s%n", "a\nmammoray: forged", "\x1b[2J", "\udcff",
          ".", "/", "../..", "/etc/passwd", "/dev/null", "/dev/zero", "/proc/self/mem")


def options_of(program, command):
    """[(name, how many values it takes)] of all that the command line takes."""
    definitions = json.loads(program.run("--print-schema").out)["$defs"]
    found = []
    for option, setting in {**definitions[command]["properties"], **definitions["program"]["properties"]}.items():
        if setting.get("shown", "").startswith("--") and "positional" not in setting:
            found.append(("--" + option, 0 if setting.get("type") == "boolean" else setting.get("minItems", 1)))
    return found


def commands(program, makers):
    """Words of each command that work, without what is tried; {} is the output, with the extension that follows."""
    made = ["--result", program.path("made")]
    mammogram = program.phantom("victre1_lcc_processing.dcm")
    words = {name: makers.commands[name] for name in ("mesh.vtu", "example", "image.mha", "compressed.vtu", "fused.nrrd",
                                                      "field.nrrd", "synthetic.dcm", "segmented.seg.nrrd", "view.png")
             if name in makers.commands}
    words.update({
        "register": ["register", "--labels", program.phantom("labels.nrrd"), "--materials", "victre", "--mammogram", mammogram,
                     "--orientation", "ALS", *COARSELY, "--iterations", 1, "-o", "{}"],
        "locate": ["locate", *made, "--pixel", 300, 500],
        "evaluate": ["evaluate", *made, "--landmarks", program.phantom("landmarks.csv")],
        "devices": ["devices"],
        "intake": ["intake", program.phantom("")],
        "send": ["send", "--files", mammogram, "--web", "http://127.0.0.1:9"],
        "fetch": ["fetch", "--pacs", "127.0.0.1:9", "--accession", "A1", "-o", "{}"],
    })
    return {name: [{"-o": "--output"}.get(word, str(word)) for word in said] for name, said in words.items()}


def without(words, option):
    """The words but for this option and its values."""
    if option not in words:
        return words
    begin = end = words.index(option)
    while end + 1 < len(words) and not words[end + 1].startswith("--"):
        end += 1
    return words[:begin] + words[end + 1:]


def try_options(program, makers, draws, count):
    options = Count("options")
    for name, base in commands(program, makers).items():
        for option, times in options_of(program, base[0]):
            for number in range(max(1, count // 40)):
                value = draws.choice(VALUES)
                output = program.path("option-%d-%s" % (number, name))
                words = [output if word == "{}" else word for word in without(base, option)]
                before = set(os.listdir(program.scratch))
                answer = program.run(*words, option, *[value] * times, seconds=600)
                left = set(os.listdir(program.scratch)) - before
                if base[0] in ("devices", "intake", "send"):
                    answer.out = ""  # what is there, or was refused, is told one by one
                good = answer.done() or ((answer.refused() or answer.misused()) and not left)
                options.add(good, "%s %s %r" % (name, option, value[:40]),
                            answer.told() + ("; left %s" % sorted(left) if left else ""))
                for path in left:
                    program.remove(program.path(path))
    return options
