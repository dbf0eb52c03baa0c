# SPDX-License-Identifier: Apache-2.0
"""The penumbra of a focal spot: a point, 0.5 mm and 2 mm."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

part = mr.Sample(mr.read_mesh("Data/parts/bearing.stl"), material="Fe")
scene = mr.Scene(part, source=mr.Source(position=(0, 0, 150)), beam=mr.Beam(kev=150),
                 detector=mr.Detector(origin=(-56, 56, -150), column_direction=(1, 0, 0), row_direction=(0, -1, 0), columns=188, rows=188,
                                      pixel_spacing=0.6))
pictures = []
for edge in (0, 0.5, 2):
    scene.source.focal_spot = (edge, edge)
    pictures.append(scene.expose().transmission)
pyplot.imsave(f"{sys.argv[1]}/focal_spot.png", numpy.hstack(pictures), cmap="gray", vmin=0, vmax=1)
steps = [abs(numpy.diff(picture[94])).max() for picture in pictures]
assert steps[0] > steps[1] > steps[2]
