// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/MammographyGeometry.h"

#include "Private/BreastColumns.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace mammoray
{
namespace
{
/// Extent of tissue along the anatomical directions, and the front of fixed tissue.
struct TissueExtent
{
  explicit TissueExtent(const AnatomicalAxes& axes)
    : Directions{ axes.Left, axes.Anterior, axes.Superior }
  {
  }

  /// Adds a piece of tissue that extends `half` to either side of a point along each direction.
  void Add(const Vector3& point, const Vector3& half, bool isFixed)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double coordinate = Dot(point, this->Directions[d]);
      this->Low[d] = std::min(this->Low[d], coordinate - half[d]);
      this->High[d] = std::max(this->High[d], coordinate + half[d]);
    }
    if (isFixed)
    {
      this->FixedFront = std::max(this->FixedFront, Dot(point, this->Directions[1]) + half[1]);
    }
  }

  Vector3 Point(const Vector3& place) const
  {
    return place[0] * this->Directions[0] + place[1] * this->Directions[1] +
      place[2] * this->Directions[2];
  }

  Vector3 Place(const Vector3& point) const
  {
    return { Dot(point, this->Directions[0]), Dot(point, this->Directions[1]),
      Dot(point, this->Directions[2]) };
  }

  bool IsEmpty() const { return this->Low[0] > this->High[0]; }

  Vector3 Middle() const { return 0.5 * (this->Low + this->High); }

  /// `middle`: along these directions; the frame's anchor lies at the front of the fixed tissue
  /// before it, or at the posterior end without any.
  PoseFrame Frame(const Vector3& middle) const
  {
    const auto& [left, anterior, superior] = this->Directions;
    const double chestWall = std::isfinite(this->FixedFront) ? this->FixedFront : this->Low[1];
    return { { left, anterior, superior },
      middle[0] * left + chestWall * anterior + middle[2] * superior };
  }

  static constexpr double Infinity = std::numeric_limits<double>::infinity();
  std::array<Vector3, 3> Directions;
  Vector3 Low{ Infinity, Infinity, Infinity };
  Vector3 High{ -Infinity, -Infinity, -Infinity };
  double FixedFront = -Infinity;
};

/// Axes whose anterior one is square to a plane that comes forward by these slopes to the left and
/// to the head, turned there by the shortest way.
AnatomicalAxes SquareTo(const std::array<double, 2>& slopes, const AnatomicalAxes& axes)
{
  const double steepness = std::hypot(slopes[0], slopes[1]);
  if (steepness == 0)
  {
    return axes;
  }
  // The direction in which the plane comes forward becomes steeper towards it.
  const std::array<double, 2> rise{ slopes[0] / steepness, slopes[1] / steepness };
  const Vector3 forward = rise[0] * axes.Left + rise[1] * axes.Superior;
  const Vector3 level = rise[0] * axes.Superior - rise[1] * axes.Left;
  const double angle = std::atan(steepness);
  AnatomicalAxes square;
  square.Anterior = std::cos(angle) * axes.Anterior - std::sin(angle) * forward;
  const Vector3 turned = std::cos(angle) * forward + std::sin(angle) * axes.Anterior;
  square.Left = rise[0] * turned - rise[1] * level;
  square.Superior = rise[1] * turned + rise[0] * level;
  return square;
}

/// Adds points of a cell that are at most one column width apart.
void AddCell(const TetrahedralMesh& mesh, std::size_t cell, const TissueExtent& extent,
  bool isFixed, BreastColumns& columns)
{
  Vector3 corners[4];
  double longest = 0;
  for (int c = 0; c < 4; ++c)
  {
    corners[c] = extent.Place(mesh.Point(mesh.Cells[4 * cell + c]));
    longest = std::max(longest, Norm(corners[c] - corners[0]));
  }
  const int order = 1 + static_cast<int>(longest / 3);
  for (int i = 0; i <= order; ++i)
  {
    for (int j = 0; i + j <= order; ++j)
    {
      for (int k = 0; i + j + k <= order; ++k)
      {
        const Vector3 sum = static_cast<double>(i) * corners[0] +
          static_cast<double>(j) * corners[1] + static_cast<double>(k) * corners[2] +
          static_cast<double>(order - i - j - k) * corners[3];
        columns.Add((1.0 / order) * sum, isFixed);
      }
    }
  }
}

/// Rotates `from` towards `to`.
void Turn(Vector3& from, Vector3& to, double degrees)
{
  const double angle = degrees * std::numbers::pi / 180.0;
  const Vector3 before = from;
  from = std::cos(angle) * before + std::sin(angle) * to;
  to = std::cos(angle) * to - std::sin(angle) * before;
}

/// The gantry frame's origin seen from the anchor, gantry frame, mm.
Vector3 OriginFromAnchor(const MammographyUnit& unit, const BreastPose& pose)
{
  return { pose.LateralMm, pose.AnteriorMm,
    pose.VerticalMm - 0.5 * pose.ThicknessMm - unit.SupportHeightMm };
}

