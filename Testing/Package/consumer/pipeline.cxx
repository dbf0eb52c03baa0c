// SPDX-License-Identifier: Apache-2.0
// Labels to tetrahedra, between the plates, to an X-ray: four filters in a row. Exit 125: no Vulkan
// device or no Meshing module.
#include <mammoray/XRay/PathLengthProjector.h>

#include <mammoray/Filters/vtkBreastCompression.h>
#include <mammoray/Filters/vtkBreastMesher.h>
#include <mammoray/Filters/vtkXRayProjector.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <cmath>
#include <cstdio>

/// Half a ball of radius 30 mm in front of y = 0; label 2 to y = 6, then 1.
void FillLabels(vtkImageData* labels)
{
  labels->SetDimensions(34, 18, 34);
  labels->SetSpacing(2, 2, 2);
  labels->SetOrigin(-33, -3, -33);
  labels->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  for (vtkIdType id = 0; id < labels->GetNumberOfPoints(); ++id)
  {
    const double* p = labels->GetPoint(id);
    const bool inside = p[1] > 0 && std::hypot(p[0], p[1], p[2]) < 30;
    labels->GetPointData()->GetScalars()->SetTuple1(id, inside ? (p[1] < 6 ? 2 : 1) : 0);
  }
}

int main()
{
  vtkNew<vtkImageData> labels;
  FillLabels(labels);
  vtkNew<vtkBreastMesher> mesher;
  mesher->SetInputData(labels);
  mesher->SetCellSizeMm(10);
  vtkNew<vtkBreastCompression> compression;
  compression->SetInputConnection(mesher->GetOutputPort());
  compression->SetOrientation("LAS");
  compression->SetMaterial(1, 6, 0.49, false);
  compression->SetMaterial(2, 6, 0.49, true);
  compression->SetElementToLinear();
  compression->SetThicknessMm(45);
  vtkNew<vtkXRayProjector> projector;
  projector->SetInputConnection(compression->GetOutputPort());
  projector->SetSourcePosition(0, 6, 600);
  projector->SetDetectorOrigin(0, 9, -40);
  projector->SetDetectorSize(1, 1);
  projector->SetKey("attenuations.1", "0.05/mm");
  projector->SetKey("attenuations.2", "0.08/mm");
  std::string reason;
  mesher->Update();
  if (mammoray::ListDevices(&reason).empty() || mesher->GetOutput()->GetNumberOfCells() == 0)
  {
    std::printf("skipped: no Meshing module, or %s\n", reason.c_str());
    return 125;
  }
  projector->Update();
  vtkDataArray* lengths = projector->GetOutput()->GetPointData()->GetArray("PathLength_1");
  const double found = lengths ? lengths->GetComponent(0, 0) : 0;
  std::printf("path length between plates of 45 mm: %.2f mm\n", found);
  // From plate to plate, a little slanted; a coarse mesh's facets stay within a millimetre.
  return std::abs(found - 45) < 1.5 ? 0 : 1;
}
