// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Case/RegisteredBreast.h"

#include "mammoray/Case/ResultFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Registration/EvaluatedState.h"
#include "mammoray/Registration/Silhouette.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Report/RegistrationReport.h"
#include "mammoray/XRay/LabelSurface.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkContourFilter.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStaticCellLocator.h"
#include "vtkStripper.h"
#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <numbers>

namespace mammoray
{
namespace
{
/// A point this far outside the mesh still belongs to it, mm: meshes follow voxels no better.
constexpr double OutsideMm = 1.0;
/// A lesion may touch the skin or the chest wall, no more.
constexpr double LargestShareOutside = 0.5;
/// Of a lesion's voxel surface: takes the stairs off.
constexpr int SmoothingSteps = 5;

/// A cell of a tetrahedral grid and the weights of its corners at a place.
struct Place
{
  vtkIdType Cell = -1;
  std::array<vtkIdType, 4> Corners{};
  std::array<double, 4> Weights{};

  Vector3 Interpolate(vtkDataArray* values) const
  {
    Vector3 sum{ 0, 0, 0 };
    for (std::size_t corner = 0; corner < 4; ++corner)
    {
      double value[3];
      values->GetTuple(this->Corners[corner], value);
      sum = sum + this->Weights[corner] * Vector3{ value[0], value[1], value[2] };
    }
    return sum;
  }
};

/// Finds cells of a grid.
class CellFinder
{
public:
  explicit CellFinder(vtkUnstructuredGrid* grid)
    : Grid(grid)
  {
    this->Locator->SetDataSet(grid);
    this->Locator->BuildLocator();
  }

