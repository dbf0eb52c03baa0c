# SPDX-License-Identifier: Apache-2.0
"""Ten thousand pictures leave nothing behind, and a call costs less than 0.2 ms beside the picture. Exit 125: no device."""
import gc
import resource
import sys
import time

import mammoray as mr
import numpy

CALLS = 10000
# 96 triangles: a plate of 4 x 4 cells with its rim.
grid = numpy.array([(x, y, z) for z in (20, 30) for y in range(-10, 11, 5) for x in range(-10, 11, 5)], dtype=float)


def quads():
    for j in range(4):
        for i in range(4):
            corner = 5 * j + i
            yield corner, corner + 5, corner + 6, corner + 1
            yield corner + 25, corner + 26, corner + 31, corner + 30
    for i in range(4):
        for first, second in ((i, i + 1), (5 * i + 9, 5 * i + 4)[::-1], (24 - i, 23 - i), (20 - 5 * i, 15 - 5 * i)):
            yield first, second, second + 25, first + 25


triangles = [corners for a, b, c, d in quads() for corners in ((a, b, c), (a, c, d))]
mesh = mr.Mesh(grid, triangles)
scene = mr.Scene(mr.Sample(mesh, "Al"), source=mr.Source((0, 0, 400)), beam=mr.Beam(kev=30),
                 detector=mr.Detector((-2, -2, 0), (1, 0, 0), (0, 1, 0), 5, 5, 1))
try:
    image = scene.expose()
except mr.DeviceError as error:
    print(error)
    sys.exit(125)
assert len(triangles) == 96 and image.consistency.all() and abs(image.path_lengths[1, 2, 2] - 10) < 1e-5


def memory():
    gc.collect()
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def cost(change, calls, call=scene.expose):
    begin = time.perf_counter()
    for number in range(calls):
        change(number)
        call()
    return 1000 * (time.perf_counter() - begin) / calls


def move(number):
    mesh.points = grid + (0, 0, 1e-3 * (number % 7))


def other_beam(number):
    scene.beam.kev = 30 + number % 5


kinds = {"unchanged": lambda number: None, "moved": move, "another beam": other_beam}
for change in kinds.values():
    cost(change, 200)  # what is allocated once
# Time of a call on the host: nothing is traced but for moved points, whose way to the device is all that counts here. The best
# of ten: the machine may be busy.
overheads = {name: min(cost(change, 50, scene._native if name == "moved" else scene.expose) for _ in range(10))
             for name, change in kinds.items()}
before = memory()
shares = {"unchanged": 0.8, "moved": 0.1, "another beam": 0.1}
costs = {name: cost(change, int(shares[name] * CALLS)) for name, change in kinds.items()}
grown = memory() - before
print(", ".join(f"{name}: {ms:.3f} ms" for name, ms in costs.items()), f"a call; {grown / 1024:.0f} kB more after {CALLS}")
print("overhead:", ", ".join(f"{name}: {ms:.3f} ms" for name, ms in overheads.items()))
assert max(overheads.values()) < 0.2, overheads
# A leak of 100 bytes a call would be 1 MB.
assert grown < 1e6, f"{grown} bytes more after {CALLS} calls"
