#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""checkLicences.py PACKAGE.deb: whether its binaries load nothing whose Debian copyright page names a copyleft licence, and what
they load. Exit 1: one does.

What the page says of files that are not in the library (build scripts, tests, documentation) cannot be told from what is; the list
below names the packages that were read, and why they pass."""
import pathlib
import re
import subprocess
import sys
import tempfile

# Packages whose page names a copyleft licence that does not reach what links them.
READ = {
    "libc6": "the C library, a system library (LGPL)",
    "libgcc-s1": "GCC's runtime library exception",
    "libstdc++6": "GCC's runtime library exception",
    "libxrl11": "BSD-3-clause; the GPL is that of autoconf's and libtool's scripts, with their exceptions",
}
COPYLEFT = re.compile(r"^License:.*\b[AL]?GPL\b|GNU (Lesser |Affero )?General Public", re.MULTILINE)


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def package_of(path):
    """The package a file is from; /lib and /usr/lib are one folder, of which Debian knows one name."""
    for name in (path, path.removeprefix("/usr")):
        found = subprocess.run(["dpkg", "-S", name], capture_output=True, text=True, check=False)
        if found.returncode == 0:
            return found.stdout.split(":")[0]
    raise SystemExit(f"{path}: expected a file of a Debian package")


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    wrong = False
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["dpkg-deb", "-x", sys.argv[1], folder], check=True)
        binaries = [path for path in pathlib.Path(folder).rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\x7fELF"]
        if not binaries:
            print(f"{sys.argv[1]}: expected binaries, found none")
            return 1
        libraries = {pathlib.Path(found).resolve() for binary in binaries
                     for found in re.findall(r"=> (/\S+)", output_of("ldd", str(binary)))}
        for library in sorted(libraries):
            package = package_of(str(library))
            page = pathlib.Path(f"/usr/share/doc/{package}/copyright")
            copyleft = not page.exists() or COPYLEFT.search(page.read_text(errors="replace"))
            if copyleft and package not in READ:
                print(f"{library}: {package} may be under a copyleft licence, see {page}")
                wrong = True
            else:
                print(f"{library.name}: {package}{', ' + READ[package] if copyleft else ''}")
    return 1 if wrong else 0


sys.exit(main())
