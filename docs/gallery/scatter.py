# SPDX-License-Identifier: Apache-2.0
"""A slab of tissue: primary radiation, with scatter, and with scatter behind a grid."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

corners = numpy.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (-1, 1)], dtype=float)
faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
slab = mr.Sample(mr.Mesh((40, 80, 40) * corners + (0, 0, 17), faces), "glandular")
scene = mr.Scene(slab, source=mr.Source(position=(0, 0, 650)), beam=mr.Beam(tube="W", kvp=28, filters=["Rh:0.05"]),
                 detector=mr.Detector(origin=(59, 1, 0), column_direction=(0, 1, 0), row_direction=(-1, 0, 0), columns=60, rows=60,
                                      pixel_spacing=2))
lines = {"primary": scene.expose().transmission[30]}
scene.scatter = mr.Scatter("kernels", air_gap=17)
lines["with scatter"] = scene.expose().transmission[30]
scene.scatter.grid_ratio = 5
lines["with scatter and grid"] = scene.expose().transmission[30]
for name, line in lines.items():
    pyplot.semilogy(2 * numpy.arange(60), line, label=name)
pyplot.xlabel("distance from the chest-wall edge, mm")
pyplot.ylabel("I / I0")
pyplot.legend()
pyplot.savefig(f"{sys.argv[1]}/scatter.png", dpi=70)
assert lines["with scatter"][20] > 1.1 * lines["primary"][20]
