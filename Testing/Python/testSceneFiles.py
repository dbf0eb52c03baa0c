# SPDX-License-Identifier: Apache-2.0
"""Meshes of VTK's objects; files of scenes, pictures and series. Exit 125: no device."""
import json
import os
import sys
import tempfile

import mammoray as mr
import numpy
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkIOGeometry import vtkSTLWriter

if not mr.devices():
    print("no Vulkan device")
    sys.exit(125)
box = vtkCubeSource()
box.SetBounds(-40, 40, -30, 30, 10, 30)
triangles = vtkTriangleFilter()
triangles.SetInputConnection(box.GetOutputPort())
triangles.Update()

scene = mr.Scene(mr.Sample(mr.read_mesh(triangles.GetOutput()), 0.05), source=mr.Source((0, 0, 400)),
                 detector=mr.Detector((-9.5, -4.5, 0), (1, 0, 0), (0, 1, 0), 20, 10, 1))
picture = scene.expose()
oblique = numpy.sqrt((numpy.arange(20) - 9.5)**2 + (numpy.arange(10)[:, None] - 4.5)**2 + 400**2) / 400
assert numpy.allclose(picture.path_lengths[1], 20 * oblique, rtol=0, atol=1e-5)  # floats of 20 mm
points = numpy.array([(0, 0, 10), (30, 0, 10), (0, 30, 10), (8, 8, 40), (8, 8, 5)], dtype=float) - [10, 10, 0]
body = mr.Mesh(points, [(0, 1, 2, 3), (0, 2, 1, 4)], [1, 2])
sides = mr.Mesh(points, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 1, 4), (1, 2, 4), (2, 0, 4)],
                [(2, 1), (0, 1), (0, 1), (0, 1), (2, 0), (2, 0), (2, 0)])
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    # Saved meshes load alike: one region (.ply), two sides (.vtp), tetrahedra (.vtu), a file that is there (.stl).
    stl = os.path.join(folder, "box.stl")
    writer = vtkSTLWriter()
    writer.SetFileName(stl)
    writer.SetInputConnection(triangles.GetOutputPort())
    writer.Write()
    two = [mr.Material("adipose", name="fat", youngs_modulus=3), mr.Material("H2O", density=1.05, iodine=2)]
    for number, (samples, materials) in enumerate((
            (mr.Sample(mr.read_mesh(triangles.GetOutput()), "Al", (0, 1, 0), 20, (1, 2, 3)), None), (sides, two), (body, two),
            (mr.Sample(mr.read_mesh(stl, "cm"), mr.Material("SiO2", density=2.2, name="glass"), translation=(0, 0, 20)), None))):
        scene.samples, scene.materials = samples, materials
        scene.detector.photons = 1e4
        scene.beam = mr.Beam(energies=[20, 30], photons=[2, 1], filters=["Al:0.5"])
        scene.save("scene.json")
        again = mr.load_scene("scene.json")
        assert (again.expose().transmission == scene.expose().transmission).all(), number
        assert again.expose().materials == scene.expose().materials, number
        again.save("again.json")
        assert numpy.array_equal(mr.load_scene("again.json").expose().path_lengths, scene.expose().path_lengths), number
    assert os.path.exists("scene-0.ply") and os.path.exists("scene-0.vtp") and os.path.exists("scene-0.vtu")
    assert again.samples[0].mesh.file == stl and numpy.allclose(again.samples[0].mesh.points.max(axis=0), (400, 300, 300))
    # A scene that is placed around its samples stays where it is.
    around = mr.Scene(mr.Sample(sides, None), materials=two)
    around.save("around.json")
    assert (mr.load_scene("around.json").expose().transmission == around.expose().transmission).all()
    # Pictures: floats with their channels, 16 bits.
    picture.save("picture.mha")
    picture.save("lengths.mha", "path lengths")
    picture.save("picture.png")
    assert (numpy.fromfile("picture.mha", numpy.float32)[-200:].reshape(10, 20) == picture.transmission).all()
    assert (numpy.fromfile("lengths.mha", numpy.float32)[-200:].reshape(10, 20) == picture.path_lengths[1]).all()
    series = mr.turn(around, 3, axis_point=(0, 0, 10))
    series.save("scan.mha", flat_fields=2)
    assert (numpy.fromfile("scan.mha", numpy.float32)[-3 * 512 * 512:].reshape(3, 512, 512) == numpy.asarray(series)).all()
    assert os.path.exists("scan_flat.mha")
    with open("scan.json", encoding="utf-8") as file:
        described = json.load(file)
    assert described["kind"] == "turn" and [each["angleDeg"] for each in described["projections"]] == [0, 120, 240]
    for call, expected in ((lambda: picture.save("x.png", "path lengths"), "expected .mha"), (lambda: picture.save("x.gif"), "x.gif"),
                           (lambda: mr.read_mesh("x.abc"), "x.abc"), (lambda: mr.load_scene("x.json"), "x.json"),
                           (lambda: mr.read_mesh(vtkUnstructuredGrid()), "mesh: expected points")):
        try:
            call()
            raise AssertionError(f"not refused: {expected}")
        except mr.InputError as error:
            assert expected in str(error) and "\n" not in str(error), error
    os.chdir("/")
print("files as expected")
