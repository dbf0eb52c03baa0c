# SPDX-License-Identifier: Apache-2.0
"""A state file opens as it should: nothing is complained of, every source has data, something is shown.

testState.py STATE.pvsm PICTURE.png: in pvpython. In ParaView's window (paraview --script=testState.py, as testWindow.sh does): the two words
in MAMMORAY_STATE_TEST. PICTURE.png.txt receives what was found, "as expected" at its end."""
import os
import sys

from paraview import simple
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.util.numpy_support import vtk_to_numpy

state, picture = os.environ.get("MAMMORAY_STATE_TEST", "").split() or sys.argv[1:3]
complaints = []
for event in ("ErrorEvent", "WarningEvent"):
    vtkOutputWindow.GetInstance().AddObserver(event, lambda window, name: complaints.append(name))
report = [f"{state}:"]
try:
    simple.LoadState(state)
    view = simple.GetActiveView()
    simple.Render(view)
    simple.SaveScreenshot(picture, view, ImageResolution=[900, 600])
    for (name, _), source in simple.GetSources().items():
        source.UpdatePipeline()
        cells = source.GetDataInformation().GetNumberOfCells()
        report.append(f"{name}: {cells} cells")
        if cells == 0:
            complaints.append(f"{name} is empty")
    reader = vtkPNGReader()
    reader.SetFileName(picture)
    reader.Update()
    if vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).std() < 20:
        complaints.append("nothing is shown")
    if len(report) < 2:
        complaints.append("no sources")
except Exception as error:  # told like the others: in the window nobody reads a traceback
    complaints.append(repr(error))
report.append("as expected" if not complaints else f"expected no complaints, found {complaints}")
with open(picture + ".partial", "w", encoding="utf-8") as file:
    file.write("\n".join(report) + "\n")
os.replace(picture + ".partial", picture + ".txt")
print("\n".join(report))
if "MAMMORAY_STATE_TEST" not in os.environ and complaints:
    sys.exit(1)
