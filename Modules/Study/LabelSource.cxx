// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/LabelSource.h"

#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/CutTissue.h"

#include <algorithm>

namespace mammoray
{
namespace
{
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
  const std::vector<bool> held = table.Fixed();
  const std::vector<int> thin = table.Thin();
  if (equals == std::string::npos && thin.size() != 1)
  {
    throw InputError("skin: expected THICKNESS=MATERIAL, since the table '" + table.Name +
      "' has " + std::to_string(thin.size()) + " thin materials, found '" + text + "'");
  }
  const int skin =
    equals == std::string::npos ? thin.front() : table.IndexOf(text.substr(equals + 1));
  return AddSkin(materials, thicknessMm, skin, held);
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
