#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of docs/correct.md: correct/before.png, correct/after.png and correct/changed.png.

usage: drawCorrection.py BIN-FOLDER DOCS-FOLDER

BIN-FOLDER: where mammoray and mammoray-validate are. The breast is the shipped phantom in a virtual study. What is wrong in it, this
script has made wrong: a ball of gland is called fat; what the correction paints is what the segmentation had found.
"""
import gzip
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (after the choice of what draws)

STUDY = ["--mri-pixel", "1", "--mri-slice", "2", "--mammogram-pixel", "0.3", "--label-spacing", "1", "--anatomy-cell", "8",
         "--gravity-fineness", "5", "--compression-fineness", "7"]
REGISTER = ["--side", "left", "--anatomy-cell-size", "8", "--simulation-cell-size", "16", "--pixel-sizes", "6", "--iterations", "1",
            "--free", "thickness"]
TYPES = {"unsigned char": numpy.uint8, "uint8": numpy.uint8, "float": numpy.float32}
# As in 3D Slicer and in reports: Okabe and Ito's colours by number of the label.
COLOURS = {1: (230, 159, 0), 2: (86, 180, 233), 3: (0, 158, 115), 4: (240, 228, 66)}
NAMES = {1: "fat", 2: "gland", 3: "skin", 4: "chest wall"}


def read_nrrd(path):
    """Voxels (k, j, i), and the sizes of one along i, j and k, mm."""
    header, voxels = path.read_bytes().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.decode().splitlines() if ": " in line and ":=" not in line)
    size = [int(number) for number in fields["sizes"].split()]
    axes = [[float(number) for number in axis.strip("()").split(",")] for axis in fields["space directions"].split()]
    values = numpy.frombuffer(gzip.decompress(voxels), TYPES[fields["type"]]).reshape(size[::-1])
    return values, [float(numpy.linalg.norm(axis)) for axis in axes]


def draw(path, mri, labels, spacing, marked=None):
    """An axial slice, the chest wall below, with tissues in colour; or grey, with a part marked."""
    picture = numpy.repeat(numpy.clip(255 * mri / numpy.quantile(mri, 0.995), 0, 255)[:, :, None], 3, axis=2)
    if marked is None:
        for label, colour in COLOURS.items():
            picture[labels == label] = 0.55 * picture[labels == label] + 0.45 * numpy.array(colour)
    else:
        picture[marked] = (230, 25, 75)
    figure, axes = pyplot.subplots(figsize=(4.6, 3.4), dpi=100)
    axes.imshow(picture.astype(numpy.uint8), aspect=spacing[1] / spacing[0], interpolation="nearest")
    if marked is None:
        for label, colour in COLOURS.items():
            axes.plot([], [], "s", color=numpy.array(colour) / 255, label=NAMES[label])
        axes.legend(loc="upper right", fontsize=7, framealpha=0.9)
    axes.axis("off")
    figure.savefig(path, bbox_inches="tight", pad_inches=0.02)
    pyplot.close(figure)


def main():
    programs, docs = (pathlib.Path(argument) for argument in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as folder:
        study = pathlib.Path(folder) / "study"
        result = pathlib.Path(folder) / "result"
        subprocess.run([programs / "mammoray-validate", "study", *STUDY, "-o", study], check=True)
        subprocess.run([programs / "mammoray", "register", "--study", study / "export", *REGISTER, "-o", result], check=True)
        labels, spacing = read_nrrd(result / "labels.seg.nrrd")
        mri, _ = read_nrrd(result / "mri.nrrd")
    # The slice with most gland, and a ball in its gland's middle.
    k = int(numpy.argmax((labels == 2).sum(axis=(1, 2))))
    places = numpy.argwhere(labels[k] == 2)
    centre = places[numpy.argmin(numpy.abs(places - numpy.median(places, axis=0)).sum(axis=1))]
    rows, columns = numpy.indices(labels[k].shape)
    way = numpy.hypot((rows - centre[0]) * spacing[1], (columns - centre[1]) * spacing[0])
    wrong = (labels[k] == 2) & (way < 12)
    before = numpy.where(wrong, 1, labels[k])
    # Around the breast.
    tissue = numpy.argwhere(labels[k] != 0)
    low, high = numpy.maximum(tissue.min(axis=0) - 8, 0), tissue.max(axis=0) + 9
    cut = tuple(slice(first, last) for first, last in zip(low, high))
    pictures = docs / "correct"
    pictures.mkdir(exist_ok=True)
    draw(pictures / "before.png", mri[k][cut], before[cut], spacing)
    draw(pictures / "after.png", mri[k][cut], labels[k][cut], spacing)
    draw(pictures / "changed.png", mri[k][cut], labels[k][cut], spacing, wrong[cut])


if __name__ == "__main__":
    main()
