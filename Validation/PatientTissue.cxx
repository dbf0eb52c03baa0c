// SPDX-License-Identifier: Apache-2.0
#include "PatientTissue.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Meshing/LabelMesher.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

namespace mammoray
{
namespace
{
/// Half a voxel along a direction, mm.
double HalfVoxel(const VolumeGrid& grid, const Vector3& direction)
{
  double half = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    half += 0.5 * std::abs(Dot(grid.Direction[axis], direction)) * grid.Spacing[axis];
  }
  return half;
}

/// The tissue along a direction, mm, to the outer faces of the voxels.
Extent TissueRange(const LabelVolume& labels, const Vector3& direction)
{
  Extent range;
  labels.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      if (labels.Voxels[index] != 0)
      {
        range.Add(Dot(labels.PointAt(i, j, k), direction));
      }
    });
  if (range.Low > range.High)
  {
    throw InputError("virtual study: expected a phantom with tissue, found none");
  }
  const double half = HalfVoxel(labels, direction);
  return { range.Low - half, range.High + half };
}

/// The side the phantom belongs to: 'R' if its held tissue reaches farther forwards on the
/// patient's left, because the breastbone is there; '?' if it is even.
char NaturalSide(const LabelVolume& materials, const std::vector<bool>& held,
  const AnatomicalAxes& axes, const Extent& left)
{
  double towardsLeft = 0;
  double count = 0;
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      if (held[materials.Voxels[index]])
      {
        towardsLeft += Dot(materials.PointAt(i, j, k), axes.Left) - left.Middle();
        count += 1;
      }
    });
  // A hundredth of the width: less is chance.
  return count == 0 || std::abs(towardsLeft / count) < 0.01 * left.Length() ? '?'
    : towardsLeft > 0                                                       ? 'R'
                                                                            : 'L';
}
}

double OffMidlineMm(const LabelVolume& materials, const AnatomicalAxes& axes)
{
  // Nipples are 160 to 220 mm apart; a hand's breadth stays between larger breasts.
  return std::max(85.0, 0.5 * TissueRange(materials, axes.Left).Length() + 20);
}

LabelVolume PlaceOnChest(const LabelVolume& materials, const MaterialTable& table,
  const AnatomicalAxes& axes, char side, double offMm, const ChestCurve& curve)
{
  const Extent left = TissueRange(materials, axes.Left);
  const Extent front = TissueRange(materials, axes.Anterior);
  const Extent up = TissueRange(materials, axes.Superior);
  const char natural = NaturalSide(materials, table.Fixed(), axes, left);
  const double turn = natural == '?' || natural == side ? 1 : -1;
  const double middle = side == 'L' ? offMm : -offMm;

  LabelVolume placed;
  const double step =
    std::min({ materials.Spacing[0], materials.Spacing[1], materials.Spacing[2] });
  placed.Spacing = { step, step, step };
  const double farthest = curve.At(offMm + 0.5 * left.Length());
  // Air around, so that what is cut flat behind stays within.
  const double margin = 2 * step;
  const Vector3 low{ middle - 0.5 * left.Length() - margin, curve.At(0) - front.Length() - margin,
    -0.5 * up.Length() - margin };
  const Vector3 high{ middle + 0.5 * left.Length() + margin, farthest + margin,
    0.5 * up.Length() + margin };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    placed.Size[axis] = static_cast<int>(std::ceil((high[axis] - low[axis]) / step)) + 1;
  }
  placed.Origin = low;
  placed.Voxels.resize(static_cast<std::size_t>(placed.Size[0]) * placed.Size[1] * placed.Size[2]);
  placed.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      const Vector3 at = placed.PointAt(i, j, k);
      const double ahead = curve.At(at[0]) - at[1];
      const Vector3 from = (left.Middle() + turn * (at[0] - middle)) * axes.Left +
        (front.Low + ahead) * axes.Anterior + (up.Middle() + at[2]) * axes.Superior;
      placed.Voxels[index] = ahead < 0 ? std::uint16_t{ 0 } : materials.LabelAt(from);
    });
  return placed;
}