/// Half extent of a voxel along each direction: half of the sum of its projected edges.
Vector3 HalfVoxel(const LabelVolume& materials, const TissueExtent& extent)
{
  Vector3 half{ 0, 0, 0 };
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (std::size_t a = 0; a < 3; ++a)
    {
      half[d] +=
        0.5 * materials.Spacing[a] * std::abs(Dot(materials.Direction[a], extent.Directions[d]));
    }
  }
  return half;
}

/// Calls visit(voxel, point, is fixed) for all tissue.
template <typename Visit>
void ForEachTissueVoxel(const LabelVolume& materials, const std::vector<bool>& fixed,
  const Visit& visit)
{
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const std::size_t material = materials.Voxels[voxel];
      if (material != 0)
      {
        visit(voxel, materials.PointAt(i, j, k), material < fixed.size() && fixed[material]);
      }
    });
}

/// All tissue in columns; `all` becomes its extent. Throws InputError if there is none.
BreastColumns ColumnsOf(const LabelVolume& materials, const std::vector<bool>& fixed,
  TissueExtent& all)
{
  const Vector3 half = HalfVoxel(materials, all);
  ForEachTissueVoxel(materials, fixed,
    [&](std::size_t, const Vector3& point, bool isFixed) { all.Add(point, half, isFixed); });
  if (all.IsEmpty())
  {
    throw InputError("pose: expected tissue in the volume, found only air");
  }
  BreastColumns columns(all.Low, all.High, 2 * std::max(half[0], half[2]));
  ForEachTissueVoxel(materials, fixed,
    [&](std::size_t, const Vector3& point, bool isFixed)
    { columns.Add(all.Place(point), isFixed); });
  return columns;
}

/// Calls visit(voxel, point, is fixed, is breast) for all tissue. Throws InputError if there is
/// none.
template <typename Visit>
void ForEachVoxelOfBreast(const LabelVolume& materials, const std::vector<bool>& fixed,
  const AnatomicalAxes& axes, const Visit& visit)
{
  TissueExtent all(axes);
  BreastColumns columns = ColumnsOf(materials, fixed, all);
  columns.Find();
  ForEachTissueVoxel(materials, fixed,
    [&](std::size_t voxel, const Vector3& point, bool isFixed)
    { visit(voxel, point, isFixed, columns.IsBreast(all.Place(point))); });
}
}

AnatomicalAxes AnatomicalAxes::FromCode(const std::string& code)
{
  AnatomicalAxes axes;
  bool seen[3] = { false, false, false };
  for (std::size_t a = 0; a < code.size() && code.size() == 3; ++a)
  {
    Vector3 unit{ 0, 0, 0 };
    unit[a] = 1.0;
    switch (code[a])
    {
      case 'L':
      case 'R':
        axes.Left = (code[a] == 'L' ? 1.0 : -1.0) * unit;
        seen[0] = true;
        break;
      case 'A':
      case 'P':
        axes.Anterior = (code[a] == 'A' ? 1.0 : -1.0) * unit;
        seen[1] = true;
        break;
      case 'S':
      case 'I':
        axes.Superior = (code[a] == 'S' ? 1.0 : -1.0) * unit;
        seen[2] = true;
        break;
      default:
        break;
    }
  }
  if (!(seen[0] && seen[1] && seen[2]))
  {
    throw InputError("orientation '" + code +
      "': expected three letters, one each of L/R, A/P and S/I, for example LPS");
  }
  return axes;
}

PoseFrame FindPoseFrame(const LabelVolume& materials, const std::vector<bool>& fixed,
  const AnatomicalAxes& axes)
{
  TissueExtent all(axes);
  BreastColumns columns = ColumnsOf(materials, fixed, all);
  columns.Find();
  TissueExtent extent(SquareTo(columns.WallSlopes(), axes));
  const Vector3 half = HalfVoxel(materials, extent);
  ForEachTissueVoxel(materials, fixed,
    [&](std::size_t, const Vector3& point, bool isFixed)
    {
      if (columns.IsBreast(all.Place(point)))
      {
        extent.Add(point, half, isFixed);
      }
    });
  return extent.Frame(extent.Place(all.Point(columns.Middle())));
}

std::optional<double> MidlineBetweenBreasts(const LabelVolume& materials,
  const std::vector<bool>& fixed, const AnatomicalAxes& axes)
{
  TissueExtent all(axes);
  return ColumnsOf(materials, fixed, all).Midline();
}

LabelVolume KeepBreast(const LabelVolume& materials, const std::vector<bool>& fixed,
  const AnatomicalAxes& axes)
{
  LabelVolume kept = materials;
  ForEachVoxelOfBreast(materials, fixed, axes,
    [&](std::size_t voxel, const Vector3&, bool, bool isBreast)
    { kept.Voxels[voxel] = isBreast ? kept.Voxels[voxel] : 0; });
  return kept;
}

