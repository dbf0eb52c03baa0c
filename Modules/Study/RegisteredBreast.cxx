// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/RegisteredBreast.h"

#include "Private/CellFinder.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace mammoray
{
namespace
{
/// A point this far outside the mesh still belongs to it, mm: meshes follow voxels no better.
constexpr double OutsideMm = 1.0;

/// Axes of one standard deviation of the covariance [[a, b], [b, c]].
UncertaintyEllipse EllipseOf(double a, double b, double c)
{
  const double middle = 0.5 * (a + c);
  const double spread = std::hypot(0.5 * (a - c), b);
  UncertaintyEllipse ellipse;
  ellipse.MajorMm = std::sqrt(std::max(middle + spread, 0.0));
  ellipse.MinorMm = std::sqrt(std::max(middle - spread, 0.0));
  ellipse.AngleDeg = 0.5 * std::atan2(2 * b, a - c) * 180 / std::numbers::pi;
  return ellipse;
}

/// Coordinates of a body that programs may have saved as floats, mm.
constexpr double RoundingMm = 1e-3;

double LargestDifference(const Vector3& one, const Vector3& other)
{
  const Vector3 apart = one - other;
  return std::max({ std::abs(apart[0]), std::abs(apart[1]), std::abs(apart[2]) });
}

/// Results are folders, whose files may have been mixed.
vtkSmartPointer<vtkUnstructuredGrid> ReadMeshOfResult(const ResultFile& result,
  const std::string& name)
{
  const std::string path = result.Folder + "/" + name;
  auto grid = ReadMesh(path);
  const std::optional<VolumeFromGantry> placed = FindPlacement(grid);
  const VolumeFromGantry& said = result.Placed;
  if (placed &&
    !(LargestDifference(placed->Origin, said.Origin) <= RoundingMm &&
      LargestDifference(placed->X, said.X) <= RoundingMm &&
      LargestDifference(placed->Y, said.Y) <= RoundingMm &&
      LargestDifference(placed->Z, said.Z) <= RoundingMm))
  {
    throw InputError(path + ": expected a mesh placed as " + ResultFileName +
      " says, found one of another registration");
  }
  return grid;
}

/// Whether the compressed mesh is the uncompressed one displaced.
bool IsDisplaced(vtkUnstructuredGrid* uncompressed, vtkDataArray* displacement,
  vtkUnstructuredGrid* compressed)
{
  if (compressed->GetNumberOfPoints() != uncompressed->GetNumberOfPoints() ||
    compressed->GetNumberOfCells() != uncompressed->GetNumberOfCells())
  {
    return false;
  }
  for (vtkIdType point = 0; point < uncompressed->GetNumberOfPoints(); ++point)
  {
    Vector3 from;
    Vector3 to;
    Vector3 by;
    uncompressed->GetPoint(point, from.data());
    compressed->GetPoint(point, to.data());
    displacement->GetTuple(point, by.data());
    if (!(LargestDifference(from + by, to) <= RoundingMm))
    {
      return false;
    }
  }
  return true;
}
}

void DescribeUnit(const ResultFile& result, BreastInUnit& breast)
{
  breast.Placed = result.Placed;
  breast.Unit = result.Unit;
  breast.Grid = result.Grid;
  for (const ResultParameter& parameter : result.Parameters)
  {
    breast.Parameters.push_back(parameter.Name);
  }
  breast.Covariance =
    result.ConsideredCovariance.empty() ? result.Covariance : result.ConsideredCovariance;
}

BreastInUnit ReadBreastInUnit(const ResultFile& result)
{
  BreastInUnit breast;
  breast.Uncompressed = ReadMeshOfResult(result, "uncompressed.vtu");
  vtkDataArray* displacement = breast.Uncompressed->GetPointData()->GetArray("Displacement");
  if (!displacement || displacement->GetNumberOfComponents() != 3)
  {
    throw InputError(result.Folder +
      "/uncompressed.vtu: expected the point array 'Displacement' with 3 components");
  }
  breast.Compressed = ReadMeshOfResult(result, "compressed.vtu");
  if (!IsDisplaced(breast.Uncompressed, displacement, breast.Compressed))
  {
    throw InputError(result.Folder +
      "/compressed.vtu: expected the points of uncompressed.vtu, displaced as its array "
      "'Displacement' says, found others");
  }
  DescribeUnit(result, breast);
  return breast;
}

std::vector<std::array<double, 2>> EllipsePoints(const UncertaintyEllipse& ellipse,
  const std::array<double, 2>& middle, const ReceptorGrid& grid, double deviations)
{
  constexpr int Steps = 48;
  const double columnLength = grid.ColumnSpacingMm();
  const double rowLength = grid.RowSpacingMm();
  const double turn = ellipse.AngleDeg * std::numbers::pi / 180;
  std::vector<std::array<double, 2>> points;
  for (int step = 0; step < Steps; ++step)
  {
    const double angle = 2 * std::numbers::pi * step / Steps;
    const double major = deviations * ellipse.MajorMm * std::cos(angle);
    const double minor = deviations * ellipse.MinorMm * std::sin(angle);
    const double alongColumns = major * std::cos(turn) - minor * std::sin(turn);
    const double alongRows = major * std::sin(turn) + minor * std::cos(turn);
    points.push_back({ middle[0] + alongColumns * grid.ColumnStep[0] / columnLength +
        alongRows * grid.RowStep[0] / rowLength,
      middle[1] + alongColumns * grid.ColumnStep[1] / columnLength +
        alongRows * grid.RowStep[1] / rowLength });
  }
  return points;
}

struct RegisteredBreast::Internals
{
  BreastInUnit Breast;
  /// It leads from the uncompressed to the compressed points.
  vtkNew<vtkDoubleArray> Displacement;
  vtkDataArray* Materials = nullptr;
  std::vector<std::string> MaterialNames;
  std::unique_ptr<CellFinder> AtRest;
  std::unique_ptr<CellFinder> Squeezed;
  /// Derivatives by those parameters that have them, and the covariance in the order of those.
  std::vector<vtkDataArray*> Sensitivities;
  std::vector<double> Covariance;

  void PickCovariance();
  std::string NameOf(vtkIdType cell) const
  {
    const auto material = static_cast<std::size_t>(this->Materials->GetComponent(cell, 0));
    return material < this->MaterialNames.size() ? this->MaterialNames[material]
                                                 : std::to_string(material);
  }
  /// Where there is a covariance.
  std::optional<ModelError> Model;

  /// Of a place that `point`, at rest, is in; needs the compressed point.
  void AddUncertainty(const PlaceInCell& place, const Vector3& point, ImagedPoint& imaged) const;
  /// The displacement of the tissue at a point of the grid that `cells` finds places in.
  CarriedPoint CarryIn(CellFinder& cells, const Vector3& point) const
  {
    CarriedPoint carried;
    PlaceInCell place = cells.Find(point, OutsideMm);
    if (place.Cell < 0)
    {
      carried.Outside = true;
      place = cells.Find(point, std::numeric_limits<double>::max());
    }
    carried.Displacement = place.Interpolate(this->Displacement);
    return carried;
  }
};

/// Keeps the part of the covariance whose parameters have sensitivities.
void RegisteredBreast::Internals::PickCovariance()
{
  const BreastInUnit& breast = this->Breast;
  std::vector<std::size_t> free;
  for (std::size_t index = 0; index < breast.Parameters.size(); ++index)
  {
    const std::string name = SensitivityArrayPrefix + breast.Parameters[index];
    if (vtkDataArray* array = breast.Uncompressed->GetPointData()->GetArray(name.c_str()))
    {
      free.push_back(index);
      this->Sensitivities.push_back(array);
    }
  }
  for (const std::size_t i : free)
  {
    for (const std::size_t j : free)
    {
      this->Covariance.push_back(breast.Covariance.at(i * breast.Parameters.size() + j));
    }
  }
}

void RegisteredBreast::Internals::AddUncertainty(const PlaceInCell& place, const Vector3& point,
  ImagedPoint& imaged) const
{
  if (this->Covariance.empty())
  {
    return;
  }
  const ReceptorGrid& grid = this->Breast.Grid;
  const VolumeFromGantry& placed = this->Breast.Placed;
  // How the point moves, seen from the unit, with each parameter and, by its own error, each way.
  std::vector<Vector3> velocities;
  for (vtkDataArray* sensitivity : this->Sensitivities)
  {
    velocities.push_back(place.Interpolate(sensitivity));
  }
  const std::size_t parameters = velocities.size();
  const double model = this->Model->SigmaMm(point, imaged.Compressed);
  for (const Vector3& axis : { placed.X, placed.Y, placed.Z })
  {
    velocities.push_back(model * axis);
  }
  const std::vector<double> at(imaged.Compressed.begin(), imaged.Compressed.end());
  // In the gantry frame, and on the receptor along the image's columns and rows.
  std::vector<std::array<double, 5>> rates;
  const double columnLength = grid.ColumnSpacingMm();
  const double rowLength = grid.RowSpacingMm();
  for (const Vector3& velocity : velocities)
  {
    const ReceptorPoint rate = ReceptorVelocities(at, velocity, placed, this->Breast.Unit).front();
    rates.push_back({ Dot(velocity, placed.X), Dot(velocity, placed.Y), Dot(velocity, placed.Z),
      (rate[0] * grid.ColumnStep[0] + rate[1] * grid.ColumnStep[1]) / columnLength,
      (rate[0] * grid.RowStep[0] + rate[1] * grid.RowStep[1]) / rowLength });
  }
  const auto shared = [&](std::size_t a, std::size_t b)
  {
    double sum = 0;
    for (std::size_t i = 0; i < rates.size(); ++i)
    {
      for (std::size_t j = 0; j < rates.size(); ++j)
      {
        const bool own = i >= parameters || j >= parameters;
        const double covariance = own ? (i == j ? 1.0 : 0.0) : this->Covariance[i * parameters + j];
        sum += rates[i][a] * covariance * rates[j][b];
      }
    }
    return sum;
  };
  std::array<double, 9> inSpace{};
  for (std::size_t index = 0; index < inSpace.size(); ++index)
  {
    inSpace[index] = shared(index / 3, index % 3);
  }
  imaged.Covariance = inSpace;
  imaged.ModelSigmaMm = model;
  imaged.Uncertainty = EllipseOf(shared(3, 3), shared(3, 4), shared(4, 4));
}

RegisteredBreast::RegisteredBreast(const std::string& folder)
  : RegisteredBreast(ReadBreastInUnit(ReadResultFile(folder)))
{
}

RegisteredBreast::RegisteredBreast(const BreastInUnit& breast)
  : Internal(std::make_unique<Internals>())
{
  Internals& internal = *this->Internal;
  internal.Breast = breast;
  const TetrahedralMesh anatomy = FromGrid(breast.Uncompressed, &internal.MaterialNames);
  const vtkIdType count = breast.Uncompressed->GetNumberOfPoints();
  if (breast.Compressed->GetNumberOfPoints() != count ||
    breast.Compressed->GetNumberOfCells() != breast.Uncompressed->GetNumberOfCells())
  {
    throw InputError("expected the compressed and the uncompressed points of the same mesh");
  }
  internal.Materials = breast.Uncompressed->GetCellData()->GetArray(MaterialArrayName);
  internal.Displacement->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < count; ++id)
  {
    Vector3 from;
    Vector3 to;
    breast.Uncompressed->GetPoint(id, from.data());
    breast.Compressed->GetPoint(id, to.data());
    internal.Displacement->InsertNextTuple((to - from).data());
  }
  if (!breast.Covariance.empty())
  {
    internal.PickCovariance();
    internal.Model.emplace(anatomy, FromGrid(breast.Compressed).Points, breast.Placed);
  }
  internal.AtRest = std::make_unique<CellFinder>(breast.Uncompressed);
  internal.Squeezed = std::make_unique<CellFinder>(breast.Compressed);
}

