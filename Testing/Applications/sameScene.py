# SPDX-License-Identifier: Apache-2.0
"""The scene of TestSameScene.cxx by mammoray.project_scene (argument: file), or, of arrays in this folder, by mammoray.project."""
import sys

import mammoray
import numpy

if sys.argv[1:] == ["file"]:
    image = mammoray.project_scene("scene.json")
    image.transmission.tofile("transmission")
    image.path_lengths[1:].tofile("lengths")
    sys.exit()
place = numpy.fromfile("place")
columns, rows, samples, photons, seed, bends, distance = place[12:]
image = mammoray.project(
    numpy.fromfile("points").reshape(-1, 3), numpy.fromfile("triangles").reshape(-1, 3),
    numpy.fromfile("sides").reshape(-1, 2), materials="table.json", source=place[0:3],
    detector=mammoray.Detector(place[3:6], place[6:9], place[9:12], int(columns), int(rows), int(samples)),
    spectrum="W28kVp_Rh50um_Be1mm", photons_per_pixel=photons, seed=int(seed),
    refraction="geometric" if bends else None, bend_distance=distance)
image.transmission.tofile("transmission")
image.path_lengths[1:].tofile("lengths")