PoseFrame FindPoseFrame(const TetrahedralMesh& mesh, const std::vector<bool>& fixed,
  const AnatomicalAxes& axes)
{
  TissueExtent all(axes);
  const auto isFixed = [&](std::size_t cell)
  {
    const auto material = static_cast<std::size_t>(mesh.Materials[cell]);
    return material < fixed.size() && fixed[material];
  };
  for (std::size_t index = 0; index < mesh.Cells.size(); ++index)
  {
    all.Add(mesh.Point(mesh.Cells[index]), { 0, 0, 0 }, isFixed(index / 4));
  }
  if (all.IsEmpty())
  {
    throw InputError("pose: expected tissue in the mesh, found no cells");
  }
  BreastColumns columns(all.Low, all.High, 0);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    AddCell(mesh, cell, all, isFixed(cell), columns);
  }
  columns.Find();
  TissueExtent extent(SquareTo(columns.WallSlopes(), axes));
  for (std::size_t index = 0; index < mesh.Cells.size(); ++index)
  {
    const Vector3& point = mesh.Point(mesh.Cells[index]);
    if (columns.IsBreast(all.Place(point)))
    {
      extent.Add(point, { 0, 0, 0 }, isFixed(index / 4));
    }
  }
  return extent.Frame(extent.Place(all.Point(columns.Middle())));
}

PoseFrame FindPoseFrame(const SurfaceMesh& surface, const std::vector<bool>& fixed,
  const AnatomicalAxes& axes)
{
  const auto isFixed = [&fixed](std::uint16_t material)
  { return material < fixed.size() && fixed[material]; };
  TissueExtent extent(axes);
  for (std::size_t corner = 0; corner < surface.Triangles.size(); ++corner)
  {
    const double* const point = &surface.Points[3 * std::size_t{ surface.Triangles[corner] }];
    extent.Add({ point[0], point[1], point[2] }, { 0, 0, 0 },
      isFixed(surface.FrontMaterials[corner / 3]) || isFixed(surface.BackMaterials[corner / 3]));
  }
  return extent.Frame(extent.Middle());
}

VolumeFromGantry PlaceUnit(const PoseFrame& frame, const MammographyUnit& unit,
  const BreastPose& pose)
{
  VolumeFromGantry placed;
  placed.X = frame.Axes.Left;
  placed.Y = frame.Axes.Anterior;
  placed.Z = frame.Axes.Superior;
  Turn(placed.Z, placed.X, pose.RollDeg);
  Turn(placed.Z, placed.Y, pose.PitchDeg);
  Turn(placed.Y, placed.X, pose.YawDeg);
  placed.Origin = frame.Anchor + placed.Direction(OriginFromAnchor(unit, pose));
  return placed;
}

PoseFrame FrameOf(const VolumeFromGantry& placed, const MammographyUnit& unit,
  const BreastPose& pose)
{
  PoseFrame frame{ { placed.X, placed.Y, placed.Z },
    placed.Origin - placed.Direction(OriginFromAnchor(unit, pose)) };
  Turn(frame.Axes.Anterior, frame.Axes.Left, -pose.YawDeg);
  Turn(frame.Axes.Superior, frame.Axes.Anterior, -pose.PitchDeg);
  Turn(frame.Axes.Superior, frame.Axes.Left, -pose.RollDeg);
  return frame;
}

std::array<UnitVelocity, ParameterCount> UnitVelocities(const PoseFrame& frame,
  const MammographyUnit& unit, const BreastPose& pose)
{
  constexpr double radians = std::numbers::pi / 180.0;
  const VolumeFromGantry placed = PlaceUnit(frame, unit, pose);
  std::array<UnitVelocity, ParameterCount> velocities;
  // The mid-plane stays, so the support moves as far as the paddle.
  velocities[ThicknessParameter].Shift = -0.5 * placed.Z;
  velocities[ThicknessParameter].PaddleShift = placed.Z;
  // omega = from x to rotates `from` towards `to`, both before PlaceUnit rotated them. The shifts
  // rotate with the unit; only the anchor stays.
  const double yaw = radians * pose.YawDeg;
  const Vector3 anteriorBeforeYaw = std::cos(yaw) * placed.Y - std::sin(yaw) * placed.X;
  velocities[RollParameter].Turn = radians * Cross(frame.Axes.Superior, frame.Axes.Left);
  velocities[PitchParameter].Turn = radians * Cross(placed.Z, anteriorBeforeYaw);
  velocities[YawParameter].Turn = radians * Cross(placed.Y, placed.X);
  velocities[LateralParameter].Shift = placed.X;
  velocities[AnteriorParameter].Shift = placed.Y;
  velocities[VerticalParameter].Shift = placed.Z;
  velocities[TiltParameter].PaddleTurn = radians * Cross(placed.Y, placed.Z);
  return velocities;
}
}
