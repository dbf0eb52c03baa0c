// SPDX-License-Identifier: Apache-2.0
#include "Private/SimulationShape.h"

#include "Private/MeshingSteps.h"
#include "Private/TriangleAim.h"
#include "Private/VoxelMask.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

namespace mammoray
{
namespace
{
/// Lengths as fractions of a cell's edge.
constexpr double VoxelPart = 1.0 / 8;
/// Memory of two fields.
constexpr double LeastBytesPerVoxel = 8;
constexpr double BallPart = 1.0 / 3;
constexpr double BlurPart = 0.25;
/// Radius of the ball that must fit into meshed layers over the chest wall.
constexpr double LayerBallPart = 0.25;
/// Radius of the ball that does not fit into pockets between muscles.
constexpr double PocketBallPart = 1.5;
/// Fraction of the tissue that opening may remove before a smaller ball is tried.
constexpr double MostTaken = 0.1;
constexpr int MostHalvings = 3;

std::size_t VoxelsOf(const VoxelMask& mask)
{
  return std::accumulate(mask.Voxels.begin(), mask.Voxels.end(), std::size_t{ 0 });
}

/// A grid of cubic voxels over the box of another grid, with a margin.
VolumeGrid CubicGrid(const LabelVolume& box, double spacingMm, double marginMm)
{
  VolumeGrid grid;
  grid.Direction = box.Direction;
  grid.Spacing = { spacingMm, spacingMm, spacingMm };
  double voxels = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    voxels *= (box.Size[axis] * box.Spacing[axis] + 2 * marginMm) / spacingMm;
  }
  CheckMemory(FormattedText("simulation mesh: cells of %g mm, whose shape has %.3g voxels,",
                spacingMm / VoxelPart, voxels),
    LeastBytesPerVoxel * voxels);
  const int margin = static_cast<int>(std::ceil(marginMm / spacingMm));
  Vector3 first;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double extent = box.Size[axis] * box.Spacing[axis];
    const int count = static_cast<int>(std::ceil(extent / spacingMm - 1e-9));
    grid.Size[axis] = count + 2 * margin;
    // Both grids have the same centre.
    first[axis] =
      0.5 * (box.Size[axis] - 1) - 0.5 * (grid.Size[axis] - 1) * spacingMm / box.Spacing[axis];
  }
  grid.Origin = box.PointAt(first[0], first[1], first[2]);
  return grid;
}

/// As OpenedLargest, with a smaller ball if this one removes too much.
VoxelMask OpenedGently(const VoxelMask& mask, double radiusMm)
{
  const double wanted = (1 - MostTaken) * static_cast<double>(VoxelsOf(LargestPiece(mask)));
  for (int halving = 0; halving < MostHalvings; ++halving, radiusMm *= 0.5)
  {
    VoxelMask opened = OpenedLargest(mask, radiusMm);
    if (static_cast<double>(VoxelsOf(opened)) >= wanted)
    {
      return opened;
    }
  }
  return LargestPiece(mask);
}

/// The region of the `count` voxels with the largest values.
VoxelMask LargestValues(const VoxelField& field, std::size_t count)
{
  std::vector<float> values = field.Values;
  const auto place = values.end() - static_cast<std::ptrdiff_t>(count) - 1;
  std::nth_element(values.begin(), place, values.end());
  return Above(field, *place);
}

/// The tissue's outline at the scale of the cells.
VoxelMask Outline(VoxelField fraction, double edgeMm)
{
  BlurField(fraction, VoxelPart * edgeMm);
  const double ball = BallPart * edgeMm;
  const VoxelMask region =
    OpenedGently(WithoutHoles(Closed(LargestPiece(Above(fraction, 0.5)), ball)), ball);
  VoxelField depth = DepthIn(region);
  BlurField(depth, BlurPart * edgeMm);
  return LargestPiece(LargestValues(depth, VoxelsOf(region)));
}

/// Voxels of one mask that are in another (`in`) or not in it.
VoxelMask Both(const VoxelMask& mask, const VoxelMask& other, bool in = true)
{
  VoxelMask both = mask;
  for (std::size_t voxel = 0; voxel < both.Voxels.size(); ++voxel)
  {
    both.Voxels[voxel] = mask.Voxels[voxel] && (other.Voxels[voxel] != 0) == in ? 1 : 0;
  }
  return both;
}

VoxelMask Without(const VoxelMask& mask, const VoxelMask& other)
{
  return Both(mask, other, false);
}

/// The region in front of the smooth sheet that bounds the chest wall, in tissue and in air.
VoxelMask InFrontOfWall(const VoxelMask& tissue, const VoxelField& fixedFraction, double edgeMm)
{
  VoxelField fraction = fixedFraction;
  BlurField(fraction, VoxelPart * edgeMm);
  // Pieces separate from the chest wall do not belong to it; pockets between its muscles do.
  const VoxelMask muscle = LargestPiece(Closed(Above(fraction, 0.5), BallPart * edgeMm));
  const VoxelMask breast =
    OpenedGently(Without(tissue, Closed(muscle, PocketBallPart * edgeMm)), LayerBallPart * edgeMm);
  const VoxelMask wall = LargestPiece(Without(tissue, breast));
  VoxelField ahead = DistanceTo(wall, 1);
  const VoxelField behind = DistanceTo(Without(tissue, wall), 1);
  for (std::size_t voxel = 0; voxel < ahead.Values.size(); ++voxel)
  {
    ahead.Values[voxel] -= behind.Values[voxel];
  }
  BlurField(ahead, BlurPart * edgeMm);
  return Above(ahead, 0.0);
}

