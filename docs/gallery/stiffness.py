# SPDX-License-Identifier: Apache-2.0
"""How stiff an inclusion is, from X-rays of two compressions, by gradients through pictures and mechanics. Needs VTK."""
import sys

import mammoray as mr
import numpy
from matplotlib import pyplot
from scipy.optimize import minimize

THICKNESSES = (50, 36)


def materials_of(ratio):
    """Fat, the chest wall, and the inclusion, which is `ratio` times as stiff as fat."""
    return {1: mr.Material("adipose", density=0.92, youngs_modulus=6, poisson_ratio=0.48),
            2: mr.Material("muscle", density=1.05, fixed=True),
            3: mr.Material("glandular", density=1.04, youngs_modulus=6 * ratio, poisson_ratio=0.48)}


def breast_of(cell_size, voxel=1):
    z, y, x = numpy.mgrid[-32:32 + voxel:voxel, 0:34:voxel, -32:32 + voxel:voxel]
    labels = numpy.where(x**2 + y**2 + z**2 < 900, numpy.where(y < 6, 2, 1), 0)
    labels[(x + 3)**2 + (y - 17)**2 + (z - 2)**2 < 100] = 3
    return mr.mesh(labels, (voxel, voxel, voxel), origin=(-32, 0, -32), materials=materials_of(1), cell_size=cell_size)


def compressed(mesh, ratio):
    """The compressions, and a picture of each."""
    materials = materials_of(ratio)
    for thickness in THICKNESSES:
        squeezed = mr.compress(mesh.points, mesh.cells, mesh.regions, materials=materials, orientation="LAS", thickness=thickness,
                               element="linear")
        scene = mr.Scene(mr.Mesh(squeezed.points, mesh.cells, mesh.regions), materials=materials, source=squeezed.placement.source(),
                         beam=mr.Beam(kev=20), detector=squeezed.placement.detector(80, 160, 0.5))
        yield squeezed, scene.expose()


truth = 3.0
wanted = [image.transmission for _, image in compressed(breast_of(4), truth)]
mesh = breast_of(5.5)
steps = []


def loss(logarithm):
    value, slope = 0.0, 0.0
    for (squeezed, image), picture in zip(compressed(mesh, numpy.exp(logarithm[0])), wanted):
        difference = image.transmission.astype(float) - picture
        value += 0.5 * (difference**2).sum()
        moved = image.backward(transmission=difference).points[0]
        slope += squeezed.backward(moved).materials[3]  # of the logarithm of the stiffness
    steps.append((numpy.exp(logarithm[0]), value))
    return value, numpy.array([slope])


found = minimize(loss, [0.0], jac=True, method="L-BFGS-B", bounds=[(-1, 3)], options={"maxiter": 12, "ftol": 1e-5})
ratio = float(numpy.exp(found.x[0]))
figure, axes = pyplot.subplots(1, 3, figsize=(10, 3.4))
for axis, picture, thickness in zip(axes, wanted, THICKNESSES):
    axis.imshow(-numpy.log(picture), cmap="gray")
    axis.set_title(f"{thickness} mm")
    axis.axis("off")
axes[2].plot([each for each, _ in steps], "o-")
axes[2].axhline(truth, color="grey")
axes[2].set(title="stiffness of the inclusion / fat", xlabel="evaluation")
figure.tight_layout()
figure.savefig(f"{sys.argv[1]}/stiffness.png", dpi=80)
print(f"{found.nfev} evaluations: {ratio:.2f} times as stiff, true {truth:g}")
assert abs(ratio - truth) < 0.6, ratio  # the meshes differ
