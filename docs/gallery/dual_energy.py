# SPDX-License-Identifier: Apache-2.0
"""Two exposures, recombined so that fat and gland look the same and iodine stays."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

corners = numpy.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]


def box(centre, half, material):
    return mr.Sample(mr.Mesh(numpy.array(centre) + numpy.array(half) * corners, faces), material)


materials = {1: mr.Material("adipose", name="fat", density=0.92), 2: mr.Material("glandular", name="gland", density=1.04),
             3: mr.Material("glandular", name="lesion", density=1.04, iodine=2)}
scene = mr.Scene([box((0, 0, 20), (30, 30, 20), "fat"), box((-8, 0, 20), (12, 12, 10), "gland"), box((14, 6, 20), (4, 4, 4), "lesion")],
                 materials=materials, overlap_priority=["lesion", "gland", "fat"], source=mr.Source(position=(0, 0, 650)),
                 beam=mr.Beam(tube="W", kvp=30, filters=["Rh:0.05"]),
                 detector=mr.Detector(origin=(-25, 25, -5), column_direction=(1, 0, 0), row_direction=(0, -1, 0), columns=125, rows=125,
                                      pixel_spacing=0.4))
pair = mr.dual_energy(scene, mr.Beam(tube="W", kvp=42, filters=["Cu:0.3"]), cancel=("fat", "gland"), thickness=20)


def stretched(picture):
    low, high = numpy.percentile(picture, (1, 99.8))
    return numpy.clip((picture - low) / (high - low), 0, 1)


pyplot.imsave(f"{sys.argv[1]}/dual_energy.png", numpy.hstack([stretched(pair.low.log_attenuation), stretched(pair.recombined)]), cmap="gray")