  /// The cell that holds the point, or, within `toleranceMm`, lies nearest to it; Cell -1 if none.
  Place Find(Vector3 point, double toleranceMm)
  {
    Place place;
    double parametric[3];
    place.Cell =
      this->Locator->FindCell(point.data(), 0.0, this->Cell, parametric, place.Weights.data());
    if (place.Cell < 0 && toleranceMm > 0)
    {
      double closest[3];
      double distance2 = 0;
      int subId = 0;
      vtkIdType cell = -1;
      this->Locator->FindClosestPoint(point.data(), closest, this->Cell, cell, subId, distance2);
      if (cell >= 0 && distance2 <= toleranceMm * toleranceMm)
      {
        place.Cell = cell;
        this->Grid->GetCell(cell, this->Cell);
        double ignored = 0;
        this->Cell->EvaluatePosition(closest, nullptr, subId, parametric, ignored,
          place.Weights.data());
      }
    }
    if (place.Cell >= 0)
    {
      this->Grid->GetCellPoints(place.Cell, this->Ids);
      std::copy_n(this->Ids->GetPointer(0), 4, place.Corners.begin());
    }
    return place;
  }

private:
  vtkUnstructuredGrid* Grid;
  vtkNew<vtkStaticCellLocator> Locator;
  vtkNew<vtkGenericCell> Cell;
  vtkNew<vtkIdList> Ids;
};

template <typename Values>
Values Numbers(const nlohmann::json& json)
{
  Values values{};
  if (json.size() != values.size())
  {
    throw InputError("expected " + std::to_string(values.size()) + " numbers, found " +
      std::to_string(json.size()));
  }
  for (std::size_t index = 0; index < values.size(); ++index)
  {
    values[index] = json.at(index).get<double>();
  }
  return values;
}

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

/// The closed outlines of the pixels where `values` is positive, continuous column and row.
std::vector<std::vector<std::array<double, 2>>> OutlinesOf(const float* values, int columns,
  int rows)
{
  // With a border of nothing, so that outlines close at the image's edges.
  vtkNew<vtkImageData> mask;
  mask->SetExtent(-1, columns, -1, rows, 0, 0);
  mask->AllocateScalars(VTK_FLOAT, 1);
  auto* inside = static_cast<float*>(mask->GetScalarPointer());
  std::fill_n(inside, mask->GetNumberOfPoints(), 0.0F);
  for (int row = 0; row < rows; ++row)
  {
    for (int column = 0; column < columns; ++column)
    {
      const std::size_t pixel = static_cast<std::size_t>(row) * columns + column;
      inside[static_cast<std::size_t>(row + 1) * (columns + 2) + column + 1] =
        values[pixel] > 0 ? 1.0F : 0.0F;
    }
  }
  vtkNew<vtkContourFilter> contour;
  contour->SetInputData(mask);
  contour->SetValue(0, 0.5);
  vtkNew<vtkStripper> loops;
  loops->SetInputConnection(contour->GetOutputPort());
  loops->JoinContiguousSegmentsOn();
  loops->SetMaximumLength(VTK_INT_MAX);
  loops->Update();
  std::vector<std::vector<std::array<double, 2>>> outlines;
  vtkCellArray* lines = loops->GetOutput()->GetLines();
  vtkNew<vtkIdList> ids;
  for (lines->InitTraversal(); lines->GetNextCell(ids) != 0;)
  {
    std::vector<std::array<double, 2>>& outline = outlines.emplace_back();
    for (vtkIdType index = 0; index < ids->GetNumberOfIds(); ++index)
    {
      double point[3];
      loops->GetOutput()->GetPoint(ids->GetId(index), point);
      outline.push_back({ point[0], point[1] });
    }
  }
  return outlines;
}

/// The voxels of one label as material 1.
LabelVolume OnlyLabel(const LabelVolume& labels, int label)
{
  LabelVolume only = labels;
  for (std::uint16_t& voxel : only.Voxels)
  {
    voxel = voxel == label ? 1 : 0;
  }
  return only;
}

/// Middle of the voxels that are not 0, volume frame, mm.
Vector3 CentreOf(const LabelVolume& volume)
{
  Vector3 sum{ 0, 0, 0 };
  double count = 0;
  for (int k = 0; k < volume.Size[2]; ++k)
  {
    for (int j = 0; j < volume.Size[1]; ++j)
    {
      for (int i = 0; i < volume.Size[0]; ++i)
      {
        if (volume.Voxels[volume.Index(i, j, k)] != 0)
        {
          sum = sum + volume.PointAt(i, j, k);
          count += 1;
        }
      }
    }
  }
  return (1 / count) * sum;
}

void ReadUnit(const nlohmann::json& result, BreastInUnit& breast)
{
  const nlohmann::json& placement = result.at("placement");
  breast.Placed = { Numbers<Vector3>(placement.at("originMm")), Numbers<Vector3>(placement.at("x")),
    Numbers<Vector3>(placement.at("y")), Numbers<Vector3>(placement.at("z")) };
  const nlohmann::json& unit = result.at("unit");
  unit.at("sourceToDetectorMm").get_to(breast.Unit.SourceToDetectorMm);
  unit.at("supportHeightMm").get_to(breast.Unit.SupportHeightMm);
  unit.at("supportEdgeMm").get_to(breast.Unit.SupportEdgeMm);
  unit.at("paddleEdgeMm").get_to(breast.Unit.PaddleEdgeMm);
  unit.at("edgeRadiusMm").get_to(breast.Unit.EdgeRadiusMm);
  const nlohmann::json& grid = result.at("grid");
  breast.Grid.Columns = grid.at("columns").get<int>();
  breast.Grid.Rows = grid.at("rows").get<int>();
  breast.Grid.Origin = Numbers<std::array<double, 2>>(grid.at("originMm"));
  breast.Grid.ColumnStep = Numbers<std::array<double, 2>>(grid.at("columnStepMm"));
  breast.Grid.RowStep = Numbers<std::array<double, 2>>(grid.at("rowStepMm"));
  for (const nlohmann::json& parameter : result.at("parameters"))
  {
    breast.Parameters.push_back(parameter.at("name").get<std::string>());
    breast.Values.push_back(parameter.at("value").get<double>());
  }
  // Results of early versions lack what is not known of the fixed parameters.
  const nlohmann::json& own = result.at("covariance");
  if (const nlohmann::json covariance = result.value("consideredCovariance", own);
      !covariance.is_null())
  {
    breast.Covariance = covariance.get<std::vector<double>>();
    if (breast.Covariance.size() != breast.Parameters.size() * breast.Parameters.size())
    {
      throw InputError("expected a covariance of all parameters, found " +
        std::to_string(breast.Covariance.size()) + " numbers");
    }
  }
}
}

std::vector<std::string> RegistrationFolders(const std::string& folder)
{
  std::vector<std::string> folders;
  ReadResultFile(folder,
    [&](const nlohmann::json& result)
    {
      if (result.at("format") != JointResultFormat)
      {
        folders.push_back(folder);
        return;
      }
      for (const nlohmann::json& view : result.at("views"))
      {
        folders.push_back(
          (std::filesystem::path(folder) / view.at("folder").get<std::string>()).string());
      }
    });
  return folders;
}

std::string DistrustOf(const std::string& folder)
{
  std::string reason;
  ReadResultFile(folder,
    [&](const nlohmann::json& result)
    {
      // Results of early versions do not say.
      const nlohmann::json trust = result.value("trust", nlohmann::json::object());
      if (trust.value("level", "") == "none")
      {
        reason = trust.at("reasons").at(0).get<std::string>();
      }
    });
  return reason;
}

BreastInUnit ReadRegistration(const std::string& folder)
{
  if (const std::vector<std::string> folders = RegistrationFolders(folder); folders.size() > 1)
  {
    throw InputError(folder + ": expected the result of one mammogram, found one of " +
      std::to_string(folders.size()) + "; give one of its folders, such as " + folders.front());
  }
  BreastInUnit breast;
  breast.Uncompressed = ReadMesh(folder + "/uncompressed.vtu");
  breast.Compressed = ReadMesh(folder + "/compressed.vtu");
  vtkDataArray* displacement = breast.Uncompressed->GetPointData()->GetArray("Displacement");
  if (!displacement || displacement->GetNumberOfComponents() != 3)
  {
    throw InputError(
      folder + "/uncompressed.vtu: expected the point array 'Displacement' with 3 components");
  }
  if (breast.Compressed->GetNumberOfPoints() != breast.Uncompressed->GetNumberOfPoints() ||
    breast.Compressed->GetNumberOfCells() != breast.Uncompressed->GetNumberOfCells())
  {
    throw InputError(folder + ": expected compressed.vtu and uncompressed.vtu of the same mesh");
  }
  ReadResultFile(folder,
    [&](const nlohmann::json& result)
    {
      try
      {
        ReadUnit(result, breast);
      }
      catch (const InputError& error)
      {
        throw InputError(folder + "/result.json: " + error.what());
      }
    });
  return breast;
}

struct RegisteredBreast::Internals
{
  BreastInUnit Breast;
  /// From the uncompressed to the compressed points.
  vtkNew<vtkDoubleArray> Displacement;
  vtkDataArray* Materials = nullptr;
  std::vector<std::string> MaterialNames;
  std::unique_ptr<CellFinder> AtRest;
  std::unique_ptr<CellFinder> Squeezed;
  /// Of the parameters that have sensitivities, and the covariance in the order of those.
  std::vector<vtkDataArray*> Sensitivities;
  std::vector<double> Covariance;

