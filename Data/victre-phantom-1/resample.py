#!/usr/bin/env python3
"""Makes labels.nrrd from the FDA's p_1.raw.gz: 0.2 mm voxels to 0.4 mm by majority vote of 2 x 2 x 2.

Usage: resample.py p_1.raw.gz labels.nrrd

Ties go to one of the tied labels by the parity of the voxel's position, so that no tissue grows at the cost of
another.
"""
import gzip
import sys

import numpy as np

SIZE = (374, 448, 449)  # x, y, z
SPACING = 0.2
ORIGIN = (-9.4, -36.0534, -45.1184)

source, target = sys.argv[1:]
fine = np.frombuffer(gzip.open(source).read(), np.uint8).reshape(SIZE[::-1])
fine = np.pad(fine, [(0, size % 2) for size in SIZE[::-1]])
nz, ny, nx = (n // 2 for n in fine.shape)
votes = fine.reshape(nz, 2, ny, 2, nx, 2).transpose(0, 2, 4, 1, 3, 5).reshape(nz, ny, nx, 8)
coarse = np.empty((nz, ny, nx), np.uint8)
for z in range(nz):
    labels = np.unique(votes[z])
    counts = np.stack([(votes[z] == label).sum(-1) for label in labels], -1)
    tied = counts == counts.max(-1, keepdims=True)
    parity = (z + np.arange(ny)[:, None] + np.arange(nx)) % 2
    first = tied.argmax(-1)
    last = len(labels) - 1 - tied[..., ::-1].argmax(-1)
    coarse[z] = labels[np.where(parity == 0, first, last)]
origin = [o + 0.5 * SPACING for o in ORIGIN]
step = 2 * SPACING
header = f"""NRRD0004
# FDA VICTRE phantom 1, CC0; 2 x 2 x 2 majority of p_1.raw.gz
type: uint8
dimension: 3
sizes: {nx} {ny} {nz}
space: 3D-right-handed
space directions: ({step},0,0) (0,{step},0) (0,0,{step})
space origin: ({origin[0]:.4f},{origin[1]:.4f},{origin[2]:.4f})
kinds: domain domain domain
encoding: gzip

"""
with open(target, "wb") as file:
    file.write(header.encode())
    file.write(gzip.compress(coarse.tobytes(), 9, mtime=0))
