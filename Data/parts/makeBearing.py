#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes bearing.stl, a ball bearing of 20 mm bore, 47 mm outer diameter and 14 mm width, in mm.

usage: makeBearing.py FOLDER

Two rings with grooves and eight balls: ten closed surfaces that do not touch each other. The axis is z.
"""
import math
import pathlib
import struct
import sys

PITCH, BALL, GROOVE = 16.75, 3.97, 4.1  # radii of the balls' circle, of a ball and of the grooves, mm
AROUND = 72  # steps around the axis


def revolved(profile, centre=(0.0, 0.0, 0.0)):
    """Triangles of a closed profile of (r, z), counterclockwise with r to the right, turned about the z axis."""
    def place(step, corner):
        angle, (r, z) = 2 * math.pi * (step % AROUND) / AROUND, profile[corner % len(profile)]
        return (centre[0] + r * math.cos(angle), centre[1] + r * math.sin(angle), centre[2] + z)

    for step in range(AROUND):
        for corner in range(len(profile)):
            a, b = place(step, corner), place(step + 1, corner)
            c, d = place(step + 1, corner + 1), place(step, corner + 1)
            yield a, b, c
            yield a, c, d


def groove(shoulder, outwards):
    """Points of a groove about the pitch circle, from z < 0 to z > 0."""
    half = math.asin(math.sqrt(GROOVE**2 - (shoulder - PITCH)**2) / GROOVE)
    sign = 1 if outwards else -1
    return [(PITCH + sign * GROOVE * math.cos(t), GROOVE * math.sin(t)) for t in (half * (n / 8 - 1) for n in range(17))]


def ball(centre, steps=12):
    """Triangles of a sphere, whose poles are one point each."""
    def place(row, column):
        polar, around = math.pi * row / steps, math.pi * (column % (2 * steps)) / steps
        ring = 0.0 if row in (0, steps) else BALL * math.sin(polar)
        return (centre[0] + ring * math.cos(around), centre[1] + ring * math.sin(around), centre[2] + BALL * math.cos(polar))

    for row in range(steps):
        for column in range(2 * steps):
            if row > 0:
                yield place(row, column), place(row + 1, column), place(row, column + 1)
            if row < steps - 1:
                yield place(row, column + 1), place(row + 1, column), place(row + 1, column + 1)


def main():
    outer = [(23.5, -7.0), (23.5, 7.0), (19.0, 7.0)] + groove(19.0, True)[::-1] + [(19.0, -7.0)]
    inner = [(10.0, 7.0), (10.0, -7.0), (14.5, -7.0)] + groove(14.5, False) + [(14.5, 7.0)]
    triangles = list(revolved(outer)) + list(revolved(inner))
    for number in range(8):
        angle = 2 * math.pi * (number + 0.5) / 8
        triangles += ball((PITCH * math.cos(angle), PITCH * math.sin(angle), 0.0))
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in triangles)
    header = b"Ball bearing, made by makeBearing.py of MammoRay, CC0".ljust(80)
    (pathlib.Path(sys.argv[1]) / "bearing.stl").write_bytes(header + struct.pack("<I", len(triangles)) + records)


main()
