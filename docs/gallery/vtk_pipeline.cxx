// SPDX-License-Identifier: Apache-2.0
// A source of VTK, the projector, and VTK's own filters behind it. usage: vtk_pipeline FOLDER
#include <mammoray/Filters/vtkXRayProjector.h>
#include <mammoray/XRay/PathLengthProjector.h>

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkImageShiftScale.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>
#include <vtkSuperquadricSource.h>
#include <vtkTriangleFilter.h>

#include <cmath>
#include <cstdio>
#include <string>

int main(int, char** arguments)
{
  if (mammoray::ListDevices().empty())
  {
    return 125; // no Vulkan device
  }
  vtkNew<vtkSuperquadricSource> ring;
  ring->ToroidalOn();
  ring->SetSize(30);
  ring->SetThickness(0.4);
  ring->SetPhiResolution(64);
  ring->SetThetaResolution(128);
  ring->SetAxisOfSymmetry(2);
  vtkNew<vtkTriangleFilter> triangles; // the source makes strips
  triangles->SetInputConnection(ring->GetOutputPort());
  vtkNew<vtkXRayProjector> projector;
  projector->SetInputConnection(triangles->GetOutputPort());
  projector->SetSourcePosition(0, -300, 520);
  projector->SetDetectorOrigin(-40, -5, -60);
  projector->SetPixelSpacing(0.25, 0.25);
  projector->SetDetectorSize(320, 320);
  projector->SetKey("attenuations.1", "PMMA");
  projector->SetKey("beam.kev", "20");

  vtkNew<vtkImageShiftScale> grey;
  grey->SetInputConnection(projector->GetOutputPort());
  grey->SetScale(255);
  grey->SetOutputScalarTypeToUnsignedChar();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(grey->GetOutputPort());
  writer->SetFileName((std::string(arguments[1]) + "/vtk_pipeline.png").c_str());
  writer->Write();

  double range[2];
  projector->GetOutput()->GetPointData()->GetScalars()->GetRange(range);
  std::printf("transmission %.3f to %.3f\n", range[0], range[1]);
  return range[0] < 0.8 && range[1] == 1 ? 0 : 1;
}