RegisteredBreast::~RegisteredBreast() = default;
RegisteredBreast::RegisteredBreast(RegisteredBreast&&) noexcept = default;
RegisteredBreast& RegisteredBreast::operator=(RegisteredBreast&&) noexcept = default;

vtkUnstructuredGrid* RegisteredBreast::Uncompressed() const
{
  return this->Internal->Breast.Uncompressed;
}

vtkUnstructuredGrid* RegisteredBreast::Compressed() const
{
  return this->Internal->Breast.Compressed;
}

XRaySource RegisteredBreast::Source() const
{
  return SourceOf(this->Internal->Breast.Placed, this->Internal->Breast.Unit);
}

XRayDetector RegisteredBreast::Detector() const
{
  return DetectorOf(this->Internal->Breast.Placed, this->Internal->Breast.Grid, 1);
}

ImagedPoint RegisteredBreast::ToMammogram(const Vector3& point) const
{
  const Internals& internal = *this->Internal;
  const PlaceInCell place = internal.AtRest->Find(point, OutsideMm);
  if (place.Cell < 0)
  {
    double bounds[6];
    internal.Breast.Uncompressed->GetBounds(bounds);
    char text[240];
    std::snprintf(text, sizeof text,
      "point (%.2f, %.2f, %.2f): expected a place in the breast, found none within %.0f mm (the "
      "mesh is in %.1f to %.1f, %.1f to %.1f, %.1f to %.1f mm)",
      point[0], point[1], point[2], OutsideMm, bounds[0], bounds[1], bounds[2], bounds[3],
      bounds[4], bounds[5]);
    throw InputError(text);
  }
  ImagedPoint imaged;
  imaged.Material = internal.NameOf(place.Cell);
  imaged.Compressed = point + place.Interpolate(internal.Displacement);
  const std::vector<double> compressed(imaged.Compressed.begin(), imaged.Compressed.end());
  imaged.ReceptorMm =
    ProjectToReceptor(compressed, internal.Breast.Placed, internal.Breast.Unit).front();
  const ReceptorGrid& grid = internal.Breast.Grid;
  const auto [column, row] = grid.IndexOf(imaged.ReceptorMm);
  imaged.Column = column;
  imaged.Row = row;
  imaged.InImage = grid.Contains(imaged.ReceptorMm);
  internal.AddUncertainty(place, point, imaged);
  return imaged;
}

