#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Data/case.schema.json and docs/reference/commands say what the program declares, and --help stays short.

usage: checkOptions.py MAMMORAY PROJECT-FOLDER     exit 1: something is wrong; 125: a build without all commands
"""
import json
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "Applications/mammoray"))
import writeReference

# Lines of options in --help, at 100 columns.
MOST_LINES = {"project": 30, "register": 25}
# Case files in the repository, and the commands that read them.
CASE_FILES = {"Data/victre-phantom-1/register.json": "register", "Data/victre-phantom-1/evaluate.json": "evaluate"}


def main():
    program, root = sys.argv[1], pathlib.Path(sys.argv[2])

    def printed(*words):
        return subprocess.run([program, *words], check=True, capture_output=True, text=True, env={**os.environ, "COLUMNS": "100"}).stdout

    if "Not in this build" in printed("--help"):
        return 125
    wrong = []
    text = printed("--print-schema")
    schema = json.loads(text)
    definitions = schema["$defs"]
    results = json.loads((root / "Data/result.schema.json").read_text())
    pages = {f"docs/reference/commands/{name}": page for name, page in writeReference.reference_pages(schema, results).items()}
    for name, made in {"Data/case.schema.json": text, **pages}.items():
        if not (root / name).exists() or (root / name).read_text() != made:
            wrong.append(f"{name}: not what the program declares; writeReference.py MAMMORAY --update . writes it")
    for path in (root / "docs/reference/commands").glob("*.md"):
        if f"docs/reference/commands/{path.name}" not in pages:
            wrong.append(f"{path.relative_to(root)}: of no command")
    declared = sum(len(writeReference.options_of(definition)) for definition in definitions.values())
    lines = {}
    for command, most in MOST_LINES.items():
        lines[command] = sum(line.startswith("  ") for line in printed(command, "--help").splitlines())
        if lines[command] > most:
            wrong.append(f"{command} --help: expected at most {most} lines of options, found {lines[command]}")
    for name, command in CASE_FILES.items():
        for key in set(json.loads((root / name).read_text())) - set(definitions[command]["properties"]):
            wrong.append(f"{name}: {command} has no option {key}")
    for line in wrong:
        print(line)
    print(f"{declared} options; lines of options in --help: {lines}")
    return 1 if wrong else 0


sys.exit(main())
