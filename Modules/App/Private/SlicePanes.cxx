// SPDX-License-Identifier: Apache-2.0
#include "Private/SlicePanes.h"

#include "mammoray/Foundation/Numbers.h"

#include "vtkCamera.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageProperty.h"
#include "vtkImageResliceMapper.h"
#include "vtkImageSlice.h"
#include "vtkImageStack.h"
#include "vtkLookupTable.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnsignedShortArray.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
constexpr double TissueOpacity = 0.28;
constexpr double LesionOpacity = 0.55;
/// Share of the voxels that are brighter than white at the beginning.
constexpr double WhiteShare = 0.995;
/// From the eye to the slice; the camera is parallel.
constexpr double EyeDistanceMm = 1000;
/// A mark is drawn in slices that are no farther from it.
constexpr double MarkedWithinMm = 0.51;

/// The voxels without a copy.
template <typename Array, typename Value>
vtkSmartPointer<vtkImageData> ImageOf(const VolumeGrid& grid, const std::vector<Value>& voxels)
{
  vtkNew<Array> array;
  array->SetArray(const_cast<Value*>(voxels.data()), static_cast<vtkIdType>(voxels.size()), 1);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(grid.Size[0], grid.Size[1], grid.Size[2]);
  image->SetSpacing(grid.Spacing[0], grid.Spacing[1], grid.Spacing[2]);
  image->GetPointData()->SetScalars(array);
  return image;
}

/// From the image without origin and turn to the volume frame.
vtkSmartPointer<vtkMatrix4x4> PlaceOf(const VolumeGrid& grid)
{
  auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
  for (int row = 0; row < 3; ++row)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      matrix->SetElement(row, axis, grid.Direction[axis][row]);
    }
    matrix->SetElement(row, 3, grid.Origin[row]);
  }
  return matrix;
}

double WhiteOf(const std::vector<float>& voxels)
{
  return std::max<double>(QuantileElement(voxels, WhiteShare), 1e-6);
}
}

SlicePanes::SlicePanes(const ViewedBreast& viewed, const std::vector<std::array<double, 3>>& colors)
  : Viewed(viewed)
  , Grid(viewed.Image ? static_cast<const VolumeGrid&>(*viewed.Image) : *viewed.Tissue)
{
  this->TissueColors = LabelProperty(colors, viewed.Image ? TissueOpacity : 1);
  this->LesionColors = LabelProperty({ { 0, 0, 0 }, { 1, 0.9, 0.2 } }, LesionOpacity);
  this->Grey = vtkSmartPointer<vtkImageProperty>::New();
  this->Grey->SetInterpolationTypeToLinear();
  const AnatomicalAxes& axes = viewed.Axes;
  const Vector3 back = -1.0 * axes.Anterior;
  const Vector3 right = -1.0 * axes.Left;
  const std::array<std::tuple<const char*, Vector3, Vector3>, Count> planes{ {
    { "axial, head", axes.Superior, axes.Anterior },
    { "coronal, front", back, axes.Superior },
    { "sagittal, left", right, axes.Superior },
  } };
  for (std::size_t index = 0; index < planes.size(); ++index)
  {
    Pane& pane = this->Panes[index];
    std::tie(pane.Name, pane.Along, pane.Up) = planes[index];
    pane.View = vtkSmartPointer<vtkRenderer>::New();
    pane.View->SetBackground(0, 0, 0);
    pane.Stack = vtkSmartPointer<vtkImageStack>::New();
    pane.View->AddViewProp(pane.Stack);
    pane.View->GetActiveCamera()->ParallelProjectionOn();
    pane.Over = std::make_unique<PaneOverlay>(pane.View);
    const auto letters = [&](const Vector3& direction)
    { return DirectionLetters(direction, axes); };
    const Vector3 across = Cross(pane.Along, pane.Up);
    pane.Over->SetLetters(
      { letters(-1.0 * across), letters(across), letters(pane.Up), letters(-1.0 * pane.Up) });
    // A step of the wheel is the voxel's edge that leads most along the normal.
    pane.StepMm = this->Grid.Spacing[this->Grid.AxisAlong(pane.Along)];
    this->AddVolume(pane);
  }
  this->ResetWindow();
  this->Frame();
}

SlicePanes::~SlicePanes() = default;

void SlicePanes::AddVolume(Pane& pane)
{
  if (this->Viewed.Image)
  {
    const auto image = ImageOf<vtkFloatArray>(*this->Viewed.Image, this->Viewed.Image->Voxels);
    this->AddSlice(pane, image, *this->Viewed.Image, this->Grey, 0);
  }
  if (this->Viewed.Tissue)
  {
    const auto tissue =
      ImageOf<vtkUnsignedShortArray>(*this->Viewed.Tissue, this->Viewed.Tissue->Voxels);
    this->TissueSlices.push_back(
      this->AddSlice(pane, tissue, *this->Viewed.Tissue, this->TissueColors, 1));
  }
  if (this->Viewed.Lesions)
  {
    const auto lesions =
      ImageOf<vtkUnsignedShortArray>(*this->Viewed.Lesions, this->Viewed.Lesions->Voxels);
    this->AddSlice(pane, lesions, *this->Viewed.Lesions, this->LesionColors, 2);
  }
}

