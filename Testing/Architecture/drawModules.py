#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/modules.svg: the modules on their floors, an arrow for each dependency that no other path implies.

usage: drawModules.py PROJECT-FOLDER             writes docs/modules.svg
       drawModules.py --check PROJECT-FOLDER     exit 1 where it is not what would be written
"""
import pathlib
import re
import sys

# None: a place that is left free, so that arrows pass.
FLOORS = (
    ("what people run", ("Applications",)),
    ("what they link, see, send, are measured by", ("Filters", "Viewer", "Archive", "Evidence")),
    ("files in, result out", ("Case",)),
    ("pictures, HTML", ("Report",)),
    ("the problem; the file formats", ("Registration", "IO")),
    ("X-rays that were turned", (None, None, "Scatter", None)),
    ("physics and geometry", ("Biomechanics", "XRay", "Meshing", "Segmentation")),
    ("what all share", ("Foundation",)),
)
WIDTH, HEIGHT, BOX_WIDTH, BOX_HEIGHT, LEFT = 980, 74, 130, 34, 250


def dependencies(root):
    """Module -> what its sources include, Applications as one."""
    found = {}
    for _, modules in FLOORS:
        for module in filter(None, modules):
            folder = root / "Applications" / "mammoray" if module == "Applications" else root / "Modules" / module
            text = "".join(p.read_text() for p in sorted(folder.rglob("*")) if p.suffix in (".h", ".cxx"))
            found[module] = set(re.findall(r'#include "mammoray/(\w+)/', text)) - {module}
    return found


def without_implied(found):
    def reach(module):
        below = set()
        for target in found[module]:
            below |= {target} | reach(target)
        return below
    return {m: {t for t in targets if not any(t in reach(o) for o in targets if o != t)} for m, targets in found.items()}


def draw(root):
    place = {}
    lines = []
    for floor, (title, modules) in enumerate(FLOORS):
        y = 20 + floor * HEIGHT
        lines.append(f'<text x="16" y="{y + 22}" class="title">{title}</text>')
        step = (WIDTH - LEFT) / len(modules)
        for number, module in enumerate(modules):
            if module:
                place[module] = (LEFT + (number + 0.5) * step, y)
    arrows = []
    for module, targets in without_implied(dependencies(root)).items():
        x, y = place[module]
        for target in sorted(targets):
            to_x, to_y = place[target]
            arrows.append(f'<line x1="{x:.0f}" y1="{y + BOX_HEIGHT}" x2="{to_x:.0f}" y2="{to_y - 3}" marker-end="url(#tip)"/>')
    boxes = []
    for module, (x, y) in place.items():
        boxes.append(f'<rect x="{x - BOX_WIDTH / 2:.0f}" y="{y}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" rx="5"/>'
                     f'<text x="{x:.0f}" y="{y + 22}" class="box">{module}</text>')
    height = 20 + len(FLOORS) * HEIGHT - (HEIGHT - BOX_HEIGHT) + 16
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif">',
        '<style>rect{fill:#eef3fa;stroke:#345}line{stroke:#678;stroke-width:1.2}'
        '.title{font-size:12px;fill:#567}.box{font-size:15px;text-anchor:middle;fill:#123}</style>',
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0 8 4 0 8z" fill="#678"/></marker></defs>',
        f'<rect width="{WIDTH}" height="{height}" style="fill:#fff;stroke:none"/>', *arrows, *boxes, *lines, "</svg>", ""])


def main():
    words = sys.argv[1:]
    check = words[:1] == ["--check"]
    if len(words) != 1 + check:
        print(__doc__, file=sys.stderr)
        return 2
    root = pathlib.Path(words[-1])
    picture = root / "docs" / "modules.svg"
    wanted = draw(root)
    if not check:
        picture.write_text(wanted)
    elif not picture.exists() or picture.read_text() != wanted:
        print(f"{picture}: expected what Testing/Architecture/drawModules.py . writes, found another picture")
        return 1
    return 0


sys.exit(main())
