# SPDX-License-Identifier: Apache-2.0
"""A breast between the plates: thickness, force, chest wall, elements."""
import dataclasses
import sys
import tempfile

import mammoray
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy

from pipeline import TABLE, field, half_ball_labels, image, points

labels, origin = half_ball_labels()
with tempfile.NamedTemporaryFile("w", suffix=".json") as table:
    table.write(TABLE)
    table.flush()
    mesher = mammoray.vtkBreastMesher()
    mesher.SetInputData(image(labels, origin, 2.0))
    mesher.SetMaterialTable(table.name)
    mesher.ForMechanicsOn()
    mesher.SetCellSizeMm(11)
    compression = mammoray.vtkBreastCompression()
    compression.SetInputConnection(mesher.GetOutputPort())
    compression.SetMaterialTable(table.name)
    compression.SetOrientation("LAS")
    compression.SetElementToLinear()
    compression.SetThicknessMm(50)
    compression.Update()
    squeezed = points(compression.GetOutput())
    front = squeezed[squeezed[:, 1] > 12]
    assert numpy.ptp(front[:, 2]) < 50, "between the plates"
    assert field(compression.GetOutput(), "ThicknessMm")[0] == 50
    force = field(compression.GetOutput(), "PaddleForceN")[0]
    shift = vtk_to_numpy(compression.GetOutput().GetPointData().GetArray("Displacement"))
    assert numpy.allclose(points(mesher.GetOutput()) + shift, squeezed)

    compression.SetChestWallToSliding()
    compression.Update()
    assert field(compression.GetOutput(), "PaddleForceN")[0] < force, "a wall that gives way"
    compression.SetChestWallToFixed()
    compression.SetForceN(2 * force)
    compression.Update()
    assert field(compression.GetOutput(), "ThicknessMm")[0] < 50, "more force, less thickness"
# Beyond 20,000 cells the simulation runs on a coarse mesh that is made for it, as in the command: some seconds, where the fine mesh
# itself takes minutes. Its skin stands out of the coarse one's facets by some tenths of a millimetre.
materials = {1: mammoray.Material(youngs_modulus=6, poisson_ratio=0.48), 2: mammoray.Material(fixed=True),
             3: mammoray.Material(youngs_modulus=12, poisson_ratio=0.48)}
fine = mammoray.mesh(labels, (2, 2, 2), origin=origin, materials=materials, cell_size=2.2)
assert len(fine.cells) > 20000
told = []
carried = mammoray.compress(fine.points, fine.cells, fine.regions, materials=materials, orientation="LAS", thickness=50,
                            progress=told.append)
front = carried.points[carried.points[:, 1] > 12]
assert carried.thickness == 50 and numpy.ptp(front[:, 2]) < 50.5 and max(told) <= 1
assert numpy.allclose(fine.points + carried.displacement, carried.points)
# Held tissue stays; what is carried keeps its volume within some percent in the middle.
assert abs(carried.displacement[fine.points[:, 1] < 2]).max() < 0.5
assert abs(numpy.median(carried.volume_ratio) - 1) < 0.05

# The gradient of a loss of the compressed points against central differences: of the stiffness of regions, and of the thickness; with
# the tissue simulated itself, and carried by a coarse mesh.
soft = {**materials, 1: mammoray.Material(youngs_modulus=6, poisson_ratio=0.45),
        3: mammoray.Material(youngs_modulus=20, poisson_ratio=0.45)}
coarse = mammoray.mesh(labels, (2, 2, 2), origin=origin, materials=soft, cell_size=11)
shown = mammoray.mesh(labels, (2, 2, 2), origin=origin, materials=soft, cell_size=6)
random = numpy.random.default_rng(4)
for breast, keywords in ((coarse, {}), (shown, {"simulation_mesh": coarse})):
    loss = numpy.sin(breast.points @ random.normal(size=(3, 3)) / 15)  # smooth, as a picture's is

    def press(thickness=52.0, **changed):
        table = {region: dataclasses.replace(material, youngs_modulus=material.youngs_modulus * changed.get(f"region{region}", 1.0))
                 for region, material in soft.items()}
        return mammoray.compress(breast.points, breast.cells, breast.regions, materials=table, orientation="LAS", thickness=thickness,
                                 element="linear", **keywords)
    squeezed = press()
    gradient = squeezed.backward(loss)
    assert sorted(gradient.materials) == [1, 2, 3] and list(gradient.pose)[:2] == ["thickness", "roll"]
    largest = max(map(abs, gradient.materials.values()))
    for region in (1, 3):
        difference = ((press(**{f"region{region}": 1.02}).points - press(**{f"region{region}": 0.98}).points) * loss).sum() / 0.04
        # Differences err in the second order of 2 %, equilibria by 1e-8 of their forces.
        assert abs(difference - gradient.materials[region]) < 0.01 * largest, (region, difference, gradient.materials)
    difference = ((press(52.05).points - press(51.95).points) * loss).sum() / 0.1
    assert abs(difference - gradient.pose["thickness"]) < 0.02 * abs(difference), (difference, gradient.pose)
    if keywords:
        assert gradient.stiffness is None
    else:
        assert gradient.stiffness.shape == (len(breast.cells),) and not gradient.stiffness[breast.regions == 2].any()
        for region in (1, 3):
            total = gradient.stiffness[breast.regions == region].sum()
            assert abs(total - gradient.materials[region]) < 1e-6 * largest, (region, total)
for message, refuse in (
        ("points: expected", lambda: squeezed.backward([[1, 2, 3]])),
        ("expected a mesh free of load", lambda: mammoray.compress(
            coarse.points, coarse.cells, coarse.regions, materials={region: dataclasses.replace(each, density=1.0)
                                                                    for region, each in soft.items()},
            orientation="LAS", thickness=52, element="linear", image_position="prone").backward(0 * coarse.points))):
    try:
        refuse()
        raise AssertionError(f"not refused: {message}")
    except mammoray.Error as error:
        assert message in str(error), error
print(f"{force:.2f} N at 50 mm, {carried.force:.2f} N of the fine mesh")
sys.exit(0)
