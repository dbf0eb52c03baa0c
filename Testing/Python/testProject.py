# SPDX-License-Identifier: Apache-2.0
"""X-rays of arrays against closed forms, without VTK: also what `pip install .` makes. Exit 125: no device."""
import math
import os
import sys
import tempfile
import warnings

import mammoray
import numpy

# A box, |x| <= 40, |y| <= 30, 10 <= z <= 30, its triangles turned outwards.
POINTS = numpy.array([(x, y, z) for z in (10, 30) for y in (-30, 30) for x in (-40, 40)], dtype=float)
TRIANGLES = numpy.array([(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
                         (1, 3, 7), (1, 7, 5)])
DETECTOR = mammoray.Detector(origin=(-9.5, -4.5, 0), column_step=(1, 0, 0), row_step=(0, 1, 0), columns=20, rows=10)
COLUMN, ROW = numpy.meshgrid(numpy.arange(20) - 9.5, numpy.arange(10) - 4.5)
# The length of a ray in a millimetre of depth.
OBLIQUE = numpy.sqrt(COLUMN**2 + ROW**2 + 400**2) / 400
SCENE = {"materials": {1: 0.05}, "source": (0, 0, 400), "detector": DETECTOR}


def refused(expected, *arrays, **options):
    """What project says of these; the rest is the scene's."""
    arrays = arrays or (POINTS, TRIANGLES)
    try:
        mammoray.project(*arrays, **{**SCENE, **options})
    except mammoray.InputError as error:
        assert expected in str(error) and "\n" not in str(error), error
        return
    raise AssertionError(f"not refused: {expected}")


try:
    image = mammoray.project(POINTS, TRIANGLES, **SCENE)
except mammoray.DeviceError as error:
    print(error)
    sys.exit(125)
assert image.transmission.shape == (10, 20) and image.path_lengths.shape == (2, 10, 20)
# Floats of 20 mm hold 1e-6; double precision on the device.
assert numpy.allclose(image.path_lengths[1], 20 * OBLIQUE, rtol=0, atol=1e-5)
assert not image.path_lengths[0].any() and image.consistency.all()
assert numpy.allclose(image.log_attenuation, OBLIQUE, rtol=0, atol=1e-6)
assert numpy.allclose(image.transmission, numpy.exp(-OBLIQUE), rtol=1e-6)
assert image.path_length_derivatives is None

# Other types of the same values, regions on both sides, a dict for the detector.
both = numpy.stack([numpy.zeros(12), numpy.ones(12)], axis=1)
same = mammoray.project(POINTS.astype(numpy.float32), TRIANGLES.astype(numpy.int16), both, materials=[mammoray.Material(0.05)],
                        source=[0, 0, 400], detector={"origin": (-9.5, -4.5, 0), "column_step": (1, 0, 0), "row_step": (0, 1, 0),
                                                      "columns": 20, "rows": 10})
assert (same.transmission == image.transmission).all()

# Parallel rays, straight down: 20 mm of each.
parallel = mammoray.project(POINTS, TRIANGLES, **{**SCENE, "source": mammoray.ParallelBeam((0, 0, -2))})
assert numpy.allclose(parallel.path_lengths[1], 20, rtol=0, atol=1e-5)

# The top rises: each ray is longer by its obliqueness; its shift sideways changes nothing. Exact, but for float.
rise = numpy.zeros((2, 8, 3))
rise[0, 4:, 2] = 1
rise[1, :, 0] = 1
moved = mammoray.project(POINTS, TRIANGLES, velocities=rise, **SCENE)
assert moved.path_length_derivatives.shape == (2, 2, 10, 20)
assert numpy.allclose(moved.path_length_derivatives[0, 1], OBLIQUE, rtol=0, atol=1e-5)
assert numpy.allclose(moved.log_attenuation_derivatives[0], 0.05 * OBLIQUE, rtol=0, atol=1e-6)
assert numpy.allclose(moved.path_length_derivatives[1], 0, rtol=0, atol=1e-5)

# A projector that keeps its mesh: moved points are projected as new ones.
projector = mammoray.Projector(POINTS, TRIANGLES)
thicker = POINTS + [0, 0, 10] * (POINTS[:, 2:] > 20)
projector.move(thicker)
assert numpy.allclose(projector.project(**SCENE).path_lengths[1], 30 * OBLIQUE, rtol=0, atol=1e-5)
assert projector.method in ("ray-tracing", "rasterisation") and projector.device

# Two tetrahedra that share a face, of two materials: as their surface.
corners = numpy.array([(0, 0, 10), (30, 0, 10), (0, 30, 10), (8, 8, 40), (8, 8, 5)], dtype=float) - [10, 10, 0]
tetrahedra = numpy.array([(0, 1, 2, 3), (0, 2, 1, 4)])
surface = numpy.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 1, 4), (1, 2, 4), (2, 0, 4)])
sides = numpy.array([(3, 1), (0, 1), (0, 1), (0, 1), (3, 0), (3, 0), (3, 0)])
table = {1: 0.02, 3: 0.07}
body = mammoray.project(corners, tetrahedra, [1, 3], **{**SCENE, "materials": table})
shell = mammoray.project(corners, surface, sides, **{**SCENE, "materials": table})
assert body.path_lengths.shape[0] == 4 and body.path_lengths[1].max() > 10 and body.path_lengths[3].max() > 1
# Rounding of floats.
assert numpy.allclose(body.path_lengths, shell.path_lengths, rtol=0, atol=1e-5)
assert numpy.allclose(body.log_attenuation, 0.02 * body.path_lengths[1] + 0.07 * body.path_lengths[3], rtol=0, atol=1e-6)
rise = numpy.random.default_rng(1).normal(size=(1, 5, 3))
changes = [mammoray.project(corners + step * rise[0], tetrahedra, [1, 3], **{**SCENE, "materials": table}) for step in (1e-2, -1e-2)]
exact = mammoray.project(corners, tetrahedra, [1, 3], velocities=rise, **{**SCENE, "materials": table})
difference = (changes[0].path_lengths.astype(float) - changes[1].path_lengths) / 2e-2
# Where no edge crosses the ray between the two; floats of 30 mm over 0.02 mm. Median: edges are few.
assert numpy.median(abs(difference - exact.path_length_derivatives[0])) < 2e-4