namespace
{
/// For each column (i + k * columns) the nearest one with soft tissue, by steps between neighbours:
/// itself if it has some; -1 for all columns if none has.
std::vector<int> NearestFullColumn(const std::vector<char>& full, int columns)
{
  std::vector<int> nearest(full.size(), -1);
  std::vector<int> front;
  for (std::size_t column = 0; column < full.size(); ++column)
  {
    if (full[column] != 0)
    {
      nearest[column] = static_cast<int>(column);
      front.push_back(static_cast<int>(column));
    }
  }
  const int rows = static_cast<int>(full.size()) / columns;
  while (!front.empty())
  {
    std::vector<int> next;
    for (const int column : front)
    {
      const int i = column % columns;
      const int k = column / columns;
      for (const auto& [di, dk] : { std::pair{ -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 } })
      {
        if (i + di < 0 || i + di >= columns || k + dk < 0 || k + dk >= rows)
        {
          continue;
        }
        const int beside = (k + dk) * columns + i + di;
        if (nearest[static_cast<std::size_t>(beside)] < 0)
        {
          nearest[static_cast<std::size_t>(beside)] = nearest[static_cast<std::size_t>(column)];
          next.push_back(beside);
        }
      }
    }
    front = std::move(next);
  }
  return nearest;
}

/// Adds voxels of air on both sides of x and z, and behind.
LabelVolume Widened(const LabelVolume& placed, int sides, int behind)
{
  LabelVolume wide;
  wide.Spacing = placed.Spacing;
  wide.Size = { placed.Size[0] + 2 * sides, placed.Size[1] + behind, placed.Size[2] + 2 * sides };
  wide.Origin = placed.PointAt(-sides, 0, -sides);
  wide.Voxels.assign(static_cast<std::size_t>(wide.Size[0]) * wide.Size[1] * wide.Size[2], 0);
  placed.ForEachVoxel([&](int i, int j, int k, std::size_t index)
    { wide.Voxels[wide.Index(i + sides, j, k + sides)] = placed.Voxels[index]; });
  return wide;
}
}

void HoldCutTissue(LabelVolume& materials, const std::vector<bool>& held)
{
  constexpr double LayerMm = 12;
  const auto wall = std::find(held.begin(), held.end(), true);
  if (wall == held.end())
  {
    return;
  }
  const std::size_t depth = materials.AxisAlong({ 0, 1, 0 });
  const bool backwards = materials.Direction[depth][1] > 0;
  const int size = materials.Size[depth];
  const int layer = std::min(size, static_cast<int>(std::ceil(LayerMm / materials.Spacing[depth])));
  // Voxels from the front on.
  const auto place = [&](std::array<int, 3> column, int step)
  {
    column[depth] = backwards ? step : size - 1 - step;
    return materials.Index(column[0], column[1], column[2]);
  };
  std::vector<std::pair<std::array<int, 3>, int>> backs;
  int cut = 0;
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t)
    {
      std::array<int, 3> column{ i, j, k };
      if (column[depth] != 0)
      {
        return;
      }
      int back = size - 1;
      while (back >= 0 && materials.Voxels[place(column, back)] == 0)
      {
        --back;
      }
      if (back >= 0)
      {
        backs.emplace_back(column, back);
        cut = std::max(cut, back);
      }
    });
  for (const auto& [column, back] : backs)
  {
    if (back + 1 >= cut && !held[materials.Voxels[place(column, back)]])
    {
      const int first = std::min(back + 1, size - layer);
      for (int step = first; step < first + layer; ++step)
      {
        materials.Voxels[place(column, step)] = static_cast<std::uint16_t>(wall - held.begin());
      }
    }
  }
}

