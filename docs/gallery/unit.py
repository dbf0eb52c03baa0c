# SPDX-License-Identifier: Apache-2.0
"""Blocks of gland on a slab of fat before an ideal detector, and as a mammography unit pictures them."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

corners = numpy.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (-1, 1)], dtype=float)
faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
parts = [mr.Sample(mr.Mesh((30, 50, 30) * corners, faces), "adipose")]
for number in range(6):  # blocks of 1 to 6 mm
    place = numpy.array((20 * (number % 3 - 1), 10 + 20 * (number // 3), 30.1))
    parts.append(mr.Sample(mr.Mesh((6, 12, number + 1) * corners + place, faces), "glandular"))
scene = mr.Scene(parts, beam=mr.Beam(tube="W", kvp=28, filters=["Rh:0.05"]), detector=mr.Detector(columns=150, rows=200, pixel_spacing=0.4))
scene.place_unit("LAS", thickness=40)
ideal = scene.expose().log_attenuation
scene.realistic = True
real = scene.expose().log_attenuation
top = float(ideal.max())
pyplot.imsave(f"{sys.argv[1]}/unit.png", numpy.hstack([ideal, real]), cmap="gray", vmin=0.5 * top, vmax=top)
assert real[5:20, 130:].std() > ideal[5:20, 130:].std()  # noise