# Tables, compositions and spectra: the Beer-Lambert sum by hand at two energies, from single ones.
names = {1: mammoray.Material("adipose", density=0.92)}
single = [mammoray.project(POINTS, TRIANGLES, **{**SCENE, "materials": names, "spectrum": energy}).transmission.astype(float)
          for energy in (18, 25)]
two = mammoray.project(POINTS, TRIANGLES, spectrum=([18, 25], [3, 1]), **{**SCENE, "materials": names})
weights = [3 * 18, 25]
assert numpy.allclose(two.transmission, (weights[0] * single[0] + weights[1] * single[1]) / sum(weights), rtol=2e-6)
counted = mammoray.project(POINTS, TRIANGLES, spectrum=([18, 25], [3, 1]), photon_counting=True, **{**SCENE, "materials": names})
assert numpy.allclose(counted.transmission, (3 * single[0] + single[1]) / 4, rtol=2e-6)
assert mammoray.material_table("victre")[1].density > 0.8
water = mammoray.project(POINTS, TRIANGLES, spectrum="W28kVp_Rh50um_Be1mm", **{**SCENE, "materials": ["Water, Liquid"]})
# 20 mm of water: 0.5 to 1.7 /cm from 18 to 28 keV (NIST).
assert 0.8 < water.log_attenuation.mean() < 3
# Aluminium's own density is 2.70 g/cm3: 3.441 cm2/g at 20 keV (NIST), 2 %.
aluminium = mammoray.project(POINTS, TRIANGLES, spectrum=20, **{**SCENE, "materials": [mammoray.Material("Al")]})
assert numpy.allclose(aluminium.log_attenuation, 3.441 * 0.270 * 20 * OBLIQUE, rtol=0.02)

# Noise: its seed decides; the mean within five deviations, of 200 pixels of 1e4 photons.
noisy = [mammoray.project(POINTS, TRIANGLES, photons_per_pixel=1e4, seed=seed, **SCENE).transmission for seed in (1, 1, 2)]
assert (noisy[0] == noisy[1]).all() and (noisy[0] != noisy[2]).any()
assert abs((noisy[0] - image.transmission).mean()) < 5 * math.sqrt(image.transmission.mean() / 1e4 / 200)

# Refraction: a wedge bends all rays by delta times its slope, to where it is thinner; delta of water at 20 keV: 5.77e-7 (CXRO).
wedge = POINTS + [0, 0, 1] * (POINTS[:, :1] / 8 * (POINTS[:, 2:] > 20))
bent = mammoray.project(wedge, TRIANGLES, **{**SCENE, "materials": ["Water, Liquid"], "source": mammoray.ParallelBeam((0, 0, -1))},
                        refraction="geometric", bend_distance=1000)
assert bent.deflection.shape == (2, 10, 20) and image.deflection is None
assert numpy.allclose(bent.deflection[0], -5.77e-7 / 8, rtol=5e-3), bent.deflection[0].mean()
assert numpy.allclose(bent.deflection[1], 0, atol=1e-10)
straight = mammoray.project(wedge, TRIANGLES, **{**SCENE, "materials": ["Water, Liquid"], "source": mammoray.ParallelBeam((0, 0, -1))})
# By less than a tenthousandth of a pixel.
assert numpy.allclose(bent.transmission, straight.transmission, rtol=1e-4)

# Dual energy: what the weight cancels is gone at single energies, whatever the thickness; calcium stays.
weight = mammoray.cancelling_weight("adipose", "glandular", low=20, high=35)
pairs = [[mammoray.project(POINTS, TRIANGLES, spectrum=energy, **{**SCENE, "materials": [name]}) for energy in (20, 35)]
         for name in ("adipose", "glandular", mammoray.Material("Ca5(PO4)3OH", density=1))]