/// Mean direction from the wall to the moving tissue, in voxels of the grid; zero if there is none.
Vector3 MeanNormal(const VoxelMask& wall, const VoxelMask& moving)
{
  Vector3 sum{ 0, 0, 0 };
  std::size_t stride = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    // No tissue reaches the border of the grid.
    for (std::size_t voxel = stride; voxel < wall.Voxels.size(); ++voxel)
    {
      sum[axis] += wall.Voxels[voxel - stride] && moving.Voxels[voxel] ? 1 : 0;
      sum[axis] -= moving.Voxels[voxel - stride] && wall.Voxels[voxel] ? 1 : 0;
    }
    stride *= static_cast<std::size_t>(wall.Size[axis]);
  }
  const double length = Norm(sum);
  return length > 0 ? (1 / length) * sum : sum;
}

/// Adds to the region in front of the wall all tissue farther in front than any fixed tissue.
/// Rounded corners and rims too thin for cells must fix nothing there, where the plates move.
void ReleaseAhead(const VoxelMask& tissue, const VoxelField& fixedFraction, VoxelMask& front)
{
  const Vector3 normal = MeanNormal(Without(tissue, front), Both(tissue, front));
  const auto forEach = [&](auto&& visit)
  {
    front.ForEachVoxel(
      [&](int i, int j, int k, std::size_t voxel) {
        visit(voxel, Dot(normal, { double(i), double(j), double(k) }));
      });
  };
  double most = -std::numeric_limits<double>::infinity();
  forEach([&](std::size_t voxel, double height)
    { most = fixedFraction.Values[voxel] >= 0.5 ? std::max(most, height) : most; });
  if (!std::isfinite(most))
  {
    return;
  }
  forEach([&](std::size_t voxel, double height)
    { front.Voxels[voxel] = height > most ? 1 : front.Voxels[voxel]; });
}

/// The fixed layer, one edge deep: the tissue behind the moving one, and air behind that where the
/// tissue is thinner, as in a wall that tapers off or was segmented as one layer of voxels.
VoxelMask WallBehind(const VoxelMask& moving, const VoxelMask& behind, double edgeMm)
{
  VoxelMask wall = behind;
  const Vector3 normal = MeanNormal(behind, moving);
  const int steps = static_cast<int>(std::ceil(2 * edgeMm / wall.Spacing[0]));
  for (int k = 0; k < wall.Size[2]; ++k)
  {
    for (int j = 0; j < wall.Size[1]; ++j)
    {
      for (int i = 0; i < wall.Size[0]; ++i)
      {
        for (int step = 1; behind.Voxels[wall.Index(i, j, k)] && step <= steps; ++step)
        {
          const Vector3 place = Vector3{ double(i), double(j), double(k) } - 0.5 * step * normal;
          std::array<int, 3> at{};
          for (int axis = 0; axis < 3; ++axis)
          {
            at[axis] =
              std::clamp(static_cast<int>(std::lround(place[axis])), 1, wall.Size[axis] - 2);
          }
          const std::size_t voxel = wall.Index(at[0], at[1], at[2]);
          wall.Voxels[voxel] = moving.Voxels[voxel] ? 0 : 1;
        }
      }
    }
  }
  return LargestPiece(Without(wall, Above(DistanceTo(moving, 1), edgeMm)));
}
}

SimulationShape ShapeForCells(const LabelVolume& materials, const std::vector<bool>& fixed,
  double edgeMm)
{
  const auto isFixed = [&](std::uint16_t m) { return m < fixed.size() && fixed[m]; };
  const auto moves = [&](std::uint16_t m) { return m != 0 && !isFixed(m); };
  const LabelVolume box = CropToTissue(materials, 0);
  const VolumeGrid grid = CubicGrid(box, VoxelPart * edgeMm, (PocketBallPart + VoxelPart) * edgeMm);
  const VoxelField movingFraction = FractionOf(box, moves, grid);
  const VoxelField fixedFraction = FractionOf(box, isFixed, grid);
  VoxelField fraction = movingFraction;
  std::transform(fraction.Values.begin(), fraction.Values.end(), fixedFraction.Values.begin(),
    fraction.Values.begin(), std::plus<>());

  SimulationShape shape;
  shape.Tissue = Outline(std::move(fraction), edgeMm);
  VoxelMask front = InFrontOfWall(shape.Tissue, fixedFraction, edgeMm);
  ReleaseAhead(shape.Tissue, fixedFraction, front);
  const VoxelMask moving = LargestPiece(Both(shape.Tissue, front));
  if (VoxelsOf(moving) == 0)
  {
    throw InputError("simulation mesh: expected tissue that is not fixed, found none");
  }
  const VoxelMask wall = WallBehind(moving, Without(shape.Tissue, front), edgeMm);
  for (std::size_t voxel = 0; voxel < front.Voxels.size(); ++voxel)
  {
    shape.Tissue.Voxels[voxel] = moving.Voxels[voxel] ? SimulationShape::Moving
      : wall.Voxels[voxel]                            ? SimulationShape::Fixed
                                                      : 0;
    shape.MovingMm3 += front.Voxels[voxel] ? movingFraction.Values[voxel] * grid.VoxelVolume() : 0;
  }
  return shape;
}
}
