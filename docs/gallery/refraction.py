# SPDX-License-Identifier: Apache-2.0
"""The edges of a thin bar of water, 20 keV, 0.5 m before the detector."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

corners = numpy.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
bar = mr.Sample(mr.Mesh((0.05, 5, 0.05) * corners, faces), "Water, Liquid", axis=(0, 1, 0), angle=45)
scene = mr.Scene(bar, source=mr.Source(beam_direction=(0, 0, -1)), beam=mr.Beam(kev=20),
                 detector=mr.Detector(origin=(-0.15, 0, -500), column_direction=(1, 0, 0), row_direction=(0, 1, 0), columns=300, rows=1,
                                      pixel_spacing=0.001, samples=4))
straight = scene.expose().transmission[0]
scene.refraction = mr.Refraction("geometric")
bent = scene.expose().transmission[0]
pyplot.plot(numpy.arange(300) - 150, straight, color="0.6", label="straight")
pyplot.plot(numpy.arange(300) - 150, bent, label="refracted")
pyplot.xlabel("micrometres")
pyplot.legend()
pyplot.savefig(f"{sys.argv[1]}/refraction.png", dpi=70)
assert bent.max() > 1.02 > straight.max()
