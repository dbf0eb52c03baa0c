#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks what docs/develop/architecture.md promises of the sources, and says each breach in a line:

- an include goes from an upper module to a lower one and never the other way, nor between neighbours;
- a module names in its vtk.module what its public headers include;
- private headers are included by their own module (and its tests) only;
- an installed header (HEADERS, CLASSES and what vtk_module_install_headers names in CMakeLists.txt) includes installed ones only;
- no text of a module names an option of the command line: errors name fields (RefusedField);
- nothing but Validation and the tests includes headers of Validation, which may include everything;
- every module has a README, and every source of it is listed in CMakeLists.txt;
- a source that docs/develop/architecture.md names is there;
- what the sources of IO that the projector alone has include is compiled into it, too;
- that page names each source that includes a header of POSIX or Linux; what Linux alone has is in one file of each module.

usage: checkArchitecture.py PROJECT-FOLDER     exit 1: something is wrong
"""
import pathlib
import re
import sys

# The modules that each module may include beside itself and Foundation.
SOLVERS = {"Biomechanics", "XRay", "Meshing", "Segmentation"}
MAY_INCLUDE = {
    "Foundation": set(),
    "XRay": set(),
    "Segmentation": set(),
    "Meshing": set(),
    "Biomechanics": set(),
    "Registration": SOLVERS,
    "IO": SOLVERS,
    "Dicom": {"IO"},
    "Study": SOLVERS | {"Registration", "IO", "Dicom"},
    "Filters": SOLVERS | {"Registration", "IO", "Dicom", "Study"},
    "App": SOLVERS | {"Registration", "IO", "Dicom", "Study"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)


RAW_TEXT = re.compile(r'R"(\w*)\(.*?\)\1"', re.DOTALL)
TEXT = re.compile(r'"(?:[^"\\\n]|\\.)*"')
OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]*")
# Headers that other systems lack, and what Linux and its C library alone have.
SYSTEM = re.compile(r"(sys|arpa|net|netinet|linux|X11)/.*|(unistd|fcntl|poll|dlfcn|spawn|pthread|sched|termios|netdb|pwd|grp|dirent|glob"
                    r"|malloc|stdio_ext|execinfo|link|elf)\.h")
LINUX = re.compile(r"\b(memfd_create|statx|renameat2|prctl|__f\w+|mallopt|malloc_\w+|_SC_\w*PHYS_PAGES|ru_maxrss|epoll_\w+|inotify_\w+|signalfd"
                   r"|eventfd|timerfd_\w+|sched_\w+affinity|fallocate|gettid|splice|sendfile|copy_file_range|dl_iterate_phdr|O_TMPFILE|O_PATH)\b|\"/proc/")


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in (".h", ".cxx"))


def public_headers(folder):
    return {str(p.relative_to(folder)) for p in folder.rglob("*.h") if "Private" not in p.parts}


def check_includes(root, modules, wrong):
    public = {m: public_headers(root / "Modules" / m) for m in modules}
    for module in modules:
        folder = root / "Modules" / module
        declared = set(re.findall(r"MammoRay::(\w+)", (folder / "vtk.module").read_text())) - {module}
        for path in sources(folder):
            where = path.relative_to(root)
            for name in INCLUDE.findall(path.read_text()):
                parts = name.split("/")
                if parts[0] == "mammoray" and len(parts) >= 3 and parts[1] in MAY_INCLUDE:
                    target = parts[1]
                    if target != module and target != "Foundation" and target not in MAY_INCLUDE[module]:
                        wrong.append(f"{where}: {module} must not include {name}")
                    elif target != module and target not in declared and path.parent == folder and path.suffix == ".h":
                        wrong.append(f"{where}: includes {name}, but {module}/vtk.module does not name MammoRay::{target}")
                    elif target in public and "/".join(parts[2:]) not in public[target] and not parts[-1].endswith("Module.h"):
                        wrong.append(f"{where}: {name} is no public header")
                elif parts[0] == "mammoray":
                    wrong.append(f"{where}: {name} is no public header of a module")
                elif any(name in headers for headers in public.values()):
                    wrong.append(f"{where}: expected mammoray/<Module>/{name}, found {name}")
                if parts[0] == "Private" and path.parent == folder and path.suffix == ".h":
                    wrong.append(f"{where}: a public header includes {name}")


def installed_headers(folder):
    text = re.sub(r"#.*", "", (folder / "CMakeLists.txt").read_text())
    found, section = set(), ""
    for word in re.findall(r"[^\s()\"]+", text):
        if re.fullmatch(r"[A-Z_]+", word):
            section = word
        elif section in ("HEADERS", "FILES") and word.endswith(".h") and "$" not in word:
            found.add(word)
        elif section == "CLASSES":
            found.add(word + ".h")
    return found


def check_installed(root, modules, wrong):
    installed = {m: installed_headers(root / "Modules" / m) for m in modules}
    for module in modules:
        for header in sorted(installed[module]):
            path = root / "Modules" / module / header
            for name in INCLUDE.findall(path.read_text()):
                parts = name.split("/")
                if parts[0] == "mammoray" and parts[1] in installed and "/".join(parts[2:]) not in installed[parts[1]]:
                    wrong.append(f"{path.relative_to(root)}: is installed, but {name} is not")


def check_options(root, modules, wrong):
    for module in modules:
        for path in sources(root / "Modules" / module):
            code = "\n".join(line for line in RAW_TEXT.sub("", path.read_text()).splitlines()
                             if not line.lstrip().startswith(("//", "*", "/*")))
            for text in TEXT.findall(code):
                for option in OPTION.findall(text):
                    wrong.append(f"{path.relative_to(root)}: a text names the option {option}")


def check_tests(root, wrong):
    for path in sources(root / "Testing") + sources(root / "Applications") + sources(root / "Wrapping"):
        place = path.relative_to(root).parts
        for name in INCLUDE.findall(path.read_text()):
            parts = name.split("/")
            if "Private" in parts and parts[0] == "mammoray":
                if place[0] != "Testing" or place[1] != parts[1]:
                    wrong.append(f"{path.relative_to(root)}: {name} is private to {parts[1]}")


def check_validation(root, wrong):
    """Validation measures the product, which must not know of it."""
    headers = {p.name for p in (root / "Validation").rglob("*.h")}
    for top in ("Modules", "Applications", "Wrapping"):
        for path in sources(root / top):
            for name in INCLUDE.findall(path.read_text()):
                if "Validation" in name.split("/")[:-1] or name in headers and not (path.parent / name).exists():
                    wrong.append(f"{path.relative_to(root)}: {top} must not include {name} of Validation")


def check_rooms(root, modules, wrong):
    for module in modules:
        folder = root / "Modules" / module
        if not (folder / "README.md").exists():
            wrong.append(f"Modules/{module}: no README.md")
        listed = (folder / "CMakeLists.txt").read_text()
        for path in sources(folder):
            name = str(path.relative_to(folder))
            if name not in listed and str(path.relative_to(folder).with_suffix("")) not in listed:
                wrong.append(f"Modules/{module}/CMakeLists.txt: does not list {name}")
    for entry in sorted((root / "Modules").iterdir()):
        if entry.is_dir() and entry.name not in MAY_INCLUDE:
            wrong.append(f"Modules/{entry.name}: a module that checkArchitecture.py does not know")


def check_names(root, wrong):
    page = root / "docs/develop/architecture.md"
    names = re.findall(r"`([\w/]+\.(?:h|cxx|py|comp|rgen|rahit|rmiss))`", page.read_text()) if page.exists() else []
    there = [p.as_posix() for top in ("Modules", "Applications", "Wrapping", "Testing", "shaders") for p in (root / top).rglob("*.*")]
    for name in sorted(set(names)):
        if not any(p.endswith("/" + name) for p in there):
            wrong.append(f"docs/develop/architecture.md: there is no {name}")


def check_portability(root, modules, wrong):
    """The page is the list of places to touch for another system."""
    page = root / "docs/develop/architecture.md"
    named = set(re.findall(r"`([\w/]+\.\w+)`", page.read_text())) if page.exists() else set()
    for folder in [root / "Modules" / module for module in modules] + [root / "Applications" / "mammoray"]:
        of_linux = []
        for path in sources(folder) if folder.is_dir() else []:
            text, name = path.read_text(), path.relative_to(folder).as_posix()
            systems = [header for header in INCLUDE.findall(text) if SYSTEM.fullmatch(header)]
            if systems and name not in named:
                wrong.append(f"{path.relative_to(root)}: includes {systems[0]}, but docs/develop/architecture.md does not name it")
            if LINUX.search(text):
                of_linux.append(name)
        if len(of_linux) > 1:
            wrong.append(f"{folder.relative_to(root)}: expected calls of Linux in one file, found {', '.join(of_linux)}")


def check_projector(root, wrong):
    """Its module has undefined names, Python's, so that the linker says nothing of what is left out."""
    table = root / "Wrapping/Python/projector/CMakeLists.txt"
    listed = set(re.findall(r"/Modules/IO/([\w/]+)\.cxx", table.read_text())) if table.exists() else set()
    for name in sorted(listed):
        for path in [path for path in (root / f"Modules/IO/{name}.cxx", root / f"Modules/IO/{name}.h") if path.exists()]:
            for header in INCLUDE.findall(path.read_text()):
                used = header.removeprefix("mammoray/IO/").removesuffix(".h")
                if used not in listed and (root / f"Modules/IO/{used}.cxx").exists():
                    wrong.append(f"{table.relative_to(root)}: lacks {used}.cxx, whose header {path.name} includes")


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    root = pathlib.Path(sys.argv[1]).resolve()
    modules = [m for m in MAY_INCLUDE if (root / "Modules" / m).is_dir()]
    wrong = []
    check_includes(root, modules, wrong)
    check_installed(root, modules, wrong)
    check_options(root, modules, wrong)
    check_tests(root, wrong)
    check_validation(root, wrong)
    check_rooms(root, modules, wrong)
    check_names(root, wrong)
    check_portability(root, modules, wrong)
    check_projector(root, wrong)
    for line in wrong:
        print(line)
    print(f"{len(modules)} modules, {len(wrong)} breaches")
    return 1 if wrong or not modules else 0


sys.exit(main())
