# SPDX-License-Identifier: Apache-2.0
"""Finds how a part is turned and shifted from one radiograph, by exact derivatives and the method of Levenberg and Marquardt."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot

corners = numpy.array([(-8, -5, -6), (12, -5, -6), (-8, 7, -6), (-8, -5, 9), (3, 6, 8), (-4, 2, 12)], dtype=float)
part = mr.Mesh(corners, [(2, 1, 0), (1, 2, 4), (4, 5, 1), (2, 5, 4), (0, 1, 3), (1, 5, 3), (3, 2, 0), (3, 5, 2)])
scene = mr.Scene(mr.Sample(part, "Al"), source=mr.Source(position=(0, -300, 0)), beam=mr.Beam(kev=60),
                 detector=mr.Detector(origin=(-31.5, 100, 31.5), column_direction=(1, 0, 0), row_direction=(0, 0, -1),
                                      columns=64, rows=64, pixel_spacing=1))


def turned(points, turn):
    """Points about the vector `turn`, by its length in radians."""
    angle = numpy.linalg.norm(turn)
    axis = turn / max(angle, 1e-12)
    return (points * numpy.cos(angle) + numpy.cross(axis, points) * numpy.sin(angle)
            + numpy.outer(points @ axis, axis) * (1 - numpy.cos(angle)))


# The target: the part turned by 12 degrees and shifted by 4 mm.
hidden = turned(corners, numpy.radians((6, -9, 4))) + (2, -3, 1.5)
part.points = hidden
target = scene.expose().log_attenuation

part.points = corners
pictures, errors = [], []
for _ in range(15):
    image = scene.expose()
    difference = target - image.log_attenuation
    pictures.append(difference)
    errors.append(float(numpy.sqrt((difference**2).mean())))
    middle = part.points.mean(axis=0)
    motions = [numpy.cross(axis, part.points - middle) for axis in numpy.eye(3)]  # mm per radian
    motions += [numpy.tile(axis, (len(corners), 1)) for axis in numpy.eye(3)]  # mm per mm
    slopes = image.derivatives(motions).log_attenuation.reshape(6, -1)
    matrix = slopes @ slopes.T
    step = numpy.linalg.solve(matrix + 0.003 * numpy.diag(numpy.diag(matrix)), slopes @ difference.ravel())
    part.points = turned(part.points - middle, step[:3]) + middle + step[3:]

figure, (left, middle, right) = pyplot.subplots(1, 3, figsize=(9.6, 3.2))
for axis, picture, title in ((left, target, "target"), (middle, pictures[0], "difference at the start")):
    axis.imshow(picture, cmap="gray")
    axis.set_title(title)
    axis.axis("off")
right.semilogy(errors, "o-")
right.set(xlabel="step", ylabel="difference (RMS)")
figure.tight_layout()
figure.savefig(f"{sys.argv[1]}/pose.png", dpi=70)
assert abs(part.points - hidden).max() < 1e-3  # mm
