#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares writeFilters.py with the headers of the filters, without ParaView: every property's setter is there and takes so many
values, every setter is offered, each property is documented, and its default lies in its range. openResult.py opens result files
of the version that is written."""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "MammoRay"))
import writeFilters  # noqa: E402  of that folder

MODULES = HERE.parent.parent / "Modules"
HEADERS = MODULES / "Filters"
# Offered in other ways: inputs; what Spectrum, MaterialTable and the tables they name say in ParaView.
ELSEWHERE = {"SetMammogramConnection", "SetSimulationMeshConnection", "SetMaterial"}
SCENE_KEYS = set(re.findall(r"(?m)^\| `([^`]+)`", (MODULES.parent / "docs/reference/commands/scene-keys.md").read_text(encoding="utf-8")))


def setters(header):
    """Name -> number of values, of a header's properties."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", header, flags=re.S)
    found = {}
    for kind, name in re.findall(r"vtkSet(Clamp|Vector2|Vector3|FilePath)?Macro\((\w+)", text):
        found["Set" + name] = {"Vector2": 2, "Vector3": 3}.get(kind, 1)
    for name, arguments in re.findall(r"void (Set\w+)\(([^)]*)\)", text):
        found[name] = arguments.count(",") + 1
    # SetElementToLinear says a value of SetElement.
    return {name: count for name, count in found.items() if name.split("To")[0] not in found or "To" not in name}


def troubles(proxy, known, offered):
    """Lines, none where all is well. offered: takes the setters that the proxy offers."""
    name = proxy.get("name")
    for entry in proxy:
        if not entry.tag.endswith("VectorProperty") or entry.get("information_only") == "1":
            continue
        where = f"{name}.{entry.get('name')}"
        command = entry.get("command")
        count = int(entry.get("number_of_elements", "1")) + ("initial_string" in entry.attrib)
        offered.add(command)
        if entry.get("initial_string", "mesh") not in SCENE_KEYS:
            yield f"{where}: no key {entry.get('initial_string')} of scene files"
        if command in known and known[command] != count:
            yield f"{where}: {command} takes {known[command]} values, found {count}"
        if command not in known:
            yield f"{where}: no {command} in the header"
        if not (entry.findtext("Documentation") or "").strip():
            yield f"{where}: no documentation"
        if entry.tag == "StringVectorProperty":
            continue
        defaults = [float(value) for value in entry.get("default_values", "").split()]
        if len(defaults) != count:
            yield f"{where}: {count} values, {len(defaults)} defaults"
        for domain in entry.findall("DoubleRangeDomain") + entry.findall("IntRangeDomain"):
            for bound, beyond in (("min", lambda value, limit: value < limit), ("max", lambda value, limit: value > limit)):
                limits = [float(value) for value in domain.get(bound, "").split()]
                if any(beyond(value, limit) for value, limit in zip(defaults, limits)):
                    yield f"{where}: default {defaults} beyond {bound} {limits}"


def version_troubles():
    """Lines, none where openResult.py knows the version of ResultFile.h in Study."""
    versions = [re.search(pattern, path.read_text(encoding="utf-8")).group(1)
                for pattern, path in ((r"ResultFormatVersion = (\d+);", MODULES / "Study" / "ResultFile.h"),
                                      (r"(?m)^FORMAT_VERSION = (\d+)", HERE / "openResult.py"))]
    if versions[0] != versions[1]:
        yield f"openResult.py: expected FORMAT_VERSION {versions[0]}, found {versions[1]}"


def main():
    found = []
    offered = {}
    for proxy in writeFilters.server_manager(MODULES.parent / "Data").iter("SourceProxy"):
        header = HEADERS / (proxy.get("class") + ".h")
        if header.exists():
            known = setters(header.read_text(encoding="utf-8"))
            given = offered.setdefault(header.stem, (known, set()))[1]
            found += [f"writeFilters.py: {line}" for line in troubles(proxy, known, given)]
    for name, (known, given) in offered.items():
        found += [f"writeFilters.py: {name}: {command} of the header is not offered" for command in sorted(set(known) - given - ELSEWHERE)]
    found += version_troubles()
    for line in found:
        print(line)
    print(f"{len(offered)} filters, {len(found)} troubles")
    return 1 if found or not offered else 0


if __name__ == "__main__":
    sys.exit(main())