LabelVolume FreeOfCoil(LabelVolume breast, const std::vector<bool>& held)
{
  constexpr double MostStretch = 1.8;
  std::array<double, 2> sums{};
  std::array<double, 2> squares{};
  double count = 0;
  breast.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const std::size_t material = breast.Voxels[voxel];
      if (material != 0 && !held[material])
      {
        const Vector3 at = breast.PointAt(i, j, k);
        for (std::size_t axis = 0; axis < 2; ++axis)
        {
          sums[axis] += at[2 * axis];
          squares[axis] += at[2 * axis] * at[2 * axis];
        }
        ++count;
      }
    });
  const auto deviation = [&](std::size_t axis)
  {
    const double mean = sums[axis] / count;
    return std::sqrt(squares[axis] / count - mean * mean);
  };
  // Across s, elsewhere 1 / sqrt(s): as wide as high if s^(3/2) is the ratio of now.
  const double stretch =
    std::clamp(std::pow(deviation(1) / std::max(deviation(0), 1e-9), 2.0 / 3), 1.0, MostStretch);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const bool across = std::abs(breast.Direction[axis][0]) > 0.7;
    breast.Spacing[axis] *= across ? stretch : 1 / std::sqrt(stretch);
  }
  return breast;
}

LabelVolume FlattenChest(const LabelVolume& materials, const std::vector<bool>& held)
{
  constexpr double ColumnMm = 3;
  constexpr double KeptBehindMm = 20;
  std::map<std::pair<int, int>, Vector3> fronts;
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      if (held[materials.Voxels[index]])
      {
        const Vector3 at = materials.PointAt(i, j, k);
        Vector3& front = fronts
                           .try_emplace({ static_cast<int>(std::floor(at[0] / ColumnMm)),
                                          static_cast<int>(std::floor(at[2] / ColumnMm)) },
                             at)
                           .first->second;
        front = at[1] < front[1] ? at : front;
      }
    });
  const auto shape = [](const Vector3& at)
  {
    return Eigen::Vector<double, 6>{ 1, at[0], at[2], at[0] * at[0], at[0] * at[2], at[2] * at[2] };
  };
  Eigen::MatrixX<double> places(fronts.size(), 6);
  Eigen::VectorX<double> depths(fronts.size());
  Eigen::Index row = 0;
  for (const auto& [column, front] : fronts)
  {
    places.row(row) = shape(front).transpose();
    depths[row++] = front[1];
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixX<double>> decomposed(places);
  if (decomposed.rank() < 6)
  {
    return materials;
  }
  const Eigen::Vector<double, 6> fitted = decomposed.solve(depths);
  const double plane = depths.mean();
  LabelVolume flat = materials;
  const std::size_t depth = materials.AxisAlong({ 0, 1, 0 });
  const double room =
    (places * fitted - depths.Constant(depths.size(), plane)).cwiseAbs().maxCoeff();
  const int more = static_cast<int>(std::ceil(room / materials.Spacing[depth]));
  flat.Size[depth] += 2 * more;
  flat.Origin = materials.Origin - more * materials.Spacing[depth] * materials.Direction[depth];
  flat.Voxels.assign(static_cast<std::size_t>(flat.Size[0]) * flat.Size[1] * flat.Size[2], 0);
  flat.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      Vector3 at = flat.PointAt(i, j, k);
      if (at[1] < plane + KeptBehindMm)
      {
        at[1] += shape(at).dot(fitted) - plane;
        flat.Voxels[index] = materials.LabelAt(at);
      }
    });
  return flat;
}

