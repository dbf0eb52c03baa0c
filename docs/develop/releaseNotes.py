#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints what the changelog says of a release, as the release's notes: releaseNotes.py VERSION.

releaseNotes.py --check: the changelog's first release and the citation are of the version in CMakeLists.txt."""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parents[2]


def sections():
    """Texts by version, in the changelog's order."""
    parts = re.split(r"^## (\S+).*\n", (root / "CHANGELOG.md").read_text(), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def check():
    version = re.search(r"^project\(MammoRay\s+VERSION\s+([\d.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE | re.IGNORECASE).group(1)
    cited = re.search(r"^version: (\S+)$", (root / "CITATION.cff").read_text(), re.MULTILINE).group(1)
    first = next(name for name in sections() if name != "Unreleased")
    if {version, cited, first} != {version}:
        sys.exit(f"expected one version, found {version} in CMakeLists.txt, {cited} in CITATION.cff, {first} in CHANGELOG.md")


if len(sys.argv) != 2:
    sys.exit(__doc__)
if sys.argv[1] == "--check":
    check()
elif sys.argv[1] in sections():
    print(sections()[sys.argv[1]].strip())
else:
    sys.exit(f"CHANGELOG.md: expected a section {sys.argv[1]}, found {', '.join(sections())}")