vtkSmartPointer<vtkImageSlice> SlicePanes::AddSlice(Pane& pane, vtkImageData* data,
  const VolumeGrid& grid, vtkImageProperty* property, int layer)
{
  vtkNew<vtkImageResliceMapper> mapper;
  mapper->SetInputData(data);
  mapper->SliceFacesCameraOn();
  mapper->SliceAtFocalPointOn();
  mapper->BorderOn();
  auto slice = vtkSmartPointer<vtkImageSlice>::New();
  slice->SetMapper(mapper);
  vtkNew<vtkImageProperty> own;
  own->DeepCopy(property);
  slice->SetProperty(layer == 0 ? property : own.Get());
  slice->GetProperty()->SetLayerNumber(layer);
  slice->SetUserMatrix(PlaceOf(grid));
  pane.Stack->AddImage(slice);
  return slice;
}

/// Label 0 is looked through; labels beyond the colours have the last one.
vtkSmartPointer<vtkImageProperty> SlicePanes::LabelProperty(
  const std::vector<std::array<double, 3>>& colors, double opacity)
{
  vtkNew<vtkLookupTable> table;
  const auto count = static_cast<vtkIdType>(std::max<std::size_t>(colors.size(), 2));
  table->SetNumberOfTableValues(count);
  table->SetRange(-0.5, static_cast<double>(count) - 0.5);
  for (vtkIdType label = 0; label < count; ++label)
  {
    const auto& color = colors[std::min(static_cast<std::size_t>(label), colors.size() - 1)];
    table->SetTableValue(label, color[0], color[1], color[2], label == 0 ? 0 : 1);
  }
  auto property = vtkSmartPointer<vtkImageProperty>::New();
  property->SetInterpolationTypeToNearest();
  property->SetLookupTable(table);
  property->UseLookupTableScalarRangeOn();
  property->SetOpacity(opacity);
  return property;
}

Vector3 SlicePanes::Pane::Focal() const
{
  Vector3 focal;
  this->View->GetActiveCamera()->GetFocalPoint(focal.data());
  return focal;
}

void SlicePanes::Pane::LookThrough(const Vector3& focal)
{
  const Vector3 eye = focal - EyeDistanceMm * this->Along;
  this->View->GetActiveCamera()->SetFocalPoint(focal.data());
  this->View->GetActiveCamera()->SetPosition(eye.data());
}

void SlicePanes::Frame()
{
  constexpr double MarginMm = 12;
  for (Pane& pane : this->Panes)
  {
    const std::array<Vector3, 3> axes{ Cross(pane.Along, pane.Up), pane.Up, pane.Along };
    const std::array<Extent, 3> reach = ExtentsAlong(axes, this->Viewed.Anatomy.Points);
    Vector3 through{ 0, 0, 0 };
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const bool marked = axis == 2 && this->Point;
      const double at = marked ? Dot(*this->Point, pane.Along) : reach[axis].Middle();
      through = through + at * axes[axis];
    }
    pane.LookThrough(through);
    vtkCamera* camera = pane.View->GetActiveCamera();
    camera->SetViewUp(pane.Up.data());
    const double aspect = pane.View->GetTiledAspectRatio();
    camera->SetParallelScale(
      MarginMm + 0.5 * std::max(reach[1].Length(), reach[0].Length() / (aspect > 0 ? aspect : 1)));
    camera->SetClippingRange(1, 2 * EyeDistanceMm);
  }
}

void SlicePanes::SetMark(const std::optional<Vector3>& point,
  std::vector<std::vector<Vector3>> lines)
{
  this->Point = point;
  this->Lines = std::move(lines);
  for (Pane& pane : this->Panes)
  {
    if (!point)
    {
      continue;
    }
    const Vector3 focal = pane.Focal();
    pane.LookThrough(focal + Dot(*point - focal, pane.Along) * pane.Along);
  }
}

void SlicePanes::Scroll(int pane, int steps)
{
  Pane& scrolled = this->Panes[static_cast<std::size_t>(pane)];
  scrolled.LookThrough(scrolled.Focal() + steps * scrolled.StepMm * scrolled.Along);
}

void SlicePanes::Adjust(double windowFactor, double levelShare)
{
  this->Level += levelShare * this->Window;
  this->Window *= windowFactor;
  this->Grey->SetColorWindow(this->Window);
  this->Grey->SetColorLevel(this->Level);
}

void SlicePanes::ResetWindow()
{
  this->Window = this->Viewed.Image ? WhiteOf(this->Viewed.Image->Voxels) : 1;
  this->Level = 0.5 * this->Window;
  this->Adjust(1, 0);
}

void SlicePanes::SetTissueOpacity(double opacity)
{
  for (vtkImageSlice* slice : this->TissueSlices)
  {
    slice->GetProperty()->SetOpacity(opacity);
  }
}

void SlicePanes::Update()
{
  for (Pane& pane : this->Panes)
  {
    vtkCamera* camera = pane.View->GetActiveCamera();
    const Vector3 focal = pane.Focal();
    camera->SetClippingRange(1, 2 * EyeDistanceMm);
    char title[80];
    std::snprintf(title, sizeof title, "%s %.1f mm", pane.Name,
      (pane.Along == this->Viewed.Axes.Superior ? 1 : -1) * Dot(focal, pane.Along));
    pane.Over->SetTitle(title);
    std::vector<std::vector<Vector3>> lines = this->Lines;
    if (this->Point && std::abs(Dot(*this->Point - focal, pane.Along)) < MarkedWithinMm)
    {
      const Vector3 across = Cross(pane.Along, pane.Up);
      const double unit = camera->GetParallelScale();
      for (const Vector3& direction : { across, -1.0 * across, pane.Up, -1.0 * pane.Up })
      {
        lines.push_back(
          { *this->Point + 0.05 * unit * direction, *this->Point + 0.17 * unit * direction });
      }
    }
    pane.Over->SetLines(lines);
    pane.Over->Update();
  }
}
}