LabelVolume SurroundByChest(const LabelVolume& placed, const MaterialTable& table,
  const ChestCurve& curve, double wallMm, double reachMm)
{
  const std::vector<Tissue> tissues = TissuesOf(table);
  const auto materialOf = [&](Tissue tissue)
  {
    return static_cast<std::uint16_t>(
      std::find(tissues.begin() + 1, tissues.end(), tissue) - tissues.begin());
  };
  const std::uint16_t fat = materialOf(Tissue::Fat);
  const std::uint16_t wall = materialOf(Tissue::Muscle);
  if (fat == tissues.size() || wall == tissues.size())
  {
    return placed;
  }
  const double step = placed.Spacing[0];
  const int sides = static_cast<int>(std::ceil(reachMm / step));
  const double edge = std::max(std::abs(placed.PointAt(-sides, 0, 0)[0]),
    std::abs(placed.PointAt(placed.Size[0] - 1 + sides, 0, 0)[0]));
  const double last = placed.PointAt(0, placed.Size[1] - 1, 0)[1];
  const int behind = std::max(0, static_cast<int>(std::ceil((curve.At(edge) - last) / step)));
  const LabelVolume wide = Widened(placed, sides, behind);
  std::vector<char> full(static_cast<std::size_t>(wide.Size[0]) * wide.Size[2], 0);
  // How far the wall of each column comes in front of the curve's, mm; 0 without a wall.
  constexpr double noWall = -std::numeric_limits<double>::infinity();
  std::vector<double> bumps(full.size(), noWall);
  wide.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      const Tissue tissue = tissues[wide.Voxels[index]];
      const std::size_t column = static_cast<std::size_t>(k) * wide.Size[0] + i;
      full[column] |= tissue != Tissue::Air && tissue != Tissue::Muscle ? 1 : 0;
      if (tissue == Tissue::Muscle)
      {
        const Vector3 at = wide.PointAt(i, j, k);
        const double bump = curve.At(at[0]) - wallMm - (at[1] - 0.5 * step);
        bumps[column] = std::max(bumps[column], bump);
      }
    });
  std::replace(bumps.begin(), bumps.end(), noWall, 0.0);
  const std::vector<int> nearest = NearestFullColumn(full, wide.Size[0]);
  LabelVolume surrounded = wide;
  wide.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      constexpr double FatMm = 8;
      const Vector3 at = wide.PointAt(i, j, k);
      const double ahead = curve.At(at[0]) - at[1];
      const int from = nearest[static_cast<std::size_t>(k) * wide.Size[0] + i];
      std::uint16_t& material = surrounded.Voxels[index];
      if (ahead < 0 || from < 0)
      {
        return;
      }
      const int fromI = from % wide.Size[0];
      const int fromK = from / wide.Size[0];
      const double away = std::min(1.0, std::hypot(i - fromI, k - fromK) * step / reachMm);
      const double height = 1 - away * away * (3 - 2 * away);
      const double bump = bumps[static_cast<std::size_t>(from)];
      const double beforeWall = ahead - wallMm - height * bump;
      if (material == 0 && beforeWall > 0)
      {
        const Vector3 edgeOf = wide.PointAt(fromI, 0, fromK);
        const Tissue beside = height < 0.02
          ? Tissue::Air
          : tissues[wide.LabelAt(
              { edgeOf[0], curve.At(edgeOf[0]) - wallMm - bump - beforeWall / height, edgeOf[2] })];
        const bool goesOn =
          away > 0 && beside != Tissue::Air && beside != Tissue::Skin && beside != Tissue::Muscle;
        material = goesOn || beforeWall <= FatMm ? fat : material;
      }
      else if (material == 0)
      {
        material = wall;
      }
      else if (tissues[material] == Tissue::Skin && beforeWall <= FatMm)
      {
        material = fat;
      }
    });
  return surrounded;
}