CarriedPoint RegisteredBreast::Carry(const Vector3& point) const
{
  return this->Internal->CarryIn(*this->Internal->AtRest, point);
}

CarriedPoint RegisteredBreast::CarryBack(const Vector3& point) const
{
  CarriedPoint carried = this->Internal->CarryIn(*this->Internal->Squeezed, point);
  carried.Displacement = -1.0 * carried.Displacement;
  return carried;
}

std::vector<RaySegment> RegisteredBreast::ToVolume(double column, double row, double stepMm) const
{
  const Internals& internal = *this->Internal;
  const ReceptorPoint receptor = internal.Breast.Grid.PositionOf(column, row);
  if (!internal.Breast.Grid.Contains(receptor))
  {
    char text[160];
    std::snprintf(text, sizeof text,
      "pixel (%.1f, %.1f): expected columns 0 to %d and rows 0 to %d", column, row,
      internal.Breast.Grid.Columns - 1, internal.Breast.Grid.Rows - 1);
    throw InputError(text);
  }
  if (!(stepMm > 0))
  {
    throw InputError("step: expected a positive length, found " + std::to_string(stepMm) + " mm");
  }
  const Vector3 foot = internal.Breast.Placed.Point({ receptor[0], receptor[1], 0 });
  const Vector3 source = this->Source().Position;
  const Vector3 up = (1 / Norm(source - foot)) * (source - foot);
  // How far up the ray the breast reaches.
  double highest = 0;
  for (vtkIdType id = 0; id < internal.Breast.Compressed->GetNumberOfPoints(); ++id)
  {
    double point[3];
    internal.Breast.Compressed->GetPoint(id, point);
    highest = std::max(highest, Dot(Vector3{ point[0], point[1], point[2] } - foot, up));
  }
  const double slope = Dot(up, internal.Breast.Placed.Z);
  const auto count = static_cast<long>(std::ceil(highest / stepMm));
  const double step = highest / static_cast<double>(std::max(count, 1L));
  std::vector<RaySegment> stretches;
  std::string before;
  bool inside = false;
  for (long index = 0; index < count; ++index)
  {
    // Middles of equal steps, from the source's side.
    const double distance = highest - (static_cast<double>(index) + 0.5) * step;
    const PlaceInCell place = internal.Squeezed->Find(foot + distance * up, 0);
    if (place.Cell < 0)
    {
      inside = false;
      continue;
    }
    const Vector3 rest = place.Interpolate(internal.Breast.Uncompressed->GetPoints()->GetData());
    const std::string material = internal.NameOf(place.Cell);
    if (!inside || material != before)
    {
      stretches.push_back({ material, slope * (distance + 0.5 * step), 0, 0, {} });
    }
    inside = true;
    before = material;
    RaySegment& stretch = stretches.back();
    stretch.ExitHeightMm = slope * (distance - 0.5 * step);
    stretch.LengthMm += step;
    stretch.Uncompressed.push_back(rest);
  }
  return stretches;
}

namespace
{
std::vector<Vector3> CurveBehind(const SeenInView& seen, double stepMm)
{
  std::vector<Vector3> curve;
  for (const RaySegment& stretch : seen.Breast->ToVolume(seen.Pixel[0], seen.Pixel[1], stepMm))
  {
    curve.insert(curve.end(), stretch.Uncompressed.begin(), stretch.Uncompressed.end());
  }
  return curve;
}
}

std::optional<TissueInTwoViews> FindInTwoViews(const SeenInView& first, const SeenInView& second,
  double stepMm)
{
  const std::vector<Vector3> curve = CurveBehind(first, stepMm);
  const std::vector<Vector3> other = CurveBehind(second, stepMm);
  std::optional<TissueInTwoViews> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3& a : curve)
  {
    for (const Vector3& b : other)
    {
      const double gap = Norm(a - b);
      if (gap < least)
      {
        least = gap;
        nearest = TissueInTwoViews{ 0.5 * (a + b), gap };
      }
    }
  }
  return nearest;
}
}
