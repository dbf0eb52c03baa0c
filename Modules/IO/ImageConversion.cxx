// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/ImageConversion.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"

#include <algorithm>

namespace mammoray
{
namespace
{
std::string TextOf(vtkImageData* image, const char* name)
{
  auto* array = vtkStringArray::SafeDownCast(image->GetFieldData()->GetAbstractArray(name));
  return array && array->GetNumberOfValues() > 0 ? std::string(array->GetValue(0)) : std::string();
}

std::optional<double> NumberOf(vtkImageData* image, const char* name)
{
  vtkDataArray* array = image->GetFieldData()->GetArray(name);
  return array && array->GetNumberOfTuples() > 0 ? std::optional<double>(array->GetComponent(0, 0))
                                                 : std::nullopt;
}

/// Rows upside down: the picture's first row is the last in the image.
template <typename Copy>
void ForEachRow(int rows, int columns, const Copy& copy)
{
  for (int row = 0; row < rows; ++row)
  {
    copy(static_cast<std::ptrdiff_t>(row) * columns,
      static_cast<vtkIdType>(rows - 1 - row) * columns);
  }
}
}

LabelVolume ToLabelVolume(vtkImageData* image)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  if (!scalars || scalars->GetNumberOfComponents() != 1)
  {
    throw InputError("labels: expected an image with point scalars of one component");
  }
  LabelVolume volume;
  int extent[6];
  image->GetExtent(extent);
  image->TransformIndexToPhysicalPoint(extent[0], extent[2], extent[4], volume.Origin.data());
  for (int axis = 0; axis < 3; ++axis)
  {
    volume.Size[axis] = image->GetDimensions()[axis];
    volume.Spacing[axis] = image->GetSpacing()[axis];
    for (int row = 0; row < 3; ++row)
    {
      volume.Direction[axis][row] = image->GetDirectionMatrix()->GetElement(row, axis);
    }
  }
  volume.Voxels.resize(static_cast<std::size_t>(scalars->GetNumberOfTuples()));
  for (std::size_t voxel = 0; voxel < volume.Voxels.size(); ++voxel)
  {
    const double value = scalars->GetComponent(static_cast<vtkIdType>(voxel), 0);
    if (!IsLabel(value))
    {
      throw NoLabel("labels: " + volume.VoxelName(voxel), value);
    }
    volume.Voxels[voxel] = static_cast<std::uint16_t>(value);
  }
  volume.Validate("labels");
  return volume;
}

vtkSmartPointer<vtkImageData> ToImage(const Mammogram& mammogram)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(mammogram.Columns, mammogram.Rows, 1);
  image->SetSpacing(mammogram.ColumnSpacingMm, mammogram.RowSpacingMm, 1);
  image->SetOrigin(0, 0, 0);
  vtkNew<vtkFloatArray> pixels;
  pixels->SetName("Mammogram");
  pixels->SetNumberOfValues(static_cast<vtkIdType>(mammogram.Pixels.size()));
  ForEachRow(mammogram.Rows, mammogram.Columns,
    [&](std::ptrdiff_t from, vtkIdType to)
    { std::copy_n(mammogram.Pixels.begin() + from, mammogram.Columns, pixels->GetPointer(to)); });
  image->GetPointData()->SetScalars(pixels);

  const auto addText = [&image](const char* name, const std::string& value)
  {
    vtkNew<vtkStringArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    image->GetFieldData()->AddArray(array);
  };
  const auto addNumber = [&image](const char* name, const std::optional<double>& value)
  {
    if (value)
    {
      vtkNew<vtkDoubleArray> array;
      array->SetName(name);
      array->InsertNextValue(*value);
      image->GetFieldData()->AddArray(array);
    }
  };
  addText("View", mammogram.View);
  addText("Laterality", std::string(1, mammogram.Laterality));
  addText("RowDirection", mammogram.RowDirection);
  addText("ColumnDirection", mammogram.ColumnDirection);
  addText("PresentationIntent",
    mammogram.PresentationIntent == Mammogram::Intent::ForProcessing ? "FOR PROCESSING"
                                                                     : "FOR PRESENTATION");
  const auto addWhole = [&image](const char* name, int value)
  {
    vtkNew<vtkIntArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    image->GetFieldData()->AddArray(array);
  };
  addWhole("InvertedForDisplay", mammogram.InvertedForDisplay ? 1 : 0);
  addWhole("IntensityRelationship", static_cast<int>(mammogram.IntensityRelationship));
  addWhole("IntensitySign", mammogram.IntensitySign);
  addWhole("BitsStored", mammogram.BitsStored);
  addNumber("BodyPartThicknessMm", mammogram.BodyPartThicknessMm);
  addNumber("PositionerPrimaryAngleDeg", mammogram.PositionerPrimaryAngleDeg);
  addNumber("SourceToDetectorMm", mammogram.SourceToDetectorMm);
  addNumber("SourceToPatientMm", mammogram.SourceToPatientMm);
  addNumber("PeakKilovoltage", mammogram.PeakKilovoltage);
  return image;
}