namespace
{
constexpr double LatticeMm = 4;

/// A lattice of cubes over a volume: the cubes that contain tissue and their numbered corners.
struct Lattice
{
  explicit Lattice(const LabelVolume& labels)
    : Origin(labels.Origin -
        0.5 *
          (labels.Spacing[0] * labels.Direction[0] + labels.Spacing[1] * labels.Direction[1] +
            labels.Spacing[2] * labels.Direction[2]))
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      this->Count[axis] =
        static_cast<int>(std::ceil(labels.Size[axis] * labels.Spacing[axis] / LatticeMm));
    }
    std::vector<bool> full(
      static_cast<std::size_t>(this->Count[0]) * this->Count[1] * this->Count[2]);
    labels.ForEachVoxel(
      [&](int i, int j, int k, std::size_t index)
      {
        if (labels.Voxels[index] != 0)
        {
          const std::array<int, 3> cube{ static_cast<int>(
                                           (i + 0.5) * labels.Spacing[0] / LatticeMm),
            static_cast<int>((j + 0.5) * labels.Spacing[1] / LatticeMm),
            static_cast<int>((k + 0.5) * labels.Spacing[2] / LatticeMm) };
          full[this->CubeIndex(cube)] = true;
        }
      });
    for (int k = 0; k < this->Count[2]; ++k)
    {
      for (int j = 0; j < this->Count[1]; ++j)
      {
        for (int i = 0; i < this->Count[0]; ++i)
        {
          if (full[this->CubeIndex({ i, j, k })])
          {
            this->Cubes.push_back({ i, j, k });
          }
        }
      }
    }
  }

  std::size_t CubeIndex(const std::array<int, 3>& cube) const
  {
    return (static_cast<std::size_t>(cube[2]) * this->Count[1] + cube[1]) * this->Count[0] +
      cube[0];
  }
  /// The index of a corner in Points, which is extended when needed.
  std::size_t Corner(const std::array<int, 3>& at, const VolumeGrid& frame)
  {
    const std::size_t key =
      (static_cast<std::size_t>(at[2]) * (this->Count[1] + 1) + at[1]) * (this->Count[0] + 1) +
      at[0];
    const auto [entry, isNew] = this->Numbers.try_emplace(key, this->Points.size() / 3);
    if (isNew)
    {
      const Vector3 point = this->Origin + LatticeMm * at[0] * frame.Direction[0] +
        LatticeMm * at[1] * frame.Direction[1] + LatticeMm * at[2] * frame.Direction[2];
      this->Points.insert(this->Points.end(), point.begin(), point.end());
    }
    return entry->second;
  }

  Vector3 Origin;
  std::array<int, 3> Count{};
  std::vector<std::array<int, 3>> Cubes;
  std::vector<double> Points;
  std::unordered_map<std::size_t, std::size_t> Numbers;
};

using Corners = std::array<Vector3, 4>;

