#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes lesion.nrrd: a ball of 4 mm about (30, 12, -10) in the phantom's frame, on the grid of its labels, for `mammoray locate`.

Usage: makeLesion.py lesion.nrrd
"""
import gzip
import math
import sys

CENTRE, RADIUS = (30.0, 12.0, -10.0), 4.0
SPACING, ORIGIN = 0.4, (-9.3, -35.9534, -45.0184)

# The voxels around it only, 1 mm to spare.
first = [math.floor((c - RADIUS - 1 - o) / SPACING) for c, o in zip(CENTRE, ORIGIN)]
size = [math.ceil((c + RADIUS + 1 - o) / SPACING) - f for c, o, f in zip(CENTRE, ORIGIN, first)]
origin = [o + f * SPACING for o, f in zip(ORIGIN, first)]
voxels = bytes(
    math.dist([o + index * SPACING for o, index in zip(origin, (i, j, k))], CENTRE) <= RADIUS
    for k in range(size[2]) for j in range(size[1]) for i in range(size[0]))
header = f"""NRRD0004
# a ball of {RADIUS:g} mm in FDA VICTRE phantom 1, CC0; makeLesion.py
type: uint8
dimension: 3
sizes: {size[0]} {size[1]} {size[2]}
space: 3D-right-handed
space directions: ({SPACING},0,0) (0,{SPACING},0) (0,0,{SPACING})
space origin: ({origin[0]:.4f},{origin[1]:.4f},{origin[2]:.4f})
kinds: domain domain domain
encoding: gzip

"""
with open(sys.argv[1], "wb") as file:
    file.write(header.encode() + gzip.compress(voxels, mtime=0))