  void PickCovariance();
  std::string NameOf(vtkIdType cell) const
  {
    const auto material = static_cast<std::size_t>(this->Materials->GetComponent(cell, 0));
    return material < this->MaterialNames.size() ? this->MaterialNames[material]
                                                 : std::to_string(material);
  }
  std::array<double, 2> PixelOf(double x, double y) const
  {
    const RegistrationTarget& grid = this->Breast.Grid;
    const double dx = x - grid.Origin[0];
    const double dy = y - grid.Origin[1];
    const double determinant =
      grid.ColumnStep[0] * grid.RowStep[1] - grid.ColumnStep[1] * grid.RowStep[0];
    return { (dx * grid.RowStep[1] - dy * grid.RowStep[0]) / determinant,
      (grid.ColumnStep[0] * dy - grid.ColumnStep[1] * dx) / determinant };
  }
  bool Contains(double column, double row) const
  {
    return column >= -0.5 && row >= -0.5 && column <= this->Breast.Grid.Columns - 0.5 &&
      row <= this->Breast.Grid.Rows - 0.5;
  }
  std::optional<UncertaintyEllipse> UncertaintyAt(const Place& place,
    const Vector3& compressed) const;
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

std::optional<UncertaintyEllipse> RegisteredBreast::Internals::UncertaintyAt(const Place& place,
  const Vector3& compressed) const
{
  if (this->Covariance.empty())
  {
    return std::nullopt;
  }
  const RegistrationTarget& grid = this->Breast.Grid;
  const std::vector<double> point(compressed.begin(), compressed.end());
  // Velocities on the receptor along the image's columns and rows.
  std::vector<std::array<double, 2>> rates;
  const double columnLength = std::hypot(grid.ColumnStep[0], grid.ColumnStep[1]);
  const double rowLength = std::hypot(grid.RowStep[0], grid.RowStep[1]);
  for (vtkDataArray* sensitivity : this->Sensitivities)
  {
    const Vector3 velocity = place.Interpolate(sensitivity);
    const ReceptorPoint rate =
      ReceptorVelocities(point, velocity.data(), this->Breast.Placed, this->Breast.Unit).front();
    rates.push_back({ (rate[0] * grid.ColumnStep[0] + rate[1] * grid.ColumnStep[1]) / columnLength,
      (rate[0] * grid.RowStep[0] + rate[1] * grid.RowStep[1]) / rowLength });
  }
  double a = 0;
  double b = 0;
  double c = 0;
  for (std::size_t i = 0; i < rates.size(); ++i)
  {
    for (std::size_t j = 0; j < rates.size(); ++j)
    {
      const double shared = this->Covariance[i * rates.size() + j];
      a += rates[i][0] * shared * rates[j][0];
      b += rates[i][0] * shared * rates[j][1];
      c += rates[i][1] * shared * rates[j][1];
    }
  }
  return EllipseOf(a, b, c);
}

RegisteredBreast::RegisteredBreast(const std::string& folder)
  : RegisteredBreast(ReadRegistration(folder))
{
}

RegisteredBreast::RegisteredBreast(const BreastInUnit& breast)
  : Internal(std::make_unique<Internals>())
{
  Internals& internal = *this->Internal;
  internal.Breast = breast;
  FromGrid(breast.Uncompressed, &internal.MaterialNames); // refuses what is not tetrahedra
  const vtkIdType count = breast.Uncompressed->GetNumberOfPoints();
  if (breast.Compressed->GetNumberOfPoints() != count ||
    breast.Compressed->GetNumberOfCells() != breast.Uncompressed->GetNumberOfCells())
  {
    throw InputError("expected the compressed and the uncompressed points of the same mesh");
  }
  internal.Materials = breast.Uncompressed->GetCellData()->GetArray(MaterialArrayName);
  internal.Displacement->SetNumberOfComponents(3);
  internal.Displacement->SetNumberOfTuples(count);
  for (vtkIdType id = 0; id < count; ++id)
  {
    double from[3];
    double to[3];
    breast.Uncompressed->GetPoint(id, from);
    breast.Compressed->GetPoint(id, to);
    internal.Displacement->SetTuple3(id, to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  }
  if (!breast.Covariance.empty())
  {
    internal.PickCovariance();
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
  const Place place = internal.AtRest->Find(point, OutsideMm);
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
  const std::array<double, 2> pixel = internal.PixelOf(imaged.ReceptorMm[0], imaged.ReceptorMm[1]);
  imaged.Column = pixel[0];
  imaged.Row = pixel[1];
  imaged.InImage = internal.Contains(pixel[0], pixel[1]);
  imaged.Uncertainty = internal.UncertaintyAt(place, imaged.Compressed);
  return imaged;
}

ImagedLesion RegisteredBreast::ToMammogram(const LabelVolume& lesions, int label,
  PathLengthProjector& projector) const
{
  const Internals& internal = *this->Internal;
  const LabelVolume lesion = OnlyLabel(lesions, label);
  const auto voxels = std::count(lesion.Voxels.begin(), lesion.Voxels.end(), 1);
  if (voxels == 0)
  {
    throw InputError("lesion: expected voxels of label " + std::to_string(label) + ", found none");
  }
  ImagedLesion imaged;
  imaged.VolumeMm3 = static_cast<double>(voxels) * lesion.VoxelVolume();
  imaged.Centre = CentreOf(lesion);
  const QuadMesh quads = ExtractInterfaces(lesion, SmoothingSteps);
  SurfaceMesh surface = quads.Triangulate(2 * quads.Quads.size());
  std::size_t outside = 0;
  for (std::size_t id = 0; id < surface.NumberOfPoints(); ++id)
  {
    const Vector3 point{ surface.Points[3 * id], surface.Points[3 * id + 1],
      surface.Points[3 * id + 2] };
    Place place = internal.AtRest->Find(point, OutsideMm);
    if (place.Cell < 0)
    {
      ++outside;
      place = internal.AtRest->Find(point, std::numeric_limits<double>::max());
    }
    const Vector3 by = place.Interpolate(internal.Displacement);
    for (int axis = 0; axis < 3; ++axis)
    {
      surface.Points[3 * id + axis] += by[axis];
    }
  }
  imaged.ShareOutside =
    static_cast<double>(outside) / static_cast<double>(surface.NumberOfPoints());
  if (imaged.ShareOutside > LargestShareOutside)
  {
    char text[200];
    std::snprintf(text, sizeof text,
      "lesion: expected label %d in the breast, found %.0f %% of its surface outside; is it in the "
      "frame of the registered volume?",
      label, 100 * imaged.ShareOutside);
    throw InputError(text);
  }
  imaged.ImagedCentre = this->ToMammogram(imaged.Centre);
  projector.SetSurface(surface);
  const RegistrationTarget& grid = internal.Breast.Grid;
  const PathLengthImage lengths = projector.Project(this->Source(), this->Detector());
  const float* lesionMm = lengths.Material(1);
  std::transform(lesionMm, lesionMm + lengths.NumberOfPixels(), std::back_inserter(imaged.Shadow),
    [](float length) { return static_cast<unsigned char>(length > 0); });
  imaged.AreaMm2 = static_cast<double>(std::count(imaged.Shadow.begin(), imaged.Shadow.end(), 1)) *
    std::abs(grid.ColumnStep[0] * grid.RowStep[1] - grid.ColumnStep[1] * grid.RowStep[0]);
  imaged.LargestThicknessMm = *std::max_element(lesionMm, lesionMm + lengths.NumberOfPixels());
  imaged.Outlines = OutlinesOf(lesionMm, grid.Columns, grid.Rows);
  return imaged;
}

std::vector<TissueStretch> RegisteredBreast::ToVolume(double column, double row,
  double stepMm) const
{
  const Internals& internal = *this->Internal;
  if (!internal.Contains(column, row))
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
  const auto [x, y] = PixelPosition(internal.Breast.Grid, column, row);
  const Vector3 foot = internal.Breast.Placed.Point({ x, y, 0 });
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
  std::vector<TissueStretch> stretches;
  std::string before;
  bool inside = false;
  for (long index = 0; index < count; ++index)
  {
    // Middles of equal steps, from the source's side.
    const double distance = highest - (static_cast<double>(index) + 0.5) * step;
    const Place place = internal.Squeezed->Find(foot + distance * up, 0);
    if (place.Cell < 0)
    {
      inside = false;
      continue;
    }
    Vector3 rest{ 0, 0, 0 };
    for (std::size_t corner = 0; corner < 4; ++corner)
    {
      double point[3];
      internal.Breast.Uncompressed->GetPoint(place.Corners[corner], point);
      rest = rest + place.Weights[corner] * Vector3{ point[0], point[1], point[2] };
    }
    const std::string material = internal.NameOf(place.Cell);
    if (!inside || material != before)
    {
      stretches.push_back({ material, slope * (distance + 0.5 * step), 0, 0, {} });
    }
    inside = true;
    before = material;
    TissueStretch& stretch = stretches.back();
    stretch.ExitHeightMm = slope * (distance - 0.5 * step);
    stretch.LengthMm += step;
    stretch.Uncompressed.push_back(rest);
  }
  return stretches;
}
}
