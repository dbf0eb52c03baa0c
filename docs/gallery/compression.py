# SPDX-License-Identifier: Apache-2.0
"""Half a ball of fat on a plate of muscle, compressed and X-rayed as by a mammography unit. Needs VTK."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

z, y, x = numpy.mgrid[-32:33:2, 0:34:2, -32:33:2]
inside = x**2 + y**2 + z**2 < 900
labels = numpy.where(inside, numpy.where(y < 6, 2, 1), 0)
materials = {1: mr.Material("adipose", density=0.92, youngs_modulus=6, poisson_ratio=0.48),
             2: mr.Material("muscle", density=1.05, fixed=True)}
breast = mr.mesh(labels, (2, 2, 2), origin=(-32, 0, -32), materials=materials, cell_size=8)
pictures = []
for thickness in (58, 45, 32):
    squeezed = mr.compress(breast.points, breast.cells, breast.regions, materials=materials, orientation="LAS", thickness=thickness,
                           element="linear")
    scene = mr.Scene(mr.Mesh(squeezed.points, breast.cells, breast.regions), materials=materials, source=squeezed.placement.source(),
                     detector=squeezed.placement.detector(100, 180))
    pictures.append(scene.expose().log_attenuation)
pyplot.imsave(f"{sys.argv[1]}/compression.png", numpy.hstack(pictures), cmap="gray")