Mammogram ToMammogram(vtkImageData* image)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  const int* size = image->GetDimensions();
  if (!scalars || scalars->GetNumberOfComponents() != 1 || size[2] != 1 ||
    !(image->GetSpacing()[0] > 0 && image->GetSpacing()[1] > 0))
  {
    throw InputError("mammogram: expected an image of one slice with scalars of one component and "
                     "positive spacing");
  }
  Mammogram mammogram;
  mammogram.Columns = size[0];
  mammogram.Rows = size[1];
  mammogram.ColumnSpacingMm = image->GetSpacing()[0];
  mammogram.RowSpacingMm = image->GetSpacing()[1];
  mammogram.Pixels.resize(static_cast<std::size_t>(scalars->GetNumberOfTuples()));
  ForEachRow(mammogram.Rows, mammogram.Columns,
    [&](std::ptrdiff_t to, vtkIdType from)
    {
      for (int column = 0; column < mammogram.Columns; ++column)
      {
        mammogram.Pixels[static_cast<std::size_t>(to + column)] =
          static_cast<float>(scalars->GetComponent(from + column, 0));
      }
    });
  const std::string laterality = TextOf(image, "Laterality");
  mammogram.View = TextOf(image, "View");
  mammogram.Laterality = laterality.empty() ? '?' : laterality.front();
  mammogram.RowDirection = TextOf(image, "RowDirection");
  mammogram.ColumnDirection = TextOf(image, "ColumnDirection");
  mammogram.PresentationIntent = TextOf(image, "PresentationIntent") == "FOR PROCESSING"
    ? Mammogram::Intent::ForProcessing
    : Mammogram::Intent::ForPresentation;
  const auto whole = [image](const char* name, int otherwise)
  { return static_cast<int>(NumberOf(image, name).value_or(otherwise)); };
  mammogram.InvertedForDisplay = whole("InvertedForDisplay", 0) != 0;
  mammogram.IntensityRelationship =
    static_cast<Mammogram::Relationship>(std::clamp(whole("IntensityRelationship", 0), 0, 2));
  mammogram.IntensitySign = whole("IntensitySign", 0);
  mammogram.BitsStored = whole("BitsStored", 16);
  mammogram.BodyPartThicknessMm = NumberOf(image, "BodyPartThicknessMm");
  mammogram.PositionerPrimaryAngleDeg = NumberOf(image, "PositionerPrimaryAngleDeg");
  mammogram.SourceToDetectorMm = NumberOf(image, "SourceToDetectorMm");
  mammogram.SourceToPatientMm = NumberOf(image, "SourceToPatientMm");
  mammogram.PeakKilovoltage = NumberOf(image, "PeakKilovoltage");
  return mammogram;
}
}
