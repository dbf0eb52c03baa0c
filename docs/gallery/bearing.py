# SPDX-License-Identifier: Apache-2.0
"""A radiograph of an STL: a ball bearing of iron before a tungsten tube."""
import sys

import mammoray as mr

part = mr.Sample(mr.read_mesh("Data/parts/bearing.stl", unit="mm"), material="Fe", axis=(1, 0, 0), angle=35)
scene = mr.Scene(part, source=mr.Source(position=(0, 0, 500), focal_spot=(0.4, 0.4)),
                 beam=mr.Beam(tube="W", kvp=200, filters=["Cu:1"]),
                 detector=mr.Detector(origin=(-36, 36, -60), column_direction=(1, 0, 0), row_direction=(0, -1, 0), columns=360, rows=360,
                                      pixel_spacing=0.2, photons=20000))
image = scene.expose()
image.save(f"{sys.argv[1]}/bearing.png")
assert image.transmission.min() < 0.3 and image.consistency.all()
