// SPDX-License-Identifier: Apache-2.0
// A stranger's use of the installed package: projects a box and checks one pixel against its closed
// form. Exit 125: no Vulkan device.
#include <mammoray/XRay/PathLengthProjector.h>

#include <mammoray/Filters/vtkXRayProjector.h>
#include <vtkCubeSource.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkTriangleFilter.h>

#include <cmath>
#include <cstdio>

int main()
{
  std::string reason;
  if (mammoray::ListDevices(&reason).empty())
  {
    std::printf("skipped: %s\n", reason.c_str());
    return 125;
  }
  vtkNew<vtkCubeSource> box;
  box->SetBounds(-40, 40, -30, 30, 10, 30);
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputConnection(box->GetOutputPort());

  vtkNew<vtkXRayProjector> projector;
  projector->SetInputConnection(triangles->GetOutputPort());
  projector->SetSourcePosition(0, 0, 400);
  projector->SetDetectorOrigin(3, 4, 0);
  projector->SetDetectorSize(1, 1);
  projector->SetKey("attenuations.1", "0.05/mm");
  projector->Update();

  vtkDataArray* lengths = projector->GetOutput()->GetPointData()->GetArray("PathLength_1");
  const double found = lengths ? lengths->GetComponent(0, 0) : 0;
  const double expected = 20 * std::sqrt(3.0 * 3 + 4 * 4 + 400 * 400) / 400;
  std::printf("path length %.6f mm, expected %.6f mm\n", found, expected);
  return std::abs(found - expected) < 1e-5 ? 0 : 1; // a float of size 20
}
