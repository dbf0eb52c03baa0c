// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/LabelSource.h"

#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

namespace mammoray
{
namespace
{
/// Depth of the layer that continues cut tissue: more than half a side of the coarsest simulation
/// cells, beside which it is looked for.
constexpr double LayerMm = 20;

VoxelBox ParseBox(const std::vector<std::string>& texts, const std::array<int, 3>& size)
{
  VoxelBox box;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const std::string text = a < texts.size() ? texts[a] : "";
    const auto colon = text.find(':');
    box.Last[a] = size[a] - 1;
    if (texts.size() != 3 || colon == std::string::npos ||
      (colon > 0 && !ToNumber(text.substr(0, colon), box.First[a])) ||
      (colon + 1 < text.size() && !ToNumber(text.substr(colon + 1), box.Last[a])))
    {
      std::string found;
      for (const std::string& word : texts)
      {
        found += (found.empty() ? "" : " ") + word;
      }
      throw InputError("crop: expected FIRST:LAST voxels along i, j and k, for example "
                       "0:199 : 12:, found '" +
        found + "'");
    }
  }
  return box;
}

LabelVolume WithSkin(const LabelVolume& materials, const std::string& text,
  const MaterialTable& table)
{
  const auto equals = text.find('=');
  double thicknessMm = 0;
  if (!ToNumber(text.substr(0, equals), thicknessMm))
  {
    throw InputError(
      "skin: expected THICKNESS or THICKNESS=MATERIAL in mm, for example 1.5=skin, found '" + text +
      "'");
  }
  const std::vector<bool> fixed = table.Fixed();
  const std::vector<int> thin = table.Thin();
  if (equals == std::string::npos && thin.size() != 1)
  {
    throw InputError("skin: expected THICKNESS=MATERIAL, since the table '" + table.Name +
      "' has " + std::to_string(thin.size()) + " thin materials, found '" + text + "'");
  }
  const int skin =
    equals == std::string::npos ? thin.front() : table.IndexOf(text.substr(equals + 1));
  return AddSkin(materials, thicknessMm, skin, fixed);
}

/// Without what lies beyond the tissue at some sides.
LabelVolume CutAt(const LabelVolume& materials, const std::vector<std::string>& sides)
{
  const VoxelBox tissue = FindTissueBox(materials);
  VoxelBox kept{ { 0, 0, 0 }, materials.Size };
  std::for_each(kept.Last.begin(), kept.Last.end(), [](int& last) { --last; });
  for (const std::string& side : sides)
  {
    const auto [axis, atEnd] = FindGridSide(side);
    (atEnd ? kept.Last : kept.First)[axis] = (atEnd ? tissue.Last : tissue.First)[axis];
  }
  return CropToBox(materials, kept);
}
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

LabelVolume ReadMaterials(const LabelSource& source, const MaterialTable& table)
{
  LabelVolume volume = ReadLabelVolume(source.Path, AxesOf(source.AxesAsGiven));
  if (!source.AcceptUnusual)
  {
    CheckValidRange(ValidRanges::VoxelSpacing, volume.Spacing, source.Path);
  }
  if (!source.Crop.empty())
  {
    volume = CropToBox(volume, ParseBox(source.Crop, volume.Size));
  }
  volume = table.ToMaterials(volume, source.Path);
  const double coarsest = *std::max_element(volume.Spacing.begin(), volume.Spacing.end());
  if (source.SpacingMm > 0 && !(source.OnlyCoarsen && source.SpacingMm <= coarsest))
  {
    volume = ResampleLabels(volume, source.SpacingMm);
  }
  if (!source.CutSides.empty())
  {
    volume = CutAt(volume, source.CutSides);
  }
  return source.Skin.empty() ? volume : WithSkin(volume, source.Skin, table);
}
}
