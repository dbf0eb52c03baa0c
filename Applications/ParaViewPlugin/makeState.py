# SPDX-License-Identifier: Apache-2.0
"""Writes a state file that shows the filters at work on the shipped phantom: labels, breast at rest and between the plates, X-ray.

makeState.py STATE.pvsm LABELS.nrrd"""
import os
import sys

from paraview import simple

# One colour each, as in openResult.py.
REST, SQUEEZED = [0.9, 0.75, 0.65], [0.6, 0.75, 0.95]


def plain(source, view, color, opacity):
    display = simple.Show(source, view)
    display.Representation = "Surface"
    display.ColorArrayName = ["POINTS", ""]
    display.DiffuseColor = display.AmbientColor = color
    display.Opacity = opacity


def build(path):
    """The pipeline, in a view of its own."""
    view = simple.GetActiveViewOrCreate("RenderView")
    labels = simple.OpenDataFile(path)
    simple.RenameSource("labels of the phantom", labels)
    anatomy = simple.BreastMesher(registrationName="breast", Input=labels, LabelSpacingMm=1.5, CellSizeMm=8)
    coarse = simple.BreastMesher(registrationName="mesh for the mechanics", Input=labels, CellSizeMm=12, ForMechanics=1)
    squeezed = simple.BreastCompression(registrationName="between the plates", Input=anatomy, SimulationMesh=coarse, Orientation="ALS",
                                        ThicknessMm=55, AnteriorMm=7)
    xray = simple.XrayProjector(registrationName="X-ray", Input=squeezed, PixelSpacing=[0.5, 0.5], DetectorSize=[200, 280])
    plain(anatomy, view, REST, 0.25)
    plain(squeezed, view, SQUEEZED, 0.35)
    display = simple.Show(xray, view)
    display.Representation = "Slice"
    simple.ColorBy(display, ("POINTS", "LogAttenuation"))
    simple.GetColorTransferFunction("LogAttenuation").ApplyPreset("Grayscale", True)
    display.RescaleTransferFunctionToDataRange(False, True)
    # From the front (+x: anterior), a little from the side and above; the receptor lies below.
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [420, -350, 260], [0, 0, 0], [0, 0, 1]
    simple.ResetCamera(view)
    return view


build(os.path.abspath(sys.argv[2]))
simple.SaveState(sys.argv[1])
