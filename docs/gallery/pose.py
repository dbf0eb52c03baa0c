# SPDX-License-Identifier: Apache-2.0
"""Finds where a part stands from one radiograph, by exact derivatives and Newton's method of Gauss."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

mesh = mr.read_mesh("Data/parts/bearing.stl")
scene = mr.Scene(mr.Sample(mesh, "Al", axis=(1, 0, 0), angle=35, translation=(1.5, -0.8, 0)), source=mr.Source(position=(0, 0, 500)),
                 beam=mr.Beam(kev=80), detector=mr.Detector(origin=(-36, 36, -60), column_direction=(1, 0, 0), row_direction=(0, -1, 0),
                                                            columns=120, rows=120, pixel_spacing=0.6))
wanted = scene.expose().log_attenuation
place = numpy.zeros(2)
errors = []
turned = numpy.deg2rad(35)
# Velocities are in the frame of the mesh: the scene's x and y, turned back.
ways = numpy.array([(1, 0, 0), (0, numpy.cos(turned), -numpy.sin(turned))])
velocities = numpy.broadcast_to(ways[:, None, :], (2, len(mesh.points), 3))
for _ in range(12):
    scene.samples[0].translation = (*place, 0)
    exposure = scene.expose()
    difference = (exposure.log_attenuation - wanted).ravel()
    errors.append(float(numpy.sqrt((difference**2).mean())))
    jacobian = exposure.derivatives(velocities).log_attenuation.reshape(2, -1).T
    place -= numpy.linalg.lstsq(jacobian, difference, rcond=None)[0]
pyplot.semilogy(errors, "o-")
pyplot.xlabel("step")
pyplot.ylabel("difference of the pictures")
pyplot.savefig(f"{sys.argv[1]}/pose.png", dpi=70)
assert numpy.allclose(place, (1.5, -0.8), atol=0.02), place
