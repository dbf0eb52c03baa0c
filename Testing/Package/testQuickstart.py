#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks what quickstart installs on each release of Debian and prints elsewhere. The system's commands only note how they are called.
Exit 125: no namespace can be made, in which /etc/os-release is another.

usage: testQuickstart.py PROJECT-FOLDER"""
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1]).resolve()
ways = (["unshare", "--mount"], ["unshare", "--user", "--map-root-user", "--mount"])  # root in a chroot may do the first one only
namespace = next((way for way in ways if subprocess.run([*way, "true"], capture_output=True).returncode == 0), None)
if not namespace:
    sys.exit(125)


def run(codename, *arguments, installed=""):
    """Exit code, what was said, and the calls of apt-get, on a machine of this release where packages but `installed` are missing."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "os-release").write_text(f"ID=any\nVERSION_CODENAME={codename}\n")
        commands = {
            "dpkg-query": f'case "$*" in {installed or "-"}) echo "installed 25.0.7" ;; esac',
            "apt-get": f'echo "$*" >>{folder}/calls; [ "$1" != indextargets ] || echo "http://mirror/debian {codename} main Debian"',
            "apt-cache": "", "cmake": "exit 9", "tee": "cat >/dev/null"}
        for name, text in commands.items():
            (folder / name).write_text(f"#!/bin/sh\n{text}\n")
            (folder / name).chmod(0o755)
        done = subprocess.run(
            [*namespace, "sh", "-c",
             'mount --bind "$0/os-release" /etc/os-release; PATH="$0:$PATH" exec "$@"', folder, root / "quickstart", *arguments],
            capture_output=True, text=True)
        calls = folder / "calls"
        return done.returncode, done.stdout + done.stderr, calls.read_text() if calls.exists() else ""


code, said, calls = run("bookworm", "setup")
assert code == 0 and "clang-tidy-14" in calls and "install -y -q --no-install-recommends -t bookworm-backports mesa-vulkan-drivers" in calls, (code, said, calls)
code, said, calls = run("trixie", "setup")
assert code == 0 and "libvtk9-dev" in calls and " mesa-vulkan-drivers" in calls, (code, said, calls)
assert "backports" not in calls and "clang" not in calls, calls
code, said, calls = run("trixie", "setup", installed="*")
assert code == 0 and "all packages are there" in said and not calls, (code, said, calls)
code, said, calls = run("noble", "demo", installed="*libvtk9-dev")
assert code == 1 and said.count("\n") == 1 and not calls, (code, said, calls)
assert "expected Debian 12 or 13, found noble" in said and "libceres-dev" in said and "libvtk9-dev" not in said, said
code, said, calls = run("trixie", "lint", installed="*")
assert code == 1 and "expected Debian 12, which has clang-format and clang-tidy 14, found Debian 13" in said, (code, said)
code, said, calls = run("bookworm", "test", "--release", "sid")
assert code == 1 and "expected --release bookworm or trixie, found 'sid'" in said, (code, said)