/// Draws the labels within a tetrahedron at its new position.
void PaintTetrahedron(const Corners& from, const Corners& to, const LabelVolume& labels,
  LabelVolume& painted)
{
  const Vector3 a = to[1] - to[0];
  const Vector3 b = to[2] - to[0];
  const Vector3 c = to[3] - to[0];
  const double volume = Dot(a, Cross(b, c));
  if (!(std::abs(volume) > 1e-9))
  {
    return;
  }
  std::array<int, 3> first{};
  std::array<int, 3> last{};
  Vector3 low{ 1e30, 1e30, 1e30 };
  Vector3 high{ -1e30, -1e30, -1e30 };
  for (const Vector3& corner : to)
  {
    const Vector3 index = painted.ContinuousIndex(corner);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      low[axis] = std::min(low[axis], index[axis]);
      high[axis] = std::max(high[axis], index[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    first[axis] = std::max(0, static_cast<int>(std::ceil(low[axis])));
    last[axis] = std::min(painted.Size[axis] - 1, static_cast<int>(std::floor(high[axis])));
  }
  for (int k = first[2]; k <= last[2]; ++k)
  {
    for (int j = first[1]; j <= last[1]; ++j)
    {
      for (int i = first[0]; i <= last[0]; ++i)
      {
        const Vector3 offset = painted.PointAt(i, j, k) - to[0];
        const double u = Dot(offset, Cross(b, c)) / volume;
        const double v = Dot(a, Cross(offset, c)) / volume;
        const double w = Dot(a, Cross(b, offset)) / volume;
        // Neighbours may share a face: painted twice, the same.
        constexpr double Edge = -1e-9;
        if (u < Edge || v < Edge || w < Edge || u + v + w > 1 - Edge)
        {
          continue;
        }
        const Vector3 place = (1 - u - v - w) * from[0] + u * from[1] + v * from[2] + w * from[3];
        if (const std::uint16_t label = labels.LabelAt(place); label != 0)
        {
          painted.Voxels[painted.Index(i, j, k)] = label;
        }
      }
    }
  }
}

/// The six tetrahedra of a cube around its diagonal (Kuhn 1960): corners by their bits.
constexpr std::array<std::array<int, 4>, 6> CubeTetrahedra{ { { 0, 1, 3, 7 }, { 0, 1, 5, 7 },
  { 0, 2, 3, 7 }, { 0, 2, 6, 7 }, { 0, 4, 5, 7 }, { 0, 4, 6, 7 } } };
}

LabelVolume MoveLabels(const LabelVolume& labels, const PointMotion& motion, const VolumeGrid& grid,
  const ProgressCallback& progress)
{
  Lattice lattice(labels);
  std::vector<std::array<std::size_t, 8>> cubes;
  for (const std::array<int, 3>& cube : lattice.Cubes)
  {
    std::array<std::size_t, 8>& corners = cubes.emplace_back();
    for (int corner = 0; corner < 8; ++corner)
    {
      corners[static_cast<std::size_t>(corner)] = lattice.Corner(
        { cube[0] + (corner & 1), cube[1] + (corner >> 1 & 1), cube[2] + (corner >> 2 & 1) },
        labels);
    }
  }
  const std::vector<double> moved = motion(lattice.Points);
  const auto at = [](const std::vector<double>& points, std::size_t number) {
    return Vector3{ points[3 * number], points[3 * number + 1], points[3 * number + 2] };
  };

  LabelVolume painted;
  static_cast<VolumeGrid&>(painted) = grid;
  painted.Voxels.assign(static_cast<std::size_t>(grid.Size[0]) * grid.Size[1] * grid.Size[2], 0);
  for (std::size_t cube = 0; cube < cubes.size(); ++cube)
  {
    if (cube % 1000 == 0)
    {
      ReportProgress(progress, static_cast<double>(cube) / static_cast<double>(cubes.size()),
        "moving the tissue");
    }
    for (const std::array<int, 4>& tetrahedron : CubeTetrahedra)
    {
      Corners from;
      Corners to;
      for (std::size_t corner = 0; corner < 4; ++corner)
      {
        const std::size_t number = cubes[cube][static_cast<std::size_t>(tetrahedron[corner])];
        from[corner] = at(lattice.Points, number);
        to[corner] = at(moved, number);
      }
      PaintTetrahedron(from, to, labels, painted);
    }
  }
  return painted;
}

std::vector<Tissue> TissuesOf(const MaterialTable& table)
{
  std::vector<Tissue> tissues(table.Materials.size(), Tissue::Gland);
  tissues[0] = Tissue::Air;
  for (std::size_t index = 1; index < tissues.size(); ++index)
  {
    const Material& material = table.Materials[index];
    tissues[index] = material.Fixed       ? Tissue::Muscle
      : material.Thin                     ? Tissue::Skin
      : material.Attenuation == "adipose" ? Tissue::Fat
                                          : Tissue::Gland;
  }
  return tissues;
}

namespace
{
/// Tissue of the body at a depth behind the front of its chest wall, mm; the skin lies in front.
Tissue BodyAt(const Vector3& at, double depth)
{
  // Subcutaneous fat and skin of the chest between and around breasts; pectoral muscle 12 mm, ribs
  // of 12 mm every 28 mm, falling outwards by a third.
  constexpr double SkinMm = 2;
  constexpr double FatMm = 8;
  constexpr double MuscleMm = 12;
  constexpr double RibMm = 12;
  if (depth < -FatMm)
  {
    return depth < -FatMm - SkinMm ? Tissue::Air : Tissue::Skin;
  }
  if (depth < 0)
  {
    return Tissue::Fat;
  }
  if (depth < MuscleMm)
  {
    return Tissue::Muscle;
  }
  const double phase = (at[2] + std::abs(at[0]) / 3) / 28;
  const bool rib = std::abs(at[0]) < 18 || phase - std::floor(phase) < 0.43;
  if (depth < MuscleMm + RibMm)
  {
    return rib ? Tissue::Bone : Tissue::Muscle;
  }
  // The heart behind the breastbone, a little to the left.
  const double heart = std::hypot((at[0] - 25) / 50, (depth - 75) / 40, at[2] / 60);
  return heart < 1 ? Tissue::Muscle : Tissue::Lung;
}
}

LabelVolume JoinBody(const LabelVolume& breast, const std::vector<Tissue>& tissues,
  const ChestCurve& curve, double wallMm, bool both)
{
  LabelVolume patient = breast;
  const double halfWidth = both ? 170 : 1e9;
  breast.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      const Vector3 at = breast.PointAt(i, j, k);
      const int mirrored = breast.Size[0] - 1 - i;
      std::uint16_t material = breast.Voxels[index];
      if (material == 0 && both)
      {
        material = breast.Voxels[breast.Index(mirrored, j, k)];
      }
      Tissue tissue = tissues[material];
      // The flanks fall off to the sides.
      const double beyond = std::max(0.0, std::abs(at[0]) - 140);
      const double front = curve.At(at[0]) - wallMm + beyond * beyond / 60;
      if (std::abs(at[0]) < halfWidth)
      {
        const Tissue body = BodyAt(at, at[1] - front);
        const bool buried = tissue == Tissue::Skin && body != Tissue::Air && body != Tissue::Skin;
        tissue = tissue == Tissue::Air || buried ? body : tissue;
      }
      patient.Voxels[index] = static_cast<std::uint16_t>(tissue);
    });
  return patient;
}

