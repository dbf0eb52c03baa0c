#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the site of these pages: Doxygen reads the headers, Sphinx makes the pages.

usage: build.py FOLDER [--check]

FOLDER/VERSION is the site of this version; FOLDER/index.html lists all versions in FOLDER. Warnings are errors. --check builds the pages
without writing HTML. The Python package is that of PYTHONPATH or of
build/release. Exit 125: doxygen, Sphinx or one of its extensions is missing.
"""
import importlib.util
import pathlib
import re
import shutil
import subprocess
import sys

docs = pathlib.Path(__file__).resolve().parent
root = docs.parent


def read_headers(folder):
    """Doxygen's XML, with headers named as they are included."""
    settings = (docs / "Doxyfile").read_text() + f"\nOUTPUT_DIRECTORY = {folder}\n"
    subprocess.run(["doxygen", "-"], input=settings, text=True, cwd=root, check=True)
    for path in (folder / "xml").glob("*.xml"):
        text = path.read_text()
        named = re.sub(r"(<includes[^>]*>)(?=[A-Z]\w*/)", r"\1mammoray/", text)
        if named != text:
            path.write_text(named)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    folder, check = pathlib.Path(sys.argv[1]).resolve(), "--check" in sys.argv[2:]
    missing = [name for name in ("sphinx", "myst_parser", "furo", "breathe") if importlib.util.find_spec(name) is None]
    missing += [] if shutil.which("doxygen") else ["doxygen"]
    if missing:
        print("missing:", *missing)
        sys.exit(125)
    version = re.search(r"^project\(MammoRay VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)
    work = folder / "work"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    read_headers(work)
    subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "dummy" if check else "html", "-d", work / "trees",
                    "-D", f"breathe_projects.MammoRay={work / 'xml'}", docs, folder / version], check=True)
    if not check:
        pages = sorted((path.parent.name for path in folder.glob("*/index.html")), reverse=True)
        (folder / "index.html").write_text(
            "<!DOCTYPE html><html lang=en><meta charset=utf-8><title>MammoRay</title><h1>MammoRay</h1><ul>\n"
            + "".join(f'<li><a href="{name}/index.html">{name}</a></li>\n' for name in pages) + "</ul></html>\n")
    shutil.rmtree(work)


main()
