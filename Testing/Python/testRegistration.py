# SPDX-License-Identifier: Apache-2.0
"""A breast is compressed and X-rayed; its mammogram then tells where the receptor stood. Exit 125: no device."""
import math
import sys
import tempfile

import mammoray
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIntArray, vtkLogger, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkImageData

from pipeline import TABLE, field, half_ball_labels, image, stop_on_error

THICKNESS = 52.0
SHIFT = 3.0
labels, origin = half_ball_labels()
with tempfile.NamedTemporaryFile("w", suffix=".json") as table:
    table.write(TABLE)
    table.flush()
    mesher = stop_on_error(mammoray.vtkBreastMesher())
    mesher.SetInputData(image(labels, origin, 2.0))
    mesher.SetMaterialTable(table.name)
    mesher.SetCellSizeMm(8)
    coarse = stop_on_error(mammoray.vtkBreastMesher())
    coarse.SetInputData(mesher.GetInput())
    coarse.SetMaterialTable(table.name)
    coarse.ForMechanicsOn()
    coarse.SetCellSizeMm(11)
    compression = stop_on_error(mammoray.vtkBreastCompression())
    compression.SetInputConnection(coarse.GetOutputPort())
    compression.SetMaterialTable(table.name)
    compression.SetOrientation("LAS")
    compression.SetThicknessMm(THICKNESS)

    # A receptor 27 mm below the middle of the plates, its edge at the front of the chest wall (y = 6).
    projector = mammoray.vtkXRayProjector()
    projector.SetInputConnection(compression.GetOutputPort())
    projector.SetSourcePosition(SHIFT, 6, 650 - THICKNESS / 2 - 2)
    projector.SetDetectorOrigin(SHIFT + 44.75, 6.25, -THICKNESS / 2 - 2)
    projector.SetColumnDirection(0, 1, 0)
    projector.SetRowDirection(-1, 0, 0)
    projector.SetPixelSpacing(0.5, 0.5)
    projector.SetDetectorSize(90, 180)
    for index, name, density in ((1, "adipose", 0.92), (2, "glandular", 1.03), (3, "muscle", 1.05)):
        projector.SetAttenuationTable(index, name, density)
    compression.Update()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    projector.Update()
    transmission = projector.GetOutput().GetPointData().GetArray("Transmission")
    if transmission is None:
        print("no projection: no device; see mammoray devices")
        sys.exit(125)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_WARNING)

    # As vtkMammogramReader gives it: the first row of the picture is the last of the image.
    pixels = 10000 * vtk_to_numpy(transmission).reshape(180, 90)[::-1]
    mammogram = vtkImageData()
    mammogram.SetDimensions(90, 180, 1)
    mammogram.SetSpacing(0.5, 0.5, 1)
    mammogram.GetPointData().SetScalars(numpy_to_vtk(pixels.ravel(), deep=True))
    for name, text in (("View", "CC"), ("Laterality", "L"), ("RowDirection", "A"), ("ColumnDirection", "R"),
                       ("PresentationIntent", "FOR PROCESSING")):
        array = vtkStringArray()
        array.SetName(name)
        array.InsertNextValue(text)
        mammogram.GetFieldData().AddArray(array)
    sign = vtkIntArray()
    sign.SetName("IntensitySign")
    sign.InsertNextValue(1)  # larger values mean more X-ray behind the breast
    mammogram.GetFieldData().AddArray(sign)

    registration = stop_on_error(mammoray.vtkBreastRegistration())
    registration.SetInputConnection(mesher.GetOutputPort())
    registration.SetInputData(1, mammogram)
    registration.SetSimulationMeshConnection(coarse.GetOutputPort())
    registration.SetMaterialTable(table.name)
    registration.SetOrientation("LAS")
    registration.SetFreeParameters("lateral")
    registration.SetStartThicknessMm(THICKNESS)
    registration.SetStartAnteriorMm(0)
    registration.Update()
    result = registration.GetOutput()
    lateral, deviation = field(result, "Parameters")[4], field(result, "ParameterDeviations")[4]
    covariance = field(result, "Covariance")
    assert covariance.shape == (9, 9) and math.isclose(covariance[4, 4], deviation ** 2, rel_tol=1e-9)
    # Half a pixel of the finer comparison: the anatomy's skin is not quite the coarse mesh's.
    assert abs(lateral - SHIFT) < 0.75, lateral
print(f"receptor {lateral:.2f} +- {deviation:.2f} mm aside, was {SHIFT:.2f} mm")
