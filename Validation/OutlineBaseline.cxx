// SPDX-License-Identifier: Apache-2.0
#include "OutlineBaseline.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <array>

namespace mammoray
{
namespace
{
/// Tissue nearer to the chest wall than this part of the depth may be the body beside the breast.
constexpr double BodyEnds = 1.0 / 3;

/// Extent of a breast across and along the beam, in front of BodyEnds; position of its tip.
struct ExtentInUnit
{
  Extent Across;
  Extent Height;
  double Tip = 0;
};

/// Points as (across, depth, height); mm.
ExtentInUnit MeasureExtent(const std::vector<Vector3>& points, const char* what)
{
  ExtentInUnit extent;
  for (const Vector3& point : points)
  {
    extent.Tip = std::max(extent.Tip, point[1]);
  }
  for (const Vector3& point : points)
  {
    if (point[1] >= BodyEnds * extent.Tip)
    {
      extent.Across.Add(point[0]);
      extent.Height.Add(point[2]);
    }
  }
  if (!(extent.Tip > 0 && extent.Across.Length() > 0))
  {
    throw InputError(std::string("outline: expected a breast in front of the receptor's edge in ") +
      what + ", found none");
  }
  return extent;
}

/// Centres of a volume's tissue voxels in the gantry frame, mm.
std::vector<Vector3> TissueInGantry(const LabelVolume& breast, const std::vector<bool>& held,
  const VolumeFromGantry& placed)
{
  std::vector<Vector3> points;
  breast.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const std::size_t material = breast.Voxels[voxel];
      if (material != 0 && !held[material])
      {
        points.push_back(placed.ToGantry(breast.PointAt(i, j, k)));
      }
    });
  return points;
}

std::vector<Vector3> BreastPixels(const RegistrationTarget& target)
{
  std::vector<Vector3> points;
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      if (target.BreastMask[static_cast<std::size_t>(row) * target.Grid.Columns + column] != 0)
      {
        const ReceptorPoint at = target.Grid.PositionOf(column, row);
        points.push_back({ at[0], at[1], 0 });
      }
    }
  }
  return points;
}
}

std::vector<Vector3> MoveByOutline(const std::vector<Vector3>& points, const LabelVolume& breast,
  const std::vector<bool>& held, const UnitPlacement& placement, const BreastPose& pose,
  const RegistrationTarget& target, OutlineMotion motion)
{
  const VolumeFromGantry placed = placement.At(pose);
  const ExtentInUnit given = MeasureExtent(TissueInGantry(breast, held, placed), "the volume");
  ExtentInUnit wanted = MeasureExtent(BreastPixels(target), "the mammogram");
  // From the receptor to the middle between the plates.
  const double middle = placement.Unit.SupportHeightMm + 0.5 * pose.ThicknessMm;
  const double reduced =
    (placement.Unit.SourceToDetectorMm - middle) / placement.Unit.SourceToDetectorMm;
  wanted.Tip *= reduced;
  wanted.Across = { reduced * wanted.Across.Low, reduced * wanted.Across.High };

  const bool scales = motion == OutlineMotion::Affine;
  const double wider = scales ? wanted.Across.Length() / given.Across.Length() : 1;
  const double higher = scales ? pose.ThicknessMm / given.Height.Length() : 1;
  // Either scaled in front of the chest wall, which stays in place, or moved.
  const double deeper = scales ? wanted.Tip / given.Tip : 1;
  const double forwards = scales ? 0 : wanted.Tip - given.Tip;
  std::vector<Vector3> moved;
  for (const Vector3& point : points)
  {
    const Vector3 at = placed.ToGantry(point);
    moved.push_back({ wanted.Across.Middle() + wider * (at[0] - given.Across.Middle()),
      deeper * at[1] + forwards, middle + higher * (at[2] - given.Height.Middle()) });
  }
  return moved;
}
}
