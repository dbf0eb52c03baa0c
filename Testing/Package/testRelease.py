#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the quick parts of a release, in a clone: sources, notes, SPDX, sums; what is refused. The workflows of GitHub and GitLab
only call scripts. Exit 125: no git here, or no PyYAML.

usage: testRelease.py PROJECT-FOLDER"""
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile

root = pathlib.Path(sys.argv[1]).resolve()
try:
    import yaml
except ImportError:
    sys.exit(125)


def commands_of(path):
    """Texts that a shell is given by a workflow, and how many jobs it has."""
    said = yaml.safe_load(path.read_text())
    if "jobs" in said:
        jobs = said["jobs"].values()
        return len(jobs), [step["run"] for job in jobs for step in job["steps"] if "run" in step]
    jobs = [job for job in said.values() if "script" in job]
    return len(jobs), [line for job in jobs for key in ("before_script", "script", "after_script") for line in job.get(key, [])]


for name, most in ((".github/workflows/ci.yml", 1), (".github/workflows/release.yml", 1), (".gitlab-ci.yml", 2)):
    jobs, commands = commands_of(root / name)
    assert jobs == most and len(commands) == jobs, f"{name}: expected one command for each job, found {commands}"
    for command in commands:
        script = re.fullmatch(r"(\.ci/\w+)( [$][\w{}. ]+)?", command)
        assert script, f"{name}: expected the call of a script below .ci, found '{command}'"
        assert os.access(root / script.group(1), os.X_OK), f"{name}: expected a script {script.group(1)}"

if subprocess.run(["git", "-C", root, "rev-parse", "HEAD"], capture_output=True).returncode != 0:
    sys.exit(125)
version = re.search(r"^project\(MammoRay VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)
with tempfile.TemporaryDirectory() as folder:
    clone = pathlib.Path(folder) / "clone"
    subprocess.run(["git", "clone", "--quiet", "--shared", root, clone], check=True)

    def release(*arguments):
        done = subprocess.run([clone / "quickstart", "release", *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    code, said = release("9.9.9", "source")
    assert code == 1 and f"expected the version in CMakeLists.txt, {version}, found '9.9.9'" in said, said
    code, said = release(f"v{version}", "sources")
    assert code == 1 and "expected steps among source packages" in said and "found sources" in said, said
    code, said = release(f"v{version}", "source", "notes", "sbom", "sums")
    assert code == 0, said
    out = clone / "build/releases" / version
    for line in (out / "SHA256SUMS").read_text().splitlines():
        digest, name = line.split("  ")
        assert hashlib.sha256((out / name).read_bytes()).hexdigest() == digest, name
    archive = out / f"mammoray-{version}.tar.gz"
    assert {line.split("  ")[1] for line in (out / "SHA256SUMS").read_text().splitlines()} == {
        archive.name, "release-notes.md", f"mammoray-{version}.spdx.json"}
    with tarfile.open(archive) as opened:
        members = opened.getmembers()
    assert all(member.name.split("/")[0] == f"mammoray-{version}" for member in members)
    assert f"mammoray-{version}/quickstart" in {member.name for member in members}
    assert len({member.mtime for member in members}) == 1 and {member.uid for member in members} == {0}
    assert (out / "release-notes.md").read_text().startswith("- **")
    spdx = json.loads((out / f"mammoray-{version}.spdx.json").read_text())
    assert spdx["spdxVersion"] == "SPDX-2.3" and spdx["dataLicense"] == "CC0-1.0" and spdx["SPDXID"] == "SPDXRef-DOCUMENT"
    known = {entry["SPDXID"] for entry in spdx["packages"]} | {"SPDXRef-DOCUMENT"}
    assert len(known) == len(spdx["packages"]) + 1 and all(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", name) for name in known)
    for one in spdx["relationships"]:
        assert {one["spdxElementId"], one["relatedSpdxElement"]} <= known, one
    names = {entry["name"] for entry in spdx["packages"]}
    assert {"mammoray", "libcgal-dev", "libvtk9-dev", archive.name} <= names, names
    # Files that are not committed are no part of a release.
    (clone / "README.md").write_text("changed")
    code, said = release(version, "source")
    assert code == 1 and "expected everything committed, found changes:  M README.md" in said, said
