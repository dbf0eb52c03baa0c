// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/CutTissue.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace mammoray
{
namespace
{
/// Deeper than half a side of the coarsest simulation cells, beside which it is looked for.
constexpr double LayerMm = 20;
}

const std::vector<std::string>& GridSides()
{
  static const std::vector<std::string> sides{ "i-", "i+", "j-", "j+", "k-", "k+" };
  return sides;
}

GridSide FindGridSide(const std::string& name)
{
  const auto side = std::find(GridSides().begin(), GridSides().end(), name);
  if (side == GridSides().end())
  {
    throw InputError("cut side: expected i-, i+, j-, j+, k- or k+, found '" + name + "'");
  }
  const auto number = static_cast<std::size_t>(side - GridSides().begin());
  return { number / 2, number % 2 == 1 };
}

LabelVolume CutTissue(const LabelVolume& whole, const LabelVolume& kept, const MaterialTable& table,
  const std::vector<std::string>& sides)
{
  if (whole.Size != kept.Size || whole.Voxels.size() != kept.Voxels.size())
  {
    throw InputError("cut tissue: expected the whole and what is kept on one grid");
  }
  const VoxelBox box = FindTissueBox(whole);
  LabelVolume cut = whole;
  // The new grid's first voxel in the old one.
  std::array<int, 3> first = box.First;
  std::array<int, 3> last = box.Last;
  for (const std::string& side : sides)
  {
    const auto [axis, atEnd] = FindGridSide(side);
    const int layer = static_cast<int>(std::ceil(LayerMm / whole.Spacing[axis]));
    (atEnd ? last : first)[axis] += atEnd ? layer : -layer;
  }
  cut.Origin = whole.PointAt(first[0], first[1], first[2]);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    cut.Size[axis] = last[axis] - first[axis] + 1;
  }
  cut.Voxels.assign(static_cast<std::size_t>(cut.Size[0]) * cut.Size[1] * cut.Size[2], 0);
  cut.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const std::array<int, 3> at{ first[0] + i, first[1] + j, first[2] + k };
      std::array<int, 3> nearest = at;
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        nearest[axis] = std::clamp(at[axis], box.First[axis], box.Last[axis]);
      }
      const std::size_t from = whole.Index(nearest[0], nearest[1], nearest[2]);
      const std::uint16_t material = whole.Voxels[from];
      const bool goesOn = nearest == at ? kept.Voxels[from] == 0 : !table.Materials[material].Thin;
      cut.Voxels[voxel] = goesOn ? material : 0;
    });
  return cut;
}

BodyField InCutTissue(LabelVolume cut)
{
  return [shared = std::make_shared<const LabelVolume>(std::move(cut))](const Vector3& point)
  { return shared->LabelAt(point) != 0; };
}

BodyField InCutTissue(const LabelVolume& materials, const MaterialTable& table,
  const std::vector<std::string>& sides)
{
  return sides.empty() ? BodyField() : InCutTissue(CutTissue(materials, materials, table, sides));
}
}