double HeightMm(const LabelVolume& materials, const std::vector<bool>& held, const Vector3& axis)
{
  Extent range;
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t index)
    {
      const std::size_t material = materials.Voxels[index];
      if (material != 0 && !held[material])
      {
        range.Add(Dot(materials.PointAt(i, j, k), axis));
      }
    });
  return range.Length();
}

double WallThicknessMm(const LabelVolume& placed, const std::vector<bool>& held)
{
  double total = 0;
  double columns = 0;
  for (int k = 0; k < placed.Size[2]; ++k)
  {
    for (int i = 0; i < placed.Size[0]; ++i)
    {
      int count = 0;
      for (int j = 0; j < placed.Size[1]; ++j)
      {
        count += held[placed.Voxels[placed.Index(i, j, k)]] ? 1 : 0;
      }
      total += count * placed.Spacing[1];
      columns += count > 0 ? 1 : 0;
    }
  }
  return columns > 0 ? total / columns : 0;
}

double CubeEdgeMm(const LabelVolume& materials)
{
  const auto tissue = materials.Voxels.size() -
    static_cast<std::size_t>(std::count(materials.Voxels.begin(), materials.Voxels.end(), 0));
  return std::cbrt(static_cast<double>(tissue) * materials.VoxelVolume());
}

TetrahedralMesh MeshAnatomy(const LabelVolume& materials, const MaterialTable& table,
  double cellSizeMm, double smallestMm3, const ProgressCallback& progress)
{
  MeshingOptions options = MeshingOptions::Anatomy(table.Thin());
  // The facet sizes belong to a cell size of 4 mm.
  options.FacetSizeMm *= cellSizeMm / 4;
  options.CellSizeMm = cellSizeMm;
  options.SmallestComponentMm3 = smallestMm3;
  return MeshMaterials(materials, options, progress).Mesh;
}
}
