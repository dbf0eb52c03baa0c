#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clang-format and clang-tidy over our sources; prints what they say. Exit 1: something is to be mended.

usage: lint.py [--format-only] [--jobs N] [--without FILE] BUILD-FOLDER [FILE...]

BUILD-FOLDER: a configured and built one, for its compile_commands.json and generated headers. FILE: only sources whose
path contains one of these; --without: none of these for clang-tidy.

clang-tidy spends its time in the headers of others. So the sources of a module are read in a few pieces, each a file
that includes several of them; sources that use the same name for something of their own go into different pieces.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# The version that the style was written for: others format and warn otherwise.
FORMAT, TIDY = "clang-format-14", "clang-tidy-14"
# A definition of a source at the left margin under a name without `::`: its types, functions, constants and macros; a
# function with what it takes, for others of its name may stand beside it; another name of a type with what it is.
OWN_NAMES = re.compile(
    r"^(?!namespace\b|using namespace\b|return\b|else\b)"
    r"(?:\[\[\w+\]\] )?(?:(?:template|inline|static|constexpr|const)\b[^\n(]*?)?"
    r"(?:using[ ]+(\w+)[ ]*=([^;]*);"
    r"|(?:struct|class|enum class|enum)[ ]+(\w+)"
    r"|#define[ ]+(\w+)"
    r"|[A-Za-z_][\w:<>,&* ]*?[ &*](\w+)[ ]*(?:\(([^)]*)\)|\{|=|\[|$))", re.MULTILINE)

# Sources read together at most.
LARGEST_PIECE = 40

# ITK's headers, made for GCC, refuse clang by its name: for one of them it is a GCC 12.
ITK = "".join([
    "// NOLINTBEGIN\n",
    *(f'#pragma push_macro("{name}")\n#undef {name}\n' for name in ("__clang__", "__GNUC__", "__GNUC_MINOR__")),
    "#define __GNUC__ 12\n#define __GNUC_MINOR__ 2\n// NOLINTEND\n#include <itk_compiler_detection.h>\n",
    *(f'#pragma pop_macro("{name}")\n' for name in ("__clang__", "__GNUC__", "__GNUC_MINOR__"))])



def own_sources():
    for top in ("Modules", "Applications", "Testing", "Validation", "Wrapping"):
        yield from sorted(p for p in (ROOT / top).rglob("*") if p.suffix in (".h", ".cxx"))


def check_format(wanted):
    files = [str(p) for p in own_sources() if wanted(p)]
    done = subprocess.run([FORMAT, "--dry-run", "--Werror", *files], capture_output=True, text=True)
    places = sorted({line.split(": error:")[0].rsplit(":", 2)[0]
                     for line in done.stderr.splitlines() if ": error:" in line})
    for place in places:
        print(f"{os.path.relpath(place, ROOT)}: {FORMAT} would write it otherwise ({FORMAT} -i)")
    return not places and done.returncode == 0


def arguments_of(entry):
    """Compiler arguments without the file, its output, dependencies and precompiled headers."""
    words = entry.get("arguments") or shlex.split(entry["command"])
    while words and not words[0].startswith("-"):
        words.pop(0)
    kept, skip = [], 0
    for position, word in enumerate(words):
        if skip:
            skip -= 1
        elif word in ("-o", "-MF", "-MT", "-c"):
            skip = 1
        elif word == "-include" and "cmake_pch" in words[position + 1]:
            skip = 1
        elif word not in ("-MD", "-Winvalid-pch", "-Werror"):
            kept.append(word)
    return tuple(kept)


def own_names(text):
    """The names that a source defines: by name an alias' type or "(" for functions, which may be told apart by what they take,
    by name and parameters; with None what no other source may define."""
    names = {}
    for alias, type_name, class_name, macro, other, parameters in OWN_NAMES.findall(text):
        if alias:
            names[alias] = type_name.strip()
        elif other and parameters:
            names.setdefault(other, "(")
            names[f"{other}({' '.join(parameters.split())})"] = None
        else:
            names[class_name or macro or other] = None
    return names


