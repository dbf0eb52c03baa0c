# SPDX-License-Identifier: Apache-2.0
"""X-rays of arrays against closed forms, without VTK: also what `pip install .` makes. Exit 125: no device."""
import math
import os
import signal
import struct
import sys
import tempfile
import threading
import types
import warnings
import zlib

import mammoray as mr
import numpy

# A box, |x| <= 40, |y| <= 30, 10 <= z <= 30, its triangles turned outwards.
POINTS = numpy.array([(x, y, z) for z in (10, 30) for y in (-30, 30) for x in (-40, 40)], dtype=float)
TRIANGLES = numpy.array([(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
                         (1, 3, 7), (1, 7, 5)])
PLACE = {"origin": (-9.5, -4.5, 0), "column_direction": (1, 0, 0), "row_direction": (0, 1, 0), "columns": 20, "rows": 10,
         "pixel_spacing": 1}
COLUMN, ROW = numpy.meshgrid(numpy.arange(20) - 9.5, numpy.arange(10) - 4.5)
# The length of a ray in a millimetre of depth.
OBLIQUE = numpy.sqrt(COLUMN**2 + ROW**2 + 400**2) / 400


def scene_of(points=POINTS, cells=TRIANGLES, regions=None, *, materials=0.05, source=(0, 0, 400), detector=None, **fields):
    """A scene of one mesh: what all its regions are made of, or the materials of regions."""
    mesh = mr.Mesh(points, cells, regions)
    several = isinstance(materials, (dict, list)) or materials in ("victr", "victre")
    return mr.Scene(mr.Sample(mesh, None if several else materials), materials=materials if several else None,
                    source=mr.Source(position=source), detector=mr.Detector(**{**PLACE, **(detector or {})}), **fields)


def refused(expected, call, *arguments, **keywords):
    """Expects a refusal of one line with this text."""
    try:
        made = call(*arguments, **keywords)
        if isinstance(made, mr.Scene):
            made.expose()
    except mr.InputError as error:
        assert expected in str(error) and "\n" not in str(error), error
        return
    raise AssertionError(f"not refused: {expected}")


scene = scene_of()
try:
    image = scene.expose()
except mr.DeviceError as error:
    print(error)
    sys.exit(125)
assert image.transmission.shape == (10, 20) and image.path_lengths.shape == (2, 10, 20) and image.materials == ("air", "0.05/mm")
# Floats of 20 mm hold 1e-6; double precision on the device.
assert numpy.allclose(image.path_lengths[1], 20 * OBLIQUE, rtol=0, atol=1e-5)
assert not image.path_lengths[0].any() and image.consistency.all()
assert numpy.allclose(image.log_attenuation, OBLIQUE, rtol=0, atol=1e-6)
assert numpy.allclose(image.transmission, numpy.exp(-OBLIQUE), rtol=1e-6)
assert image.deflection is None and image.dose is None

# Other types of the same values, regions on both sides, inside out, from other packages' objects.
both = numpy.stack([numpy.zeros(12), numpy.ones(12)], axis=1)
assert (scene_of(POINTS.astype(numpy.float32), TRIANGLES.astype(numpy.int16), both, materials=[0.05]).expose().transmission
        == image.transmission).all()
assert (scene_of(POINTS, TRIANGLES[:, ::-1]).expose().transmission == image.transmission).all(), "wound the other way"
quads = types.SimpleNamespace(type="quad", data=[(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
for other in (types.SimpleNamespace(vertices=POINTS / 10, faces=TRIANGLES),  # as of trimesh and of meshio
              types.SimpleNamespace(points=POINTS / 10, cells=[quads], cell_data={"Material": [[1] * 6]}), (POINTS / 10, TRIANGLES)):
    scene.samples = mr.Sample(mr.read_mesh(other, unit="cm"), 0.05)
    assert numpy.allclose(scene.expose().path_lengths, image.path_lengths, rtol=0, atol=1e-5), other

# Parallel rays, straight down: 20 mm of each.
parallel = scene_of(source=None)
parallel.source.beam_direction = (0, 0, -2)
assert numpy.allclose(parallel.expose().path_lengths[1], 20, rtol=0, atol=1e-5)

# The top rises: each ray is longer by its obliqueness; its shift sideways changes nothing. Exact, but for float.
rise = numpy.zeros((2, 8, 3))
rise[0, 4:, 2] = 1
rise[1, :, 0] = 1
moved = image.derivatives(rise)
assert moved.path_lengths.shape == (2, 2, 10, 20)
assert numpy.allclose(moved.path_lengths[0, 1], OBLIQUE, rtol=0, atol=1e-5)
assert numpy.allclose(moved.log_attenuation[0], 0.05 * OBLIQUE, rtol=0, atol=1e-6)
assert numpy.allclose(moved.path_lengths[1], 0, rtol=0, atol=1e-5)
# Two samples, the second turned: its velocities turn with it.
two = mr.Scene([mr.Sample(mr.Mesh(POINTS, TRIANGLES), 0.05), mr.Sample(mr.Mesh(POINTS, TRIANGLES), 0.02, (1, 0, 0), 180, (0, 0, 80))],
               source=mr.Source((0, 0, 400)), detector=mr.Detector(**PLACE))
assert numpy.allclose(two.expose().path_lengths[2], 20 * OBLIQUE, rtol=0, atol=1e-5)
both_move = two.expose().derivatives([0 * rise, rise])
assert numpy.allclose(both_move.path_lengths[0, 2], OBLIQUE, rtol=0, atol=1e-5) and not both_move.path_lengths[0, 1].any()

# Reverse mode is forward mode turned round: <J v, g> = <v, J^T g>, of both samples, one of them turned; float's rounding of sums.
random = numpy.random.default_rng(2)
paired = two.expose()
loss, velocities = random.normal(size=(10, 20)), [random.normal(size=(1, 8, 3)) for _ in range(2)]
gradient = paired.backward(transmission=loss)
forward = -(loss * paired.transmission * paired.derivatives(velocities).log_attenuation[0]).sum()
reverse = sum((each[0] * of).sum() for each, of in zip(velocities, gradient.points))
assert abs(forward - reverse) < 1e-4 * abs(loss * paired.transmission).sum(), (forward, reverse)
# A change of a material's attenuation, and of a length, by hand.
lengths = paired.path_lengths[1:].astype(float)
assert numpy.allclose([gradient.attenuation["0.05/mm"], gradient.attenuation["0.02/mm"]],
                      [-(loss * paired.transmission * mu * lengths[index]).sum() for index, mu in enumerate((0.05, 0.02))], rtol=1e-4)
by_length = paired.backward(path_lengths=numpy.stack([0 * loss, loss, 0 * loss]))
assert abs(by_length.points[0].sum(axis=0)[2] - 0) < 1e-3 * abs(loss).sum() and not by_length.points[1].any()
# The place of the source, by central differences: the whole box seen obliquely.
oblique = scene_of(source=(100, 30, 400), detector={"origin": (-95, -45, 0), "pixel_spacing": 10})
loss = random.normal(size=(10, 20))
slope = oblique.expose().backward(transmission=loss).source
for axis in range(3):
    sides = []
    for step in (0.5, -0.5):
        oblique.source.position = numpy.array((100, 30, 400)) + step * numpy.eye(3)[axis]
        sides.append((loss * oblique.expose().transmission.astype(float)).sum())
    assert abs(sides[0] - sides[1] - slope[axis]) < 0.05 * abs(slope).max() + 1e-3, (axis, sides, slope)
# Motions of two turned samples, through a focal spot and averaged samples, by central differences, which are rough where edges
# cross rays: the loss is smooth.
moving = mr.Scene([mr.Sample(mr.Mesh(0.2 * POINTS - (0, 0, 4), TRIANGLES), 0.05, axis=axis, angle=angle, translation=place)
                   for axis, angle, place in (((1, 2, -1), 40, (-9, 1, 30)), ((1, -1, 3), 25, (9, -1, 40)))],
                  source=mr.Source((5, 3, 400), focal_spot=(2, 1), focal_spot_samples=2), beam=mr.Beam(kev=40),
                  detector=mr.Detector((-24, -14, 0), (1, 0, 0), (0, 1, 0), 97, 57, 0.5, samples=2))
row, column = numpy.mgrid[:57, :97]
loss = numpy.sin(0.11 * column + 0.3) * numpy.cos(0.07 * row)
found = moving.expose().backward(transmission=loss)
assert found.translation.shape == found.rotation.shape == (2, 3)


def vector_of(sample):
    return numpy.radians(sample.angle) * numpy.array(sample.axis) / numpy.linalg.norm(sample.axis)


def turn_to(sample, vector):
    sample.axis, sample.angle = vector, numpy.degrees(numpy.linalg.norm(vector))


for index, sample in enumerate(moving.samples):
    turned, placed = vector_of(sample), numpy.array(sample.translation)
    for axis in numpy.eye(3):
        differences = []
        for change, step in ((lambda by: setattr(sample, "translation", placed + by), 0.2),
                             (lambda by: turn_to(sample, turned + by), 0.03)):
            sides = []
            for sign in (1, -1):
                change(sign * step * axis)
                sides.append((loss * moving.expose().transmission.astype(float)).sum())
            change(0 * axis)
            differences.append((sides[0] - sides[1]) / (2 * step))
        for difference, slopes in zip(differences, (found.translation[index], found.rotation[index])):
            assert abs(difference - slopes @ axis) < 0.02 * abs(slopes).max(), (index, axis, difference, slopes)

# Only changes are repeated: a moved mesh is refitted, and another beam traces nothing.
with mr.Projector() as projector:
    scene = scene_of()
    projector.expose(scene)
    assert projector.traces == 1 and projector.method in ("ray-tracing", "rasterisation") and projector.device
    scene.beam = mr.Beam(kev=40)
    scene.detector.photons = 1e4
    projector.expose(scene)
    assert projector.traces == 1
    scene.samples[0].mesh.points = POINTS + [0, 0, 10] * (POINTS[:, 2:] > 20)
    assert numpy.allclose(projector.expose(scene).path_lengths[1], 30 * OBLIQUE, rtol=0, atol=1e-5) and projector.traces == 2
    scene.samples[0].translation = (0, 0, 5)
    assert projector.expose(scene).path_lengths[1].max() > 30 and projector.traces == 3
assert projector.traces == 0, "closed"
try:
    scene.samples[0].mesh.points += 1
    scene.samples[0].mesh.points[0] = 1
    raise AssertionError("changed without being told")
except ValueError:
    pass

# Two tetrahedra that share a face, of two materials: as their surface.
corners = numpy.array([(0, 0, 10), (30, 0, 10), (0, 30, 10), (8, 8, 40), (8, 8, 5)], dtype=float) - [10, 10, 0]
tetrahedra = numpy.array([(0, 1, 2, 3), (0, 2, 1, 4)])
surface = numpy.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 1, 4), (1, 2, 4), (2, 0, 4)])
sides = numpy.array([(3, 1), (0, 1), (0, 1), (0, 1), (3, 0), (3, 0), (3, 0)])
table = {1: 0.02, 3: 0.07}
body = scene_of(corners, tetrahedra, [1, 3], materials=table).expose()
shell = scene_of(corners, surface, sides, materials=table).expose()
assert body.path_lengths.shape[0] == 4 and body.path_lengths[1].max() > 10 and body.path_lengths[3].max() > 1
# Rounding of floats.
assert numpy.allclose(body.path_lengths, shell.path_lengths, rtol=0, atol=1e-5)
assert numpy.allclose(body.log_attenuation, 0.02 * body.path_lengths[1] + 0.07 * body.path_lengths[3], rtol=0, atol=1e-6)
rise = numpy.random.default_rng(1).normal(size=(1, 5, 3))
changes = [scene_of(corners + step * rise[0], tetrahedra, [1, 3], materials=table).expose() for step in (1e-2, -1e-2)]
exact = body.derivatives(rise)
difference = (changes[0].path_lengths.astype(float) - changes[1].path_lengths) / 2e-2
# Where no edge crosses the ray between the two; floats of 30 mm over 0.02 mm. Median: edges are few.
assert numpy.median(abs(difference - exact.path_lengths[0])) < 2e-4

# Tables, compositions and spectra: the Beer-Lambert sum by hand at two energies, from single ones.
fat = mr.Material("adipose", density=0.92, name="fat")
single = [scene_of(materials=fat, beam=mr.Beam(kev=energy)).expose().transmission.astype(float) for energy in (18, 25)]
lines = mr.Beam(energies=[18, 25], photons=numpy.array([3, 1]))
mixed = scene_of(materials=fat, beam=lines).expose()
assert mixed.materials == ("air", "fat")
weights = [3 * 18, 25]
assert numpy.allclose(mixed.transmission, (weights[0] * single[0] + weights[1] * single[1]) / sum(weights), rtol=2e-6)
counted = scene_of(materials=fat, beam=lines, detector={"response": "counting"}).expose()
assert numpy.allclose(counted.transmission, (3 * single[0] + single[1]) / 4, rtol=2e-6)
# Attenuation by energy, between them on straight lines of the logarithms.
given = scene_of(materials=mr.Material(([10, 40], [0.1, 0.025])), beam=mr.Beam(kev=20)).expose()
assert numpy.allclose(given.log_attenuation, 0.05 * 20 * OBLIQUE, rtol=1e-6)
assert mr.material_table("victre")[1].density > 0.8
water = scene_of(materials="Water, Liquid").expose()
# 20 mm of water: 0.5 to 1.7 /cm from 18 to 28 keV (NIST).
assert 0.8 < water.log_attenuation.mean() < 3
# Aluminium's own density is 2.70 g/cm3: 3.441 cm2/g at 20 keV (NIST), 2 %.
aluminium = scene_of(materials="Al", beam=mr.Beam(kev=20)).expose()
assert numpy.allclose(aluminium.log_attenuation, 3.441 * 0.270 * 20 * OBLIQUE, rtol=0.02)
tube = mr.Beam(tube="W", kvp=30, filters=["Al:0.5", "Rh:0.05"])
energies, photons = tube.weights()
assert energies.max() <= 31 and abs((energies * photons).sum() / photons.sum() - tube.mean_energy) < 1e-9
assert 0.3 < tube.half_value_layer < 1
tube.filters = "Al:3"
assert tube.half_value_layer > 0.6

# Noise: its seed decides; the mean within five deviations, of 200 pixels of 1e4 photons.
noisy = [scene_of(detector={"photons": 1e4, "seed": seed}).expose().transmission for seed in (1, 1, 2)]
assert (noisy[0] == noisy[1]).all() and (noisy[0] != noisy[2]).any()
assert abs((noisy[0] - image.transmission).mean()) < 5 * math.sqrt(image.transmission.mean() / 1e4 / 200)

# Refraction: a wedge bends all rays by delta times its slope, to where it is thinner; delta of water at 20 keV: 5.77e-7 (CXRO).
wedge = POINTS + [0, 0, 1] * (POINTS[:, :1] / 8 * (POINTS[:, 2:] > 20))
straight = scene_of(wedge, materials="Water, Liquid", source=None, beam=mr.Beam(kev=20))
straight.source.beam_direction = (0, 0, -1)
direct = straight.expose()
straight.refraction = mr.Refraction(law="geometric", distance=1000)
bent = straight.expose()
assert bent.deflection.shape == (2, 10, 20)
assert numpy.allclose(bent.deflection[0], -5.77e-7 / 8, rtol=5e-3), bent.deflection[0].mean()
assert numpy.allclose(bent.deflection[1], 0, atol=1e-10)
# By less than a tenthousandth of a pixel.
assert numpy.allclose(bent.transmission, direct.transmission, rtol=1e-4)

# Dual energy: what the weight cancels is gone at single energies, whatever the thickness; calcium stays.
names = [mr.Material("adipose", name="fat"), mr.Material("glandular", name="gland"), mr.Material("Ca5(PO4)3OH", density=1, name="lime")]
pairs = []
for region in (1, 2, 3):
    several = scene_of(regions=numpy.full(12, region), materials=names, beam=mr.Beam(kev=20))
    pairs.append(mr.dual_energy(several, mr.Beam(kev=35), thickness=30))
assert pairs[0].weight == pairs[2].weight and several.beam.kev == 20
assert numpy.allclose(pairs[0].recombined, pairs[1].recombined, atol=1e-5) and abs(pairs[2].recombined - pairs[0].recombined).min() > 0.2

# A turning box: seen from the side after a quarter; noise of its own in each picture. As iterator, by index and as one array.
turning = scene_of(detector={"photons": 1e5, "origin": (-9.5, -4.5, -50)})
series = mr.turn(turning, 4, span=360, axis="y", axis_point=(0, 0, 20))
assert len(series) == 4 and (series.angles == [0, 90, 180, 270]).all() and series.detectors.shape == (4, 3, 3)
stack = numpy.asarray(series)
assert stack.shape == (4, 10, 20) and (stack[1] == [each.transmission for each in series][1]).all()
# From the side rays have the box's 80 mm of x; obliqueness 0.01 %.
assert abs(series[1].path_lengths[1][5, 9] - 80) < 0.01 and abs(series[-2].path_lengths[1][5, 9] - 20) < 0.01
assert (stack[0] != stack[2]).any()
flat = series.flat_fields(2)
assert flat.shape == (2, 10, 20) and abs(flat.mean() - 1) < 5 / math.sqrt(1e5 * 400) and (flat[0] != flat[1]).any()
# Tomosynthesis: the middle one is the scene's own, the others see the top shifted against the detector.
sweep = mr.tomosynthesis(scene_of(), 3, span=20, pivot_height=0)
assert (sweep.angles == [-10, 0, 10]).all() and numpy.allclose(sweep.sources[1], (0, 0, 400))
assert numpy.allclose(sorted(sweep.sources[:, 1]), [-400 * math.sin(math.radians(10)), 0, 400 * math.sin(math.radians(10))])
assert (sweep[1].transmission == image.transmission).all()

# Placed around where nobody says where: all of it is in the picture.
around = mr.Scene(mr.Sample(mr.Mesh(POINTS, TRIANGLES), "Al"), detector=mr.Detector(columns=64, rows=64)).expose()
assert around.transmission.shape == (64, 64) and around.path_lengths[1].max() > 40
assert not around.path_lengths[1][[0, -1]].any() and not around.path_lengths[1][:, [0, -1]].any()

# In a mammography unit: what is told of a realistic one changes the picture, display is bright where much is absorbed.
unit = scene_of(POINTS + [0, 30, 0], materials="adipose", source=None, detector={"origin": None, "column_direction": None, "row_direction": None})
placed = unit.place_unit("LAS", thickness=25, source_to_detector=600)
assert numpy.allclose(placed.z, (0, 0, 1)) and numpy.allclose(placed.y, (0, 1, 0)) and unit.source.position[2] > 500
plain = unit.expose()
assert 19.9 < plain.path_lengths[1].max() < 25
unit.realistic = True
shown = unit.expose()
assert (shown.transmission - plain.transmission).mean() > 0.002 and len(numpy.unique(shown.transmission)) > 150, "scatter, noise"
assert shown.display().shape == (10, 20) and 0 <= shown.display().min() <= shown.display().max() <= 1

# Dose by following photons: the mass of 96 cm3 of fat; 2 of its 48 cm2 lie before the detector, to which the beam is limited, and
# half of what enters there stays, roughly. A copy without VTK cannot.
unit.dose = True
unit.scatter = mr.Scatter(photons=2e4, voxel=2)
try:
    dose = unit.expose().dose
    assert abs(dose.mass["adipose"] - 88.3) < 1 and dose.photons == 20000, dose
    assert 0.25 < dose.per_air_kerma["adipose"] * 24 < 0.7 and 0 < dose.error["adipose"] < 1e-3, dose
    unit.dose = None
    unit.scatter.method = "monte-carlo"
    assert unit.expose().transmission.mean() > plain.transmission.mean()
except mr.InputError as error:
    assert "expected a mammoray with Meshing" in str(error) and not hasattr(mr._xray, "read_mesh"), error

# Ctrl-C and a callback's own exception stop the work; another thread has a device of its own.
slow = scene_of(detector={"columns": 400, "rows": 400, "samples": 4}, beam=mr.Beam(kev=20))
slow.source.focal_spot = (1, 1)
told = []


def interrupt(done, stage):
    told.append((done, stage))
    if len(told) == 3:
        os.kill(os.getpid(), signal.SIGINT)


for progress, kind in ((interrupt, KeyboardInterrupt), (lambda done, stage: 1 / 0, ZeroDivisionError)):
    try:
        slow.expose(progress=progress)
        raise AssertionError("not stopped")
    except kind:
        pass
assert 3 <= len(told) < 20 and all(0 <= done <= 1 and stage for done, stage in told)
found = []
thread = threading.Thread(target=lambda: found.append(scene_of().expose().transmission))
thread.start()
thread.join()
assert (found[0] == image.transmission).all()

# Others run meanwhile: a thread sets what progress waits for. A projector in use refuses further calls.
waiting, seen = threading.Event(), threading.Event()
threading.Thread(target=lambda: (waiting.wait(), seen.set()), daemon=True).start()
with mr.Projector() as projector:
    def reenter(done, stage):
        waiting.set()
        assert seen.wait(60)
        refused("projector: expected one that is free", projector.expose, scene_of())
        raise LookupError
    try:
        projector.expose(slow, progress=reenter)
        raise AssertionError("not stopped")
    except LookupError:
        pass
    results = []

    def many(shift):
        for _ in range(20):
            moved = scene_of(POINTS + shift)
            try:
                results.append(bool((projector.expose(moved).transmission == moved.expose().transmission).all()))
            except mr.InputError as error:
                results.append("expected one that is free" in str(error))
    threads = [threading.Thread(target=many, args=(shift,)) for shift in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 40 and all(results), results

# A box without its top leaks; it is told and marked.
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    leak = scene_of(POINTS, numpy.delete(TRIANGLES, [2, 3], axis=0)).expose()
assert not leak.consistency.any() and len(caught) == 1 and "holes" in str(caught[0].message)
assert os.path.basename(caught[0].filename) == "testScene.py", "the caller's line"
# A sample that is not seen is reported with the reason.
for expected, points, regions, source in (("are all regions 0?", POINTS, numpy.zeros(12), (0, 0, 400)), ("behind the source", POINTS, None, (0, 0, 5)),
                                          ("behind the detector", POINTS - [0, 0, 50], None, (0, 0, 400)),
                                          ("mm wide: a file in metres?", POINTS / 1000 + [0.2, 0.2, 0], None, (0, 0, 400))):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        nothing = scene_of(points, regions=regions, source=source, materials=[0.05]).expose()
    assert (nothing.transmission == 1).all() and len(caught) == 1, (expected, caught)
    assert "the picture is empty" in str(caught[0].message) and expected in str(caught[0].message), caught[0].message
# check() finds parts that overlap, and shadows beside the detector.
crossing = mr.Scene([mr.Sample(mr.Mesh(POINTS, TRIANGLES), 0.1), mr.Sample(mr.Mesh(POINTS + 5, TRIANGLES), 0.2)],
                    source=mr.Source((0, 0, 400)), detector=mr.Detector(origin=(-99, -99, 0), column_direction=(1, 0, 0),
                                                                        row_direction=(0, 1, 0), columns=100, rows=100, pixel_spacing=2))
assert len(crossing.check()) == 1 and "pairs of triangles cross" in crossing.check()[0], crossing.check()
crossing.overlap_priority = ["0.2/mm", "0.1/mm"]
assert crossing.check() == []
assert "of the shadow falls on the detector" in scene.check()[0]

# A PNG of 16 bits.
data = image._repr_png_()
assert data[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">IIBB", data[16:26]) == (20, 10, 16, 0)
size = struct.unpack(">I", data[33:37])[0]
grey = numpy.frombuffer(zlib.decompress(data[41:41 + size]), numpy.uint8).reshape(10, 41)[:, 1:].copy().view(">u2")
assert abs(grey / 65535 - image.transmission).max() < 1 / 65535

refused("points: expected n x 3 values, found 8 x 2", mr.Mesh, POINTS[:, :2], TRIANGLES)
refused("points[2, 1]: expected a finite number", mr.Mesh, numpy.where(numpy.arange(24).reshape(8, 3) == 7, numpy.nan, POINTS), TRIANGLES)
refused("points: expected numbers", mr.Mesh, POINTS.astype(str), TRIANGLES)
refused("cells: expected m x 3 triangles or m x 4 tetrahedra, found 12 x 2", mr.Mesh, POINTS, TRIANGLES[:, :2])
refused("expected 0 to 7, found 8", mr.Mesh, POINTS, TRIANGLES + 1)
refused("quads?", mr.Mesh, POINTS, quads.data)
assert (mr.Mesh(POINTS, TRIANGLES.astype(float)).cells == mr.Mesh(POINTS, TRIANGLES).cells).all()  # of a text of numbers
refused("expected a whole number, found inf", mr.Mesh, POINTS, TRIANGLES + numpy.inf)
refused("expected a whole number, found 1.5", mr.Mesh, POINTS, TRIANGLES * 0.75)
refused("regions: expected 12 values, found 11", mr.Mesh, POINTS, TRIANGLES, numpy.ones(11))
refused("points: expected 8 x 3 values", setattr, mr.Mesh(POINTS, TRIANGLES), "points", POINTS[:4])
refused("unit: expected um, mm, cm, m or in, found 'inch'", mr.read_mesh, (POINTS, TRIANGLES), "inch")
refused("mesh: expected a file, an object of VTK", mr.read_mesh, 3)
refused("region 1 of the mesh has no attenuation; regions 2 have one", scene_of, materials={2: 0.1})
refused("did you mean adipose?", scene_of, materials="adipse")
refused("did you mean victre?", scene_of, materials="victr")
refused("expected positive coefficients", scene_of, materials={1: -1})
refused("materials[1]: no field 'densty'; did you mean density?", scene_of, materials={1: {"attenuation": "adipose", "densty": 1}})
refused("materials[1].attenuation: values: expected 1 values, found 2", scene_of, materials={1: mr.Material(([20], [0.1, 0.2]))})
refused("'H2O': expected a density", scene_of, materials=["H2O"])
refused("density: expected a number, found True", scene_of, materials=[mr.Material("H2O", density=True)])
refused("'H2O@1': expected the density apart", scene_of, materials=["H2O@1"])
refused("samples[0]: attenuation 'SiO2': expected a density", scene_of, materials="SiO2")
refused("found 2699 (in kg/m3?)", scene_of, materials={1: mr.Material("Al", density=2699)})
refused("materials[1].density: expected a positive number", scene_of, materials={1: mr.Material("Al", density=0)})
refused("samples[0].material: expected one, or materials of the scene", lambda: mr.Scene(mr.Mesh(POINTS, TRIANGLES)))
refused("samples: expected one at least", lambda: mr.Scene())
refused("Sample: no field 'rotation'", setattr, mr.Sample(mr.Mesh(POINTS, TRIANGLES)), "rotation", 3)
refused("source.position: expected three numbers from -1e+06 mm to 1e+06 mm, found [0,400]", mr.Source, position=(0, 400))
refused("detector: no field 'colums'; did you mean columns", lambda: mr.Scene(detector={"colums": 3}))
refused("Detector: no field 'colums'; did you mean columns", setattr, mr.Detector(), "colums", 3)
refused("Scene: no field 'beem'", setattr, scene, "beem", 3)
refused("detector.rows: expected a whole number from 1 to 65535, found 0", mr.Detector, rows=0)
refused("detector.columns: expected a whole number from 1 to 65535, found 1.5", mr.Detector, columns=1.5)
refused("detector.pixel_spacing: expected an origin beside it", lambda: mr.Scene(mr.Sample((POINTS, TRIANGLES), "Al"), detector=mr.Detector(pixel_spacing=1)))
refused("source.position: expected beside detector.origin", scene_of, source=None)
refused("detector.photons: expected a number from 0 to 1e+12, found -1", mr.Detector, photons=-1)
refused("beam.tube: expected one of", mr.Beam, tube="Pb")
refused("beam.kev: expected a number from 1 to 500, found \"ten\"", mr.Beam, kev="ten")
refused("spectrum W28: no such file", scene_of, beam=mr.Beam(spectrum="W28"))
refused("beam.photons: expected a number for each of 2 energies, found 1", scene_of, beam=mr.Beam(energies=[18, 25], photons=[1]))
refused("beam: expected one of kev, energies, spectrum, and tube with kvp, found several", scene_of, beam=mr.Beam(kev=20, tube="W"))
refused("beam.tube: expected beside kvp, found none", scene_of, beam=mr.Beam(kvp=30))
refused("overlap-priority: unknown material 'Al'", scene_of, overlap_priority=["Al"])
refused("iodine: unknown material 'gland'", scene_of, iodine={"gland": 2})
refused("cancel: unknown material 'skin'", mr.dual_energy, scene_of(), mr.Beam(kev=35), cancel=("0.05/mm", "skin"))
refused("projector: expected a Projector, found 'fast'", scene.expose, "fast")
refused("nowhere.stl: no such file", mr.Scene, "nowhere.stl")
refused("Scene: no field 'material'; did you mean materials", mr.Scene, material="Al")
refused("refraction.law: expected one of", mr.Refraction, law="straight")
refused("refraction: expected an element, a formula", scene_of, refraction=mr.Refraction("geometric"))
refused("refraction: expected no noise", scene_of, materials="Al", refraction=mr.Refraction("geometric"), detector={"photons": 10})
bent = scene_of(materials="Al", refraction=mr.Refraction("geometric"), beam=mr.Beam(kev=30)).expose()
refused("derivatives: expected a point-like or parallel source without noise", bent.derivatives, numpy.zeros((1, 8, 3)))
refused("scatter and refraction, found refraction", bent.backward, 0 * bent.transmission)
refused("velocities: expected n x 8 x 3", image.derivatives, numpy.zeros((1, 7, 3)))
refused("velocities: expected those of one parameter at least", image.derivatives, numpy.zeros((0, 8, 3)))
refused("backward: expected transmission or path_lengths, found neither", image.backward)
refused("transmission: expected 10 x 20 values, found 3", image.backward, [1, 2, 3])
refused("count: expected 1 to 100000, found 0", mr.turn, scene, 0)
refused("axis: expected x, y, z or three numbers, found 'w'", mr.turn, scene, 3, axis="w")
refused("expected auto, ray-tracing or rasterisation", mr.Projector, "fast")
refused("what: expected transmission, display", image.save, "x.png", "lengths")
try:
    mr.Projector(device="no such device").expose(scene)
    raise AssertionError("not refused: device")
except mr.DeviceError as error:
    assert "no such device" in str(error)
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "table.json")
    with open(path, "w", encoding="utf-8") as file:
        file.write('{ "materials": [ { "name": "air", "labels": [0] }, { "name": "fat" } ] }')
    several = scene_of(materials=[0.05])
    several.materials = path
    refused("table.json", several.expose)
    # STL in binary and in text: the same box.
    facets = numpy.zeros(12, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    facets["corners"] = POINTS[TRIANGLES]
    binary, text = os.path.join(folder, "binary.stl"), os.path.join(folder, "text.stl")
    with open(binary, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", 12) + facets.tobytes())
    with open(text, "w", encoding="utf-8") as file:
        file.write("solid box\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x:g} {y:g} {z:g}\n" for x, y, z in facet)
                                           + "endloop\nendfacet\n" for facet in POINTS[TRIANGLES]) + "endsolid box\n")
    for path in (binary, text):
        read = mr.read_mesh(path)
        assert read.points.shape == (8, 3) and read.cells.shape == (12, 3) and read.file == path
        scene.samples = mr.Sample(read, 0.05)
        assert numpy.allclose(scene.expose().path_lengths, image.path_lengths, rtol=0, atol=1e-5)
    facets["corners"] /= 1000  # the box in metres
    metres = os.path.join(folder, "metres.stl")
    with open(metres, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", 12) + facets.tobytes())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        mr.read_mesh(metres)
        assert len(caught) == 1 and "metres.stl: 0.08 mm across" in str(caught[0].message), caught
        assert numpy.allclose(numpy.ptp(mr.read_mesh(metres, unit="m").points, axis=0), (80, 60, 20)) and len(caught) == 1
    with open(binary, "r+b") as file:
        file.truncate(300)
    refused("binary.stl", mr.read_mesh, binary)
    refused("nowhere.stl", mr.read_mesh, os.path.join(folder, "nowhere.stl"))
    picture = os.path.join(folder, "picture.png")
    image.save(picture)
    with open(picture, "rb") as file:
        assert file.read() == data

assert "vtkmodules" not in sys.modules, "X-rays need no VTK"
assert mr.__version__.count(".") == 2
print(f"{mr.__file__}: {mr.__version__}, {mr.Projector().device}")
