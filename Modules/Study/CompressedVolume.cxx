// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/CompressedVolume.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ProjectionImage.h"

#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkProbeFilter.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr const char* PlaceArrayName = "Place";

Vector3 PointOf(vtkUnstructuredGrid* grid, vtkIdType id)
{
  Vector3 point;
  grid->GetPoint(id, point.data());
  return point;
}

/// Voxels along these axes around the breast's points, and so far beyond.
VolumeGrid GridAround(vtkUnstructuredGrid* breast, const std::array<Vector3, 3>& axes,
  double spacingMm, double marginMm = 0)
{
  VolumeGrid grid;
  grid.Direction = axes;
  grid.Spacing = { spacingMm, spacingMm, spacingMm };
  Vector3 low = grid.ContinuousIndex(PointOf(breast, 0));
  Vector3 high = low;
  for (vtkIdType id = 0; id < breast->GetNumberOfPoints(); ++id)
  {
    const Vector3 index = grid.ContinuousIndex(PointOf(breast, id));
    for (int a = 0; a < 3; ++a)
    {
      low[a] = std::min(low[a], index[a]);
      high[a] = std::max(high[a], index[a]);
    }
  }
  const double margin = marginMm / spacingMm;
  grid.Origin = grid.PointAt(low[0] - margin, low[1] - margin, low[2] - margin);
  double count = 1;
  for (int a = 0; a < 3; ++a)
  {
    const double size = 1 + std::ceil(high[a] - low[a] + 2 * margin);
    count *= size;
    grid.Size[a] = static_cast<int>(std::min(size, 1e9));
  }
  if (count > 1e8)
  {
    char text[160];
    std::snprintf(text, sizeof text,
      "voxels of %g mm: expected at most 100 million around the breast, found %.3g", spacingMm,
      count);
    throw InputError(text);
  }
  return grid;
}

/// At each voxel of `grid` that lies in the compressed breast, where its tissue lay before.
vtkSmartPointer<vtkDataSet> FindPlaces(const RegisteredBreast& breast, const VolumeGrid& grid)
{
  // In the grid's own frame: VTK's cell-by-cell probing knows no oblique images.
  vtkUnstructuredGrid* compressed = breast.Compressed();
  vtkNew<vtkUnstructuredGrid> cells;
  cells->SetCells(compressed->GetCellTypesArray(), compressed->GetCells());
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> places;
  places->SetName(PlaceArrayName);
  places->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < compressed->GetNumberOfPoints(); ++id)
  {
    points->InsertNextPoint(grid.ContinuousIndex(PointOf(compressed, id)).data());
    places->InsertNextTuple(PointOf(breast.Uncompressed(), id).data());
  }
  cells->SetPoints(points);
  cells->GetPointData()->AddArray(places);
  vtkNew<vtkImageData> voxels;
  voxels->SetDimensions(grid.Size[0], grid.Size[1], grid.Size[2]);
  vtkNew<vtkProbeFilter> probe;
  probe->SetInputData(voxels);
  probe->SetSourceData(cells);
  probe->Update();
  return probe->GetOutput();
}

/// The part of the line from `begin` to `end` in the grid's box, as fractions; empty: first > last.
std::array<double, 2> PartInside(const VolumeGrid& grid, const Vector3& begin, const Vector3& end)
{
  const Vector3 from = grid.ContinuousIndex(begin);
  const Vector3 way = grid.ContinuousIndex(end) - from;
  double first = 0;
  double last = 1;
  for (int a = 0; a < 3; ++a)
  {
    const double low = -0.5 - from[a];
    const double high = grid.Size[a] - 0.5 - from[a];
    if (way[a] == 0)
    {
      last = low <= 0 && high >= 0 ? last : -1;
      continue;
    }
    first = std::max(first, std::min(low / way[a], high / way[a]));
    last = std::min(last, std::max(low / way[a], high / way[a]));
  }
  return { first, last };
}

struct RayValues
{
  float Maximum = 0;
  float Mean = 0;
  float PathLength = 0;
};

/// `coverage`: 1 inside and 0 outside, as an image, so that only values inside count between
/// voxels.
RayValues AlongRay(const CompressedVolume& compressed, const IntensityVolume& coverage,
  const Vector3& begin, const Vector3& end)
{
  const IntensityVolume& image = compressed.Values;
  const auto [first, last] = PartInside(image, begin, end);
  RayValues ray;
  if (first >= last)
  {
    return ray;
  }
  const double length = (last - first) * Norm(end - begin);
  const auto count = static_cast<int>(std::ceil(2 * length / image.Spacing[0]));
  double sum = 0;
  int inside = 0;
  for (int step = 0; step < count; ++step)
  {
    const Vector3 point = begin + (first + (step + 0.5) / count * (last - first)) * (end - begin);
    const Vector3 index = image.ContinuousIndex(point);
    int nearest[3];
    for (int a = 0; a < 3; ++a)
    {
      nearest[a] = std::clamp(static_cast<int>(std::lround(index[a])), 0, image.Size[a] - 1);
    }
    if (!compressed.Inside[image.Index(nearest[0], nearest[1], nearest[2])])
    {
      continue;
    }
    // The nearest voxel is inside: at least an eighth.
    const float value =
      image.ValueAt(point).value_or(0.0F) / coverage.ValueAt(point).value_or(1.0F);
    ray.Maximum = inside == 0 ? value : std::max(ray.Maximum, value);
    sum += value;
    ++inside;
  }
  ray.Mean = inside > 0 ? static_cast<float>(sum / inside) : 0;
  ray.PathLength = static_cast<float>(inside * length / count);
  return ray;
}

