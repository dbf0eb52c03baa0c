# SPDX-License-Identifier: Apache-2.0
"""Read by mypy only (testTypes.py): what is right and, where a line is marked, what is wrong."""
import mammoray
import numpy

scene = mammoray.Scene(mammoray.Sample(mammoray.Mesh(numpy.zeros((3, 3)), [(0, 1, 2)]), 0.05), source=mammoray.Source((0, 0, 1)),
                       detector=mammoray.Detector((0, 0, 0), (1, 0, 0), (0, 1, 0), 1, 1), beam=mammoray.Beam(tube="W", kvp=30, filters=["Al:1"]))
image = scene.expose()
pixels: numpy.ndarray = image.transmission
thickness: float = mammoray.compress([(0, 0, 0)], [(0, 0, 0, 0)], [1], materials="victre").thickness
mammoray.vtkXRayProjector().SetSourceToDetectorMm(600)
mammoray.Beam(tube="W", kpv=30)  # wrong: a name
mammoray.compress([(0, 0, 0)], [(0, 0, 0, 0)], [1], materials="victre", thicknes=3)  # wrong: a name
mammoray.vtkXRayProjector().SetSourceToDetectorMm("three")  # wrong: a type
name: int = mammoray.__version__  # wrong: a type
