# SPDX-License-Identifier: Apache-2.0
"""Outer and inner radii of seven steel tubes from four radiographs of their bundle, by scipy and gradients in reverse mode."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot
from scipy.optimize import minimize

CENTRES = 13 * numpy.array([(0, 0)] + [(numpy.cos(angle), numpy.sin(angle)) for angle in numpy.arange(6) * numpy.pi / 3])


def directions(sides):
    angles = 2 * numpy.pi * numpy.arange(sides) / sides
    return numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=1)


def points_of(radii, sides):
    """radii: tube x (outer, inner), mm. Points: tube x (outer, inner) x (bottom, top) x sides."""
    places = numpy.empty((*radii.shape, 2, sides, 3))
    places[..., :2] = CENTRES[:, None, None, None] + radii[:, :, None, None, None] * directions(sides)
    places[..., 2] = numpy.array((-4, 4))[:, None]
    return places.reshape(-1, 3)


def bundle(radii, sides):
    def ring(kind, end):
        return (2 * kind + end) * sides + numpy.arange(sides)

    strips = []
    for first, second in ((ring(0, 0), ring(0, 1)), (ring(1, 1), ring(1, 0)), (ring(0, 1), ring(1, 1)), (ring(1, 0), ring(0, 0))):
        after, beyond = numpy.roll(first, -1), numpy.roll(second, -1)
        strips += [numpy.stack([first, after, beyond], axis=1), numpy.stack([first, beyond, second], axis=1)]
    tube = numpy.concatenate(strips)
    return mr.Mesh(points_of(radii, sides), numpy.concatenate([tube + 4 * sides * index for index in range(len(radii))]))


def pictures(mesh):
    scene = mr.Scene(mr.Sample(mesh, "Fe"), source=mr.Source(position=(0, -500, 0)), beam=mr.Beam(kev=200),
                     detector=mr.Detector(origin=(-29.75, 60, 2), column_direction=(1, 0, 0), row_direction=(0, 0, -1), columns=120,
                                          rows=5, pixel_spacing=0.5, samples=2))
    return list(mr.turn(scene, 4, span=180, axis="z", axis_point=(0, 0, 0)))


random = numpy.random.default_rng(7)
true = numpy.stack([random.uniform(4.5, 6, 7), random.uniform(2, 4, 7)], axis=1)
wanted = [image.transmission for image in pictures(bundle(true, 360))]
SIDES = 96
mesh = bundle(numpy.tile((5.2, 3.0), (7, 1)), SIDES)


def loss(radii):
    mesh.points = points_of(radii.reshape(7, 2), SIDES)
    value, slopes = 0.0, numpy.zeros((7, 2))
    for image, picture in zip(pictures(mesh), wanted):
        difference = image.transmission.astype(float) - picture
        value += 0.5 * (difference**2).sum()
        moved = image.backward(transmission=difference).points[0].reshape(7, 2, 2, SIDES, 3)
        slopes += (moved[..., :2] * directions(SIDES)).sum(axis=(2, 3, 4))
    return value, slopes.ravel()


found = minimize(loss, numpy.tile((5.2, 3.0), 7), jac=True, method="L-BFGS-B", bounds=[(3, 6.4), (1, 4.4)] * 7,
                 options={"maxiter": 80, "ftol": 1e-9})
errors = 1000 * abs(found.x.reshape(7, 2) - true)
figure, (left, right) = pyplot.subplots(1, 2, figsize=(9, 4.2))
for (x, y), radii, best in zip(CENTRES, true, found.x.reshape(7, 2)):
    for radius, fitted in zip(radii, best):
        left.add_patch(pyplot.Circle((x, y), radius, fill=False, color="grey", linewidth=3))
        left.add_patch(pyplot.Circle((x, y), fitted, fill=False, color="tab:orange"))
left.set(xlim=(-21, 21), ylim=(-21, 21), aspect="equal", title="true (grey) and found radii")
right.plot(numpy.stack([picture[2] for picture in wanted]).T)
right.set(xlabel="column", ylabel="transmission", title="the middle rows of the four pictures")
figure.tight_layout()
figure.savefig(f"{sys.argv[1]}/bundle.png", dpi=80)
print(f"{found.nit} steps, {found.nfev} sets of pictures: at most {errors.max():.1f} um off")
assert errors.max() < 10, errors  # um; a pixel is 500