left = [mammoray.recombine(low, high, weight) for low, high in pairs]
assert numpy.allclose(left[0], left[1], atol=1e-5) and abs(left[2] - left[0]).min() > 0.2

# A box without its top leaks; it is told and marked.
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter("always")
    leak = mammoray.project(POINTS, numpy.delete(TRIANGLES, [2, 3], axis=0), **SCENE)
assert not leak.consistency.any() and len(told) == 1 and "holes" in str(told[0].message)
assert os.path.basename(told[0].filename) == "testProject.py", "the caller's line"

# What nothing is seen of is told, with its reason.
for expected, points, regions, source in (("are all regions 0?", POINTS, numpy.zeros(12), (0, 0, 400)), ("behind the source", POINTS, None, (0, 0, 5)),
                                          ("behind the detector", POINTS - [0, 0, 50], None, (0, 0, 400)),
                                          ("mm wide: a file in metres?", POINTS / 1000 + [0.2, 0.2, 0], None, (0, 0, 400))):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        nothing = mammoray.project(points, TRIANGLES, regions, **{**SCENE, "source": source})
    assert (nothing.transmission == 1).all() and len(told) == 1, (expected, told)
    assert "the picture is empty" in str(told[0].message) and expected in str(told[0].message), told[0].message

refused("points: expected n x 3 values, found 8 x 2", POINTS[:, :2], TRIANGLES)
refused("points[2, 1]: expected a finite number", numpy.where(numpy.arange(24).reshape(8, 3) == 7, numpy.nan, POINTS), TRIANGLES)
refused("points: expected numbers", POINTS.astype(str), TRIANGLES)
refused("cells: expected m x 3 triangles or m x 4 tetrahedra, found 12 x 2", POINTS, TRIANGLES[:, :2])
refused("expected 0 to 7, found 8", POINTS, TRIANGLES + 1)
refused("quads?", POINTS, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
refused("expected a whole number, found 1.5", POINTS, TRIANGLES * 0.75)
refused("regions: expected 12 values, found 11", POINTS, TRIANGLES, numpy.ones(11))
refused("region 1 of the mesh has no attenuation; regions 2 have one", materials={2: 0.1})
refused("did you mean adipose?", materials={1: "adipse"})
refused("did you mean victre?", materials="victr")
refused("expected positive coefficients", materials={1: -1})
refused("materials[1]: no field 'densty'; did you mean density?", materials={1: {"attenuation": "adipose", "densty": 1}})
refused("materials[1].attenuation: expected 1 values, found 2", materials={1: mammoray.Material([0.1, 0.2])})
refused("attenuation 'H2O': expected a density", materials=["H2O"])
refused("attenuation 'SiO2': expected a density", materials={1: mammoray.Material("SiO2")})
refused("found 2699 (in kg/m3?)", materials={1: mammoray.Material("Al", density=2699)})
refused("materials[1].density: expected a positive number", materials={1: mammoray.Material("Al", density=0)})
refused("source: expected 3 values, found 2", source=(0, 400))
refused("detector: no field 'colums'; did you mean columns", detector={"colums": 3})
refused("detector: expected the field 'row_step'", detector={"origin": (0, 0, 0), "column_step": (1, 0, 0), "columns": 1, "rows": 1})
refused("detector.rows: expected 1 to 65535, found 0", detector=mammoray.Detector((0, 0, 0), (1, 0, 0), (0, 1, 0), 1, 0))
refused("detector.columns: expected a whole number", detector=mammoray.Detector((0, 0, 0), (1, 0, 0), (0, 1, 0), 1.5, 1))
refused("spectrum", spectrum="W28")
refused("spectrum: photons: expected 2 values, found 1", spectrum=([18, 25], [1]))
refused("refraction: expected geometric or near-field, found 'straight'", refraction="straight")
refused("materials[1].attenuation: expected a composition beside refraction", refraction="geometric")
refused("refraction: expected no noise", refraction="geometric", photons_per_pixel=10)
refused("velocities: expected n x 8 x 3", velocities=numpy.zeros((1, 7, 3)))
refused("expected auto, ray-tracing or rasterisation", method="fast")
refused("photons per pixel", photons_per_pixel=-1)
try:
    mammoray.project(POINTS, TRIANGLES, device="no such device", **SCENE)
    raise AssertionError("not refused: device")
except mammoray.DeviceError as error:
    assert "no such device" in str(error)
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "table.json")
    with open(path, "w", encoding="utf-8") as file:
        file.write('{ "materials": [ { "name": "air", "labels": [0] }, { "name": "fat" } ] }')
    refused("table.json", materials=path)

assert "vtkmodules" not in sys.modules, "the projector needs no VTK"
assert mammoray.__version__.count(".") == 2
print(f"{mammoray.__file__}: {mammoray.__version__}, {projector.device}")
