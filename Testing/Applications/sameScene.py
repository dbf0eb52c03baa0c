# SPDX-License-Identifier: Apache-2.0
"""The scene of TestSameScene.cxx by mammoray.load_scene (argument: file), once more of what it saves, or of arrays in this folder;
or as mammograms (argument: dicom)."""
import sys

import mammoray as mr
import numpy

if sys.argv[1:] == ["dicom"]:
    scene = mr.load_scene("scene.json")
    scene.expose().save("placed.dcm", side="left", view="CC", for_processing=True, patient_name="Phantom^Body", patient_id="7")
    scene = mr.Scene(mr.read_mesh("body.vtp"), materials="table.json", beam=mr.Beam(kev=20),
                     detector=mr.Detector(columns=41, rows=33, pixel_spacing=1.75))
    scene.place_unit("LAS", thickness=40, side="right")
    image = scene.expose()
    image.save("unit.dcm")
    try:
        mr.Scene(scene.samples, materials="table.json").expose().save("none.dcm")
        raise AssertionError("no side")
    except mr.InputError as error:
        assert "none.dcm: expected side" in str(error), error
    try:
        image.save("none.dcm", side="top")
        raise AssertionError("another side")
    except mr.InputError as error:
        assert "side: expected left or right, found 'top'" in str(error), error
    sys.exit()
if sys.argv[1:] == ["file"]:
    mr.load_scene("scene.json").save("saved.json")
    scene = mr.load_scene("saved.json")
else:
    place = numpy.fromfile("place")
    columns, rows, samples, photons, seed, bends, distance = place[12:]
    mesh = mr.Mesh(numpy.fromfile("points").reshape(-1, 3), numpy.fromfile("triangles").reshape(-1, 3),
                   numpy.fromfile("sides").reshape(-1, 2))
    scene = mr.Scene(
        mesh, materials="table.json", source=mr.Source(place[0:3]), beam=mr.Beam(spectrum="W28kVp_Rh50um_Be1mm"),
        detector=mr.Detector(place[3:6], place[6:9], place[9:12], int(columns), int(rows), numpy.linalg.norm(place[6:9]), int(samples),
                             photons=photons, seed=int(seed)),
        refraction=mr.Refraction("geometric", distance) if bends else None)
image = scene.expose()
image.transmission.tofile("transmission")
image.path_lengths[1:].tofile("lengths")
