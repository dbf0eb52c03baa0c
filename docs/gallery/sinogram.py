# SPDX-License-Identifier: Apache-2.0
"""Projections of a turning part, and one row of all of them: a sinogram."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

part = mr.Sample(mr.read_mesh("Data/parts/bearing.stl"), material="Al")
scene = mr.Scene(part, source=mr.Source(position=(0, -400, 0)), beam=mr.Beam(kev=80),
                 detector=mr.Detector(origin=(-40, 100, 0), column_direction=(1, 0, 0), row_direction=(0, 0, -1), columns=200, rows=1,
                                      pixel_spacing=0.4))
rows = numpy.asarray(mr.turn(scene, 90, span=180))[:, 0, :]
pyplot.imsave(f"{sys.argv[1]}/sinogram.png", -numpy.log(rows).repeat(3, axis=0), cmap="gray")
assert rows.shape == (90, 200)
