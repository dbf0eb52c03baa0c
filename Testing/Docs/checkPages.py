#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the pages of the documentation, and says each fault in a line:

- links to files, pages and headings lead somewhere;
- words are spelt as aspell's dictionary or words.txt has them (left out where there is no aspell);
- pages that a person writes have at most MOST_WORDS words in all, code included (wc -w), README.md at most MOST_LINES lines;
- messages of the page on troubleshooting are in the sources;
- each page of docs with blocks to run is listed in CMakeLists.txt;
- CHANGELOG.md has at most MOST_BULLETS points for each release;
- docstrings and comments of Python have a subject: they do not begin with "What", "Whether", "Of" or "As".

usage: checkPages.py PROJECT-FOLDER [WORD-LIST]
"""
import pathlib
import re
import shutil
import subprocess
import sys

MOST_WORDS = 15000
MOST_LINES = 70
MOST_BULLETS = 10
NO_SUBJECT = re.compile(r'^[^"\'#\n]*(?:"""|# )(?:What|Whether|Of|As) .*', re.MULTILINE)
FENCE = re.compile(r"^( *)```.*?^\1```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(<?([^)\s>]+)>?\)")


def pages_of(root):
    """Markdown files that people read, without what was measured once (Validation/reports are checked for links only)."""
    found = [path for top in ("docs", "Modules", "Applications", "Wrapping", "Validation", "Testing", "Data")
             if (root / top).is_dir() for path in sorted((root / top).rglob("*.md"))]
    return sorted(root.glob("*.md")) + [path for path in found if "build" not in path.relative_to(root).parts]


def is_generated(path):
    return path.parent.name == "commands"


def anchors_of(text):
    """Names of the headings, as GitHub and MyST make them, and of targets: (name)=."""
    names = set(re.findall(r"^\(([\w-]+)\)=$", text, re.MULTILINE))
    for heading in re.findall(r"^#+ +(.+?) *#*$", FENCE.sub("", text), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        names.add(re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-"))
    return names


def check_links(root, path, wrong):
    for target in LINK.findall(re.sub(r"`[^`\n]*`", "", FENCE.sub("", path.read_text()))):
        if re.match(r"\w+:", target):
            continue
        file, _, anchor = target.partition("#")
        there = (path.parent / file) if file else path
        where = f"{path.relative_to(root)}: "
        if not there.exists():
            wrong.append(f"{where}there is no {target}")
        elif anchor and there.suffix == ".md" and anchor not in anchors_of(there.read_text()):
            wrong.append(f"{where}there is no heading {target}")


def prose(text):
    """Text without code, links' targets and markup."""
    text = FENCE.sub("", text)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"`[^`]*`", " ", text)
    text = re.sub(r"^\(([\w-]+)\)=$", "", text, flags=re.MULTILINE)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return re.sub(r"https?://\S+", "", text)


def check_spelling(root, paths, known, wrong):
    if not shutil.which("aspell"):
        print("no aspell: spelling was not checked")
        return
    for path in paths:
        done = subprocess.run(["aspell", "list", "--lang=en_GB", "--ignore-case", "--encoding=utf-8"], input=prose(path.read_text()),
                              capture_output=True, text=True, check=True)
        unknown = {word for word in done.stdout.split() if word.lower() not in known}
        if unknown:
            wrong.append(f"{path.relative_to(root)}: unknown words: {', '.join(sorted(unknown))}")


def check_messages(root, page, wrong):
    """The messages that a page explains, a code span in the first cell of a row, are in the sources: a run of words of each."""
    if not page.exists():
        return
    sources = " ".join(path.read_text(errors="replace") for top in ("Modules", "Applications") if (root / top).is_dir()
                       for path in sorted((root / top).rglob("*.cxx")) + sorted((root / top).rglob("*.h")))
    sources = re.sub(r'"\s*(?:\+\s*)?"', "", sources)  # literals that are written in parts
    for message in re.findall(r"^\| `([^`]+)`", page.read_text(), re.MULTILINE):
        runs = re.findall(r"[A-Za-z,][A-Za-z, -]*[A-Za-z]", message)
        if not any(len(run) >= 7 and run in sources for run in runs):
            wrong.append(f"{page.relative_to(root)}: no source says: {message}")


def check_changes(path, wrong):
    for release in re.split(r"^## ", path.read_text(), flags=re.MULTILINE)[1:] if path.exists() else []:
        bullets = len(re.findall(r"^- ", release, re.MULTILINE))
        if bullets > MOST_BULLETS:
            wrong.append(f"{path.name}: {release.split()[0]}: expected at most {MOST_BULLETS} points, found {bullets}")


def check_subjects(root, wrong):
    for top in ("Applications", "Packaging", "Testing", "Validation", "Wrapping", "docs"):
        for path in sorted((root / top).rglob("*.py")) if (root / top).is_dir() else []:
            for found in NO_SUBJECT.findall(path.read_text()):
                wrong.append(f"{path.relative_to(root)}: expected a subject: {found.strip()}")


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    here = pathlib.Path(__file__).resolve().parent
    words = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else here / "words.txt"
    wrong = []
    pages = pages_of(root)
    for path in pages:
        check_links(root, path, wrong)
    written = [path for path in (root / "docs").rglob("*.md") if not is_generated(path)]
    known = {word.lower() for word in words.read_text().split()}
    check_spelling(root, written + [root / "README.md"], known, wrong)
    check_messages(root, root / "docs/how-to/troubleshooting.md", wrong)
    total = sum(len(path.read_text().split()) for path in written)
    if total > MOST_WORDS:
        wrong.append(f"docs: expected at most {MOST_WORDS} words, found {total}")
    lines = len((root / "README.md").read_text().splitlines())
    if lines > MOST_LINES:
        wrong.append(f"README.md: expected at most {MOST_LINES} lines, found {lines}")
    check_changes(root / "CHANGELOG.md", wrong)
    check_subjects(root, wrong)
    listed = root / "Testing/Docs/CMakeLists.txt"
    for path in written:
        runs = re.search(r"^ *```\w+ (run|of) *", path.read_text(), re.MULTILINE)
        name = path.relative_to(root / "docs").with_suffix("").as_posix()
        if runs and path.stem != "testing" and listed.exists() and not re.search(rf"\b({name}|{path.stem})\b", listed.read_text()):
            wrong.append(f"docs/{name}.md: has blocks to run, but Testing/Docs/CMakeLists.txt does not list it")
    for line in wrong:
        print(line)
    print(f"{len(pages)} pages, {total} words in docs without what is generated")
    return 1 if wrong else 0


sys.exit(main())