def disagree(one, other):
    """True if two sources define something that cannot stand beside the other's."""
    return any(one[name] is None or one[name] != other[name] for name in one.keys() & other.keys())


def sources_of(path):
    """The compiled sources: the file, or those that a unity build's file includes."""
    if path.parent.name != "Unity":
        return [path]
    return [pathlib.Path(name) for name in re.findall(r'#include "(/[^"]+\.cxx)"', path.read_text())]


def compiled(build, wanted):
    """How each of our sources is compiled; of those that tests compile once more, as what they are made for does, which
    is told the most."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        arguments = arguments_of(entry)
        for path in sources_of(pathlib.Path(entry["directory"], entry["file"]).resolve()):
            inside = path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] in ("Modules", "Applications", "Validation")
            if inside and path.suffix == ".cxx" and not path.is_relative_to(build) and wanted(path):
                found[path] = max(found.get(path, ((), "")), (arguments, entry["directory"]), key=lambda how: len(how[0]))
    return found


def pieces(build, wanted):
    """Lists of sources that can be read together, with their arguments."""
    groups = {}
    for path, how in compiled(build, wanted).items():
        groups.setdefault(how, []).append(path)
    for (arguments, directory), paths in groups.items():
        batches = []
        # Xlib's macros change the words that come after.
        texts = {path: path.read_text() for path in paths}
        for path in sorted(texts, key=lambda path: ("<X11/" in texts[path], path)):
            names = own_names(texts[path])
            for batch_names, batch in batches:
                if len(batch) < LARGEST_PIECE and not disagree(batch_names, names):
                    batch_names.update(names)
                    batch.append(path)
                    break
            else:
                batches.append((names, [path]))
        for _, batch in batches:
            yield arguments, directory, batch


def run_tidy(folder, number, arguments, directory, batch):
    place = folder / str(number)
    place.mkdir()
    piece = place / "piece.cxx"
    itk = ITK if any("/ITK-" in word for word in arguments) else ""
    piece.write_text(itk + "".join(f'#include "{path}"\n' for path in batch))
    (place / "compile_commands.json").write_text(json.dumps([{
        "directory": directory, "file": str(piece), "arguments": ["c++", *arguments, "-c", str(piece)]}]))
    done = subprocess.run([TIDY, "-p", str(place), f"--config-file={ROOT / '.clang-tidy'}",
                           # The pieces are made of sources.
                           "--checks=-bugprone-suspicious-include",
                           # Bodies of templates that nothing uses are not read: an eighth of the time.
                           "--extra-arg=-fdelayed-template-parsing", "--quiet", str(piece)],
                          capture_output=True, text=True)
    return done.returncode, done.stdout


def check_tidy(build, wanted, jobs):
    folder = build / "lint"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    work = list(pieces(build, wanted))
    # The largest first, so that none is left alone at the end.
    work.sort(key=lambda piece: -sum(path.stat().st_size for path in piece[2]))
    said, failed, sources = set(), False, 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        runs = {pool.submit(run_tidy, folder, number, *piece): piece for number, piece in enumerate(work)}
        for run in concurrent.futures.as_completed(runs):
            code, text = run.result()
            sources += len(runs[run][2])
            failed = failed or code != 0
            if text not in said:
                said.add(text)
                print(text.replace(f"{ROOT}/", ""), end="", flush=True)
    print(f"clang-tidy read {sources} sources in {len(work)} pieces")
    return sources > 0 and not failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--format-only", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--without", action="append", default=[])
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    for tool in (FORMAT, TIDY):
        if not shutil.which(tool):
            print(f"{tool}: expected on the PATH (a package of Debian 12, not of 13), not found: skipped")
            return 125
    build = options.build.resolve()
    if not (build / "compile_commands.json").exists():
        print(f"{build}: expected a configured build folder with compile_commands.json")
        return 1

    def wanted(path):
        return not options.files or any(part in str(path) for part in options.files)

    good = check_format(wanted)
    if not options.format_only:
        good = check_tidy(build, lambda path: wanted(path) and not any(part in str(path) for part in options.without),
                          options.jobs) and good
    return 0 if good else 1


sys.exit(main())