vtkFloatArray* AddFloats(vtkImageData* image, const char* name)
{
  vtkNew<vtkFloatArray> array;
  array->SetName(name);
  array->SetNumberOfValues(image->GetNumberOfPoints());
  image->GetPointData()->AddArray(array);
  return array;
}
}

CompressedVolume CompressVolume(const IntensityVolume& image, const RegisteredBreast& breast,
  double spacingMm, const ProgressCallback& progress)
{
  if (!(spacingMm > 0) || !std::isfinite(spacingMm))
  {
    throw InputError("compressed volume: expected a positive voxel size, found " +
      std::to_string(spacingMm) + " mm");
  }
  ReportProgress(progress, 0, "finding the tissue");
  CompressedVolume result;
  static_cast<VolumeGrid&>(result.Values) =
    GridAround(breast.Compressed(), image.Direction, spacingMm);
  const vtkSmartPointer<vtkDataSet> voxels = FindPlaces(breast, result.Values);
  ReportProgress(progress, 0.8, "sampling the image");
  vtkDataArray* places = voxels->GetPointData()->GetArray(PlaceArrayName);
  auto* valid = vtkCharArray::SafeDownCast(voxels->GetPointData()->GetArray("vtkValidPointMask"));
  const vtkIdType count = voxels->GetNumberOfPoints();
  result.Values.Voxels.assign(static_cast<std::size_t>(count), 0.0F);
  result.Inside.assign(static_cast<std::size_t>(count), 0);
  std::size_t found = 0;
  for (vtkIdType voxel = 0; voxel < count; ++voxel)
  {
    if (valid->GetValue(voxel) == 0)
    {
      continue;
    }
    Vector3 place;
    places->GetTuple(voxel, place.data());
    if (const std::optional<float> value = image.ValueAt(place))
    {
      result.Values.Voxels[voxel] = *value;
      result.Inside[voxel] = 1;
      ++found;
    }
  }
  if (found == 0)
  {
    double bounds[6];
    breast.Uncompressed()->GetBounds(bounds);
    char text[240];
    std::snprintf(text, sizeof text,
      "image: expected one that shows the registered breast (%.0f to %.0f, %.0f to %.0f, %.0f to "
      "%.0f mm), found no voxel there; is it in the frame of the registered volume?",
      bounds[0], bounds[1], bounds[2], bounds[3], bounds[4], bounds[5]);
    throw InputError(text);
  }
  return result;
}

vtkSmartPointer<vtkImageData> ProjectVolume(const CompressedVolume& compressed,
  const RegisteredBreast& breast, const ProgressCallback& progress)
{
  const XRayDetector detector = breast.Detector();
  const Vector3 source = breast.Source().Position;
  vtkSmartPointer<vtkImageData> image = MakeDetectorImage(detector);
  float* maximum = AddFloats(image, "Maximum")->GetPointer(0);
  float* mean = AddFloats(image, "Mean")->GetPointer(0);
  float* length = AddFloats(image, "PathLength")->GetPointer(0);
  image->GetPointData()->SetActiveScalars("Maximum");
  IntensityVolume coverage;
  static_cast<VolumeGrid&>(coverage) = compressed.Values;
  coverage.Voxels.assign(compressed.Inside.begin(), compressed.Inside.end());
  for (int row = 0; row < detector.Rows; ++row)
  {
    ReportProgress(progress, static_cast<double>(row) / detector.Rows, "projecting the image");
    for (int column = 0; column < detector.Columns; ++column)
    {
      const Vector3 pixel = detector.Origin + static_cast<double>(column) * detector.ColumnStep +
        static_cast<double>(row) * detector.RowStep;
      const RayValues ray = AlongRay(compressed, coverage, source, pixel);
      const std::size_t id = static_cast<std::size_t>(row) * detector.Columns + column;
      maximum[id] = ray.Maximum;
      mean[id] = ray.Mean;
      length[id] = ray.PathLength;
    }
  }
  return image;
}

DisplacementField FindDisplacement(const RegisteredBreast& breast, DisplacementDirection direction,
  double spacingMm, double marginMm, const ProgressCallback& progress)
{
  if (!(spacingMm > 0) || !std::isfinite(spacingMm) || !(marginMm >= 0) || !std::isfinite(marginMm))
  {
    throw InputError("displacement: expected positive voxels and a margin of at least 0, found " +
      std::to_string(spacingMm) + " and " + std::to_string(marginMm) + " mm");
  }
  const bool back = direction == DisplacementDirection::CompressedToVolume;
  DisplacementField field;
  static_cast<VolumeGrid&>(field) = GridAround(back ? breast.Compressed() : breast.Uncompressed(),
    VolumeGrid{}.Direction, spacingMm, marginMm);
  field.Vectors.resize(3 * static_cast<std::size_t>(field.Size[0]) * field.Size[1] * field.Size[2]);
  field.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (i == 0)
      {
        ReportProgress(progress, static_cast<double>(3 * voxel) / field.Vectors.size(),
          "finding the displacement");
      }
      const Vector3 point = field.PointAt(i, j, k);
      const CarriedPoint carried = back ? breast.CarryBack(point) : breast.Carry(point);
      std::copy(carried.Displacement.begin(), carried.Displacement.end(),
        &field.Vectors[3 * voxel]);
    });
  return field;
}
}
