// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/ContourLines.h"

#include "vtkCellArray.h"
#include "vtkContourFilter.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkStripper.h"

#include <algorithm>

namespace mammoray
{
std::vector<std::vector<std::array<double, 2>>> ContourLines(const float* values, int columns,
  int rows, float level, std::optional<float> around)
{
  const int border = around ? 1 : 0;
  vtkNew<vtkImageData> image;
  image->SetExtent(-border, columns - 1 + border, -border, rows - 1 + border, 0, 0);
  image->AllocateScalars(VTK_FLOAT, 1);
  auto* copy = static_cast<float*>(image->GetScalarPointer());
  std::fill_n(copy, image->GetNumberOfPoints(), around.value_or(level));
  for (int row = 0; row < rows; ++row)
  {
    std::copy_n(values + static_cast<std::size_t>(row) * columns, columns,
      copy + static_cast<std::size_t>(row + border) * (columns + 2 * border) + border);
  }
  vtkNew<vtkContourFilter> contour;
  contour->SetInputData(image);
  contour->SetValue(0, level);
  vtkNew<vtkStripper> joined;
  joined->SetInputConnection(contour->GetOutputPort());
  joined->JoinContiguousSegmentsOn();
  joined->SetMaximumLength(VTK_INT_MAX);
  joined->Update();
  std::vector<std::vector<std::array<double, 2>>> lines;
  vtkCellArray* cells = joined->GetOutput()->GetLines();
  vtkNew<vtkIdList> ids;
  for (cells->InitTraversal(); cells->GetNextCell(ids) != 0;)
  {
    std::vector<std::array<double, 2>>& line = lines.emplace_back();
    for (vtkIdType index = 0; index < ids->GetNumberOfIds(); ++index)
    {
      double point[3];
      joined->GetOutput()->GetPoint(ids->GetId(index), point);
      line.push_back({ point[0], point[1] });
    }
  }
  return lines;
}
}
