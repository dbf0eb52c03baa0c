// SPDX-License-Identifier: Apache-2.0
#include "Private/PixelFilters.h"

#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageInterpolator.h"
#include "vtkImageMedian3D.h"
#include "vtkImageReslice.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

namespace mammoray
{
namespace
{
/// The image refers to `values`, which must outlive it.
vtkSmartPointer<vtkImageData> Wrap(const PixelGrid& grid, std::vector<float>& values)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(grid.Columns, grid.Rows, 1);
  image->SetSpacing(grid.ColumnSpacing, grid.RowSpacing, 1);
  vtkNew<vtkFloatArray> array;
  array->SetArray(values.data(), static_cast<vtkIdType>(values.size()), 1);
  image->GetPointData()->SetScalars(array);
  return image;
}

std::vector<float> Copy(vtkImageData* image)
{
  vtkDataArray* array = image->GetPointData()->GetScalars();
  const auto* values = static_cast<const float*>(array->GetVoidPointer(0));
  return { values, values + array->GetNumberOfValues() };
}
}

std::vector<float> Median3x3(const PixelGrid& grid, std::vector<float>& values)
{
  vtkNew<vtkImageMedian3D> median;
  median->SetInputData(Wrap(grid, values));
  median->SetKernelSize(3, 3, 1);
  median->Update();
  return Copy(median->GetOutput());
}

std::vector<float> Refine(const PixelGrid& grid, std::vector<float>& values, const PixelGrid& fine,
  int factor)
{
  if (factor == 1)
  {
    return values;
  }
  vtkNew<vtkImageInterpolator> linear;
  linear->SetInterpolationModeToLinear();
  linear->SetBorderModeToClamp();
  // Pixels at the border reach half a pixel beyond their centres.
  linear->SetTolerance(1.0);
  vtkNew<vtkImageReslice> reslice;
  reslice->SetInputData(Wrap(grid, values));
  reslice->SetInterpolator(linear);
  // Which it tells the interpolator otherwise.
  reslice->SetInterpolationModeToLinear();
  reslice->SetOutputSpacing(fine.ColumnSpacing, fine.RowSpacing, 1);
  reslice->SetOutputExtent(0, fine.Columns - 1, 0, fine.Rows - 1, 0, 0);
  const int half = factor / 2;
  reslice->SetOutputOrigin(-half * fine.ColumnSpacing, -half * fine.RowSpacing, 0);
  reslice->Update();
  return Copy(reslice->GetOutput());
}
}
