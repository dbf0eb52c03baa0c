// SPDX-License-Identifier: Apache-2.0
#include "Private/PicturePane.h"

#include "Private/SceneShapes.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkProperty.h"

#include <algorithm>

namespace mammoray
{
PicturePane::PicturePane()
  : Over(this->View)
{
  this->View->SetBackground(0, 0, 0);
}

vtkSmartPointer<vtkTexture> PicturePane::NewTexture()
{
  auto texture = vtkSmartPointer<vtkTexture>::New();
  texture->SetInputData(this->Image);
  texture->SetColorModeToDirectScalars();
  texture->InterpolateOn();
  // Else the interpolation at one edge mixes in the other, the chest wall beside the air.
  texture->RepeatOff();
  texture->EdgeClampOn();
  return texture;
}

void PicturePane::AddRectangle(const std::array<Vector3, 4>& corners)
{
  const auto rectangle = NewPictureRectangle();
  for (vtkIdType corner = 0; corner < 4; ++corner)
  {
    rectangle->GetPoints()->SetPoint(corner, corners[static_cast<std::size_t>(corner)].data());
  }
  const auto actor = AddActor(this->View, rectangle, { 1, 1, 1 }, 1);
  actor->GetProperty()->LightingOff();
  actor->SetTexture(this->NewTexture());
}

unsigned char* PicturePane::GreyValues(int columns, int rows)
{
  const int* now = this->Image->GetDimensions();
  if (now[0] != columns || now[1] != rows)
  {
    this->Image->SetDimensions(columns, rows, 1);
    this->Image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  }
  this->Image->Modified();
  return static_cast<unsigned char*>(this->Image->GetScalarPointer());
}

void PicturePane::LookAt(const Vector3& middle, const Vector3& eye, const Vector3& up, double width,
  double height)
{
  vtkCamera* camera = this->View->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(middle.data());
  camera->SetPosition(eye.data());
  camera->SetViewUp(up.data());
  const double aspect = this->View->GetTiledAspectRatio();
  camera->SetParallelScale(0.5 * std::max(height, width / (aspect > 0 ? aspect : 1)));
  this->View->ResetCameraClippingRange();
}

void PicturePane::Adjust(double windowFactor, double levelShare)
{
  const double window = this->High - this->Low;
  const double level = 0.5 * (this->Low + this->High) + levelShare * window;
  this->Low = level - 0.5 * windowFactor * window;
  this->High = level + 0.5 * windowFactor * window;
  this->Compose();
}
}
