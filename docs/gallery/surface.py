# SPDX-License-Identifier: Apache-2.0
"""The heights of 10,000 points of a cast plate's upper face from one radiograph, by scipy and gradients in reverse mode."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot
from scipy.optimize import minimize


def height(x, y):
    """Heights of the true face over the lower one, mm."""
    return 6 + 1.5 * numpy.exp(-((x - 8)**2 + (y + 5)**2) / 60) - 2 * numpy.exp(-((x + 9)**2 + (y - 7)**2) / 90) + 0.4 * numpy.sin(x / 4)


def plate(count):
    """count x count points of the upper face, then as many of the lower one."""
    places = numpy.linspace(-25, 25, count)
    y, x = (grid.ravel() for grid in numpy.meshgrid(places, places, indexing="ij"))
    index = numpy.arange(count * count).reshape(count, count)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    upper = numpy.concatenate([numpy.stack([a, b, c], axis=1), numpy.stack([a, c, d], axis=1)])
    rim = numpy.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    after, below = numpy.roll(rim, -1), count * count
    sides = numpy.concatenate([numpy.stack([after, rim, rim + below], axis=1), numpy.stack([after, rim + below, after + below], axis=1)])
    points = numpy.stack([numpy.tile(x, 2), numpy.tile(y, 2), numpy.concatenate([numpy.full(len(x), 6.0), numpy.zeros(len(x))])], axis=1)
    return mr.Mesh(points, numpy.concatenate([upper, upper[:, ::-1] + below, sides]))


def lifted(mesh, heights):
    points = mesh.points.copy()
    points[:len(heights), 2] = heights
    mesh.points = points


def scene_of(mesh, **noise):
    return mr.Scene(mr.Sample(mesh, "Al"), source=mr.Source(position=(0, 0, 600)), beam=mr.Beam(kev=40),
                    detector=mr.Detector(origin=(-29.9, -29.9, -30), column_direction=(1, 0, 0), row_direction=(0, 1, 0), columns=150,
                                         rows=150, pixel_spacing=0.4, **noise))


# The true plate has other triangles, and its picture the noise of 20,000 photons per pixel.
true = plate(171)
lifted(true, height(*true.points[:171 * 171, :2].T))
wanted = scene_of(true, photons=20000).expose().transmission
mesh = plate(100)
scene = scene_of(mesh)
SMOOTH = 20.0  # what a bend costs


def loss(heights):
    lifted(mesh, heights)
    image = scene.expose()
    difference = (image.transmission.astype(float) - wanted) / 0.005
    slopes = image.backward(transmission=difference / 0.005).points[0][:10000, 2]
    value = 0.5 * (difference**2).sum()
    grid, bends = heights.reshape(100, 100), numpy.zeros((100, 100))
    for axis in (0, 1):
        bend = numpy.diff(grid, 2, axis)
        value += 0.5 * SMOOTH * (bend**2).sum()
        bends += SMOOTH * numpy.diff(numpy.pad(bend, [(2, 2) if each == axis else (0, 0) for each in (0, 1)]), 2, axis)
    return value, slopes + bends.ravel()


found = minimize(loss, numpy.full(10000, 6.0), jac=True, method="L-BFGS-B", options={"maxiter": 150})
truth = height(*mesh.points[:10000, :2].T)
error = numpy.sqrt(((found.x - truth)**2).mean())
figure, axes = pyplot.subplots(1, 3, figsize=(11, 3.4))
for axis, title, values, limits in ((axes[0], "radiograph", wanted, None), (axes[1], "height that was found, mm", found.x.reshape(100, 100), (4, 8)),
                                    (axes[2], "its error, mm", (found.x - truth).reshape(100, 100), (-0.3, 0.3))):
    drawn = axis.imshow(values, cmap="gray" if limits is None else "viridis" if limits[0] > 0 else "coolwarm", vmin=limits and limits[0],
                        vmax=limits and limits[1], origin="lower")
    axis.set(title=title, xticks=[], yticks=[])
    figure.colorbar(drawn, ax=axis)
figure.tight_layout()
figure.savefig(f"{sys.argv[1]}/surface.png", dpi=80)
print(f"{found.nit} steps, {found.nfev} pictures: {error:.3f} mm of {truth.std():.2f} mm")
assert error < 0.05, error
