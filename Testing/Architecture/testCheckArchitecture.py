#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""checkArchitecture.py finds each kind of breach in a small tree that is right otherwise."""
import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).with_name("checkArchitecture.py")


def write(root, name, text):
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def tree(root):
    """Foundation with a header, XRay above it."""
    for module, depends, names in (
            ("Foundation", "", ("Error",)), ("XRay", "  MammoRay::Foundation\n", ("Beam",)), ("IO", "", ("Files", "Scenes")),
            ("Registration", "", ("Fit",))):
        write(root, f"Modules/{module}/vtk.module", f"NAME\n  MammoRay::{module}\nDEPENDS\n{depends}")
        write(root, f"Modules/{module}/README.md", f"# {module}\n")
        write(root, f"Modules/{module}/CMakeLists.txt",
              "HEADERS\n" + "".join(f"{n}.h\n" for n in names) + "SOURCES\n" + "".join(f"{n}.cxx\n" for n in names)
              + "PRIVATE_HEADERS\nPrivate/Own.h Inner.h\n")
        write(root, f"Modules/{module}/Inner.h", "")
        for n in names:
            write(root, f"Modules/{module}/{n}.h", "")
            write(root, f"Modules/{module}/{n}.cxx", f'#include "mammoray/{module}/{n}.h"\n#include "Private/Own.h"\n')
        write(root, f"Modules/{module}/Private/Own.h", "")
    write(root, "Modules/XRay/Beam.h", '#include "mammoray/Foundation/Error.h"\n')
    write(root, "Modules/IO/Scenes.cxx", '#include "mammoray/IO/Files.h"\n')
    write(root, "Testing/XRay/TestBeam.cxx", '#include "mammoray/XRay/Private/Own.h"\n')
    write(root, "Validation/Twins.h", '#include "mammoray/XRay/Private/Own.h"\n')
    (root / "Applications").mkdir()


BREACHES = {
    "Modules/Foundation/Error.cxx": ('#include "mammoray/XRay/Beam.h"\n', "Foundation must not include"),
    "Modules/IO/Files.cxx": ('#include "mammoray/Registration/Fit.h"\n', "IO must not include"),
    "Modules/Registration/Fit.cxx": ('#include "mammoray/IO/Files.h"\n', "Registration must not include"),
    "Modules/Registration/Fit.h": ('#include "mammoray/XRay/Beam.h"\n', "does not name MammoRay::XRay"),
    "Modules/XRay/Beam.cxx": ('#include "Error.h"\n', "expected mammoray/<Module>/Error.h"),
    "Modules/IO/Files.h": ('#include "Private/Own.h"\n', "a public header includes"),
    "Modules/XRay/Beam.h": ('#include "mammoray/Foundation/Private/Own.h"\n', "is no public header"),
    "Modules/Foundation/Error.h": ('const char* hint = "--kev gives one";\n', "names the option --kev"),
    "Modules/Foundation/Error.h": ('#include "mammoray/Foundation/Inner.h"\n', "is installed, but mammoray/Foundation/Inner.h is not"),
    "Modules/IO/Unlisted.cxx": ("", "does not list Unlisted.cxx"),
    "Wrapping/Python/projector/CMakeLists.txt": ('"${root}/Modules/IO/Scenes.cxx"\n', "lacks Files.cxx, whose header Scenes.cxx includes"),
    "Wrapping/wrap.cxx": ('#include "Twins.h"\n', "must not include Twins.h of Validation"),
    "Applications/tool.cxx": ('#include "../Validation/Other.h"\n', "must not include ../Validation/Other.h"),
    "docs/develop/architecture.md": ("`Private/Own.h`, `Beams.cxx`\n", "there is no Beams.cxx"),
    "Modules/XRay/Private/Own.h": ("#include <sys/wait.h>\n", "includes sys/wait.h, but docs/develop/architecture.md does not name it"),
    "Testing/IO/TestFiles.cxx": ('#include "mammoray/XRay/Private/Own.h"\n', "is private to XRay"),
}


def run(root):
    done = subprocess.run([sys.executable, str(CHECK), str(root)], capture_output=True, text=True)
    return done.returncode, done.stdout


def main():
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        tree(pathlib.Path(folder))
        code, text = run(folder)
        if code != 0:
            failures += 1
            print(f"expected no breach, found\n{text}")
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        tree(root)
        write(root, "Modules/IO/Inner.h", 'int file = memfd_create("a", 0);\n')
        alone = run(root)
        write(root, "Modules/IO/Private/Own.h", 'int file = open("/proc/self/fd/1", 0);\n')
        both = run(root)
        if alone[0] != 0 or both[0] != 1 or "expected calls of Linux in one file, found Inner.h, Private/Own.h" not in both[1]:
            failures += 1
            print(f"calls of Linux: found {alone}, then {both}")
    for name, (text, expected) in BREACHES.items():
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            tree(root)
            write(root, name, text)
            code, found = run(root)
            if code != 1 or expected not in found:
                failures += 1
                print(f"{name}: expected '{expected}', found {code}\n{found}")
    print(f"{len(BREACHES) + 2} trees, {failures} failures")
    return 1 if failures else 0


sys.exit(main())
