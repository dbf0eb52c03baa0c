# SPDX-License-Identifier: Apache-2.0
"""Parts that overlap: the first material of overlap_priority counts alone."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

corners = numpy.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
block = mr.Sample(mr.Mesh(20 * corners, faces), "PMMA")
rod = mr.Sample(mr.Mesh((5, 30, 5) * corners, faces), "Al")
scene = mr.Scene([block, rod], source=mr.Source(position=(0, 0, 600)), beam=mr.Beam(kev=40),
                 detector=mr.Detector(origin=(-40, 40, -60), column_direction=(1, 0, 0), row_direction=(0, -1, 0), columns=160, rows=160,
                                      pixel_spacing=0.5))
both = scene.expose()
scene.overlap_priority = ["Al", "PMMA"]
first = scene.expose()
lengths = [exposure.path_lengths.sum(axis=0) for exposure in (both, first)]  # mm of any material
pyplot.imsave(f"{sys.argv[1]}/overlap.png", numpy.hstack(lengths), cmap="gray", vmin=0, vmax=50)
assert abs(lengths[0][80, 80] - 50) < 0.1 and abs(lengths[1][80, 80] - 40) < 0.1, lengths
