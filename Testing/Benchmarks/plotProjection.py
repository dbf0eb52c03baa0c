#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws frames per second against resolution and against triangles, as figure 5 of Maul et al.

    plotProjection.py REPORT.json PICTURE.png

REPORT.json is what `benchmarkProjection --rates -o` wrote.
"""
import json
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot

report = json.load(open(sys.argv[1], encoding="utf-8"))
figure, panels = pyplot.subplots(1, 2, figsize=(11, 4.2), sharey=True)
sizes = {
    "resolution": ("pixels", lambda point: point["columns"] * point["rows"]),
    "triangles": ("triangles", lambda point: point["triangles"]),
}
for panel, (kind, (label, size)) in zip(panels, sizes.items()):
    for sweep, colour in zip(report["rates"], ("tab:blue", "tab:orange")):
        points = sweep[kind]
        where = [size(point) for point in points]
        for style, name, milliseconds in (
            ("--", "with set-up", lambda point: point["setUpAndFrameMs"]),
            ("-", "rendering only", lambda point: point["frame"]["medianMs"]),
        ):
            rates = [1e3 / milliseconds(point) for point in points]
            panel.loglog(where, rates, style, marker="o", markersize=3, color=colour,
                         label=f"{sweep['method']}, {name}")
    panel.set_xlabel(label)
    panel.grid(True, which="both", alpha=0.3)
panels[0].set_title(f"{report['rates'][0]['resolution'][0]['triangles']} triangles")
panels[1].set_title("600 x 600 pixels")
panels[0].set_ylabel("frames per second")
panels[0].legend(fontsize=8)
figure.tight_layout()
figure.savefig(sys.argv[2], dpi=120)
