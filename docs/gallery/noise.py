# SPDX-License-Identifier: Apache-2.0
"""One part with more and more photons per pixel."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

part = mr.Sample(mr.read_mesh("Data/parts/bearing.stl"), material="Al", axis=(1, 0, 0), angle=35)
scene = mr.Scene(part, source=mr.Source(position=(0, 0, 500)), beam=mr.Beam(kev=60),
                 detector=mr.Detector(origin=(-36, 36, -60), column_direction=(1, 0, 0), row_direction=(0, -1, 0), columns=180, rows=180,
                                      pixel_spacing=0.4))
pictures = []
for photons in (30, 300, 3000):
    scene.detector.photons = photons
    pictures.append(scene.expose().transmission)
pyplot.imsave(f"{sys.argv[1]}/noise.png", numpy.hstack(pictures), cmap="gray", vmin=0, vmax=1.2)
open_beam = [picture[:20, :20].std() for picture in pictures]
assert open_beam[0] > 2 * open_beam[1] > 4 * open_beam[2]  # 1 / sqrt(photons)
