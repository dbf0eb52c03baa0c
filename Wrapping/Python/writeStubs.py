# SPDX-License-Identifier: Apache-2.0
"""writeStubs.py PACKAGES STUB.pyi: type hints of the wrapped VTK algorithms, out of the signatures that VTK's wrapper writes into
their documentation. PACKAGES: the folder of the package `mammoray`, or of what it was built as."""
import importlib.util
import pathlib
import re
import sys

import vtkmodules.vtkCommonExecutionModel  # noqa: F401  the classes' bases

SIGNATURE = re.compile(r"^(\w+)\(((?:[^()]|\([^()]*\))*)\) -> ([^\n]+)$", re.MULTILINE)


def plain(text):
    """A type as Python's: tuples, and anything for VTK's own classes."""
    text = re.sub(r"\s+", " ", text)
    text = re.sub(r"\(((?:\w+, )*\w+)\)", lambda found: f"Sequence[{found.group(1).split(', ')[0]}]", text)
    text = re.sub(r"\b(?!self\b)(vtk\w+|Callback|Pointer|Buffer|Any|string)\b", "Any", text)
    return re.sub(r"\b(?:None|from)(?=:)", r"\g<0>_", text)


def methods_of(kind):
    for name, method in sorted(vars(kind).items()):
        found = SIGNATURE.findall(re.sub(r",\n\s+", ", ", method.__doc__ or "")) if callable(method) else []
        signatures = list(dict.fromkeys((plain(takes), plain(gives)) for called, takes, gives in found if called == name))
        for takes, gives in signatures:
            if len(signatures) > 1:
                yield "    @overload"
            if not takes.startswith("self"):
                yield "    @staticmethod"
            yield f"    def {name}({takes}) -> {gives}: ..."


def main():
    packages, target = map(pathlib.Path, sys.argv[1:3])
    path = packages / "mammoray/mammorayFilters.so"
    specification = importlib.util.spec_from_file_location("mammoray.mammorayFilters", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    lines = ["# Written by writeStubs.py.", "from collections.abc import Sequence", "from typing import Any, overload", ""]
    for name in sorted(name for name in vars(module) if name.startswith("vtk")):
        # VTK 9.1 as Debian packs it has no hints of its own: what is inherited is not looked at.
        lines += ["", f"class {name}(Any):", *methods_of(getattr(module, name))]
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


main()
