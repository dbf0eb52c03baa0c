// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/LabelEditing.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace mammoray
{
namespace
{
/// Old voxels that overlap a new voxel along one axis, with their fractions of it.
struct Footprint
{
  int First = 0;
  std::vector<double> Shares;
};

std::vector<Footprint> FootprintsAlong(int oldSize, double oldSpacing, double newSpacing)
{
  const double ratio = newSpacing / oldSpacing;
  // 1e-6 of a voxel: rounding must not turn 449 * 0.2 / 0.5 into one more voxel.
  const double newSize = std::max(1.0, std::ceil(oldSize / ratio - 1e-6));
  if (!(newSize <= std::numeric_limits<int>::max()))
  {
    throw InputError("spacing " + std::to_string(newSpacing) + " mm: expected a coarser one");
  }
  std::vector<Footprint> footprints(static_cast<std::size_t>(newSize));
  for (std::size_t voxel = 0; voxel < footprints.size(); ++voxel)
  {
    const double low = static_cast<double>(voxel) * ratio;
    const double high = low + ratio;
    Footprint& footprint = footprints[voxel];
    footprint.First = std::min(static_cast<int>(low), oldSize - 1);
    for (int old = footprint.First; old < oldSize && old < high; ++old)
    {
      footprint.Shares.push_back(
        std::max(0.0, std::min<double>(high, old + 1) - std::max<double>(low, old)) / ratio);
    }
  }
  return footprints;
}

/// True if all voxels of a footprint have the same label.
bool IsUniform(const LabelVolume& labels, const Footprint& fx, const Footprint& fy,
  const Footprint& fz)
{
  const std::uint16_t label = labels.Voxels[labels.Index(fx.First, fy.First, fz.First)];
  for (std::size_t k = 0; k < fz.Shares.size(); ++k)
  {
    for (std::size_t j = 0; j < fy.Shares.size(); ++j)
    {
      const std::uint16_t* row = &labels.Voxels[labels.Index(fx.First,
        fy.First + static_cast<int>(j), fz.First + static_cast<int>(k))];
      for (std::size_t i = 0; i < fx.Shares.size(); ++i)
      {
        if (row[i] != label)
        {
          return false;
        }
      }
    }
  }
  return true;
}

std::string BoxText(const VoxelBox& box)
{
  std::string text;
  for (int a = 0; a < 3; ++a)
  {
    text += (a > 0 ? " " : "") + std::to_string(box.First[a]) + ":" + std::to_string(box.Last[a]);
  }
  return text;
}

constexpr float Far = std::numeric_limits<float>::infinity();

bool IsFixed(const std::vector<bool>& fixed, std::uint16_t label)
{
  return label < fixed.size() && fixed[label];
}

/// 1 for label 0 that is connected with the border of the volume.
std::vector<unsigned char> FindOuterAir(const LabelVolume& labels)
{
  const RasterShape shape(labels);
  const RasterPieces pieces = FindPieces(shape, labels.Voxels);
  const std::vector<bool> outer = PiecesAtBorder(shape, pieces);
  std::vector<unsigned char> air(labels.Voxels.size());
  for (std::size_t voxel = 0; voxel < air.size(); ++voxel)
  {
    air[voxel] = labels.Voxels[voxel] == 0 && outer[pieces.Of[voxel]] ? 1 : 0;
  }
  return air;
}
}

LabelVolume ResampleLabels(const LabelVolume& labels, double spacingMm)
{
  labels.Validate("volume to resample");
  if (!(spacingMm > 0) || !std::isfinite(spacingMm))
  {
    throw InputError(
      "spacing: expected a positive number of mm, found " + std::to_string(spacingMm));
  }
  LabelVolume result;
  static_cast<VolumeGrid&>(result) = labels;
  result.Names = labels.Names;
  std::array<std::vector<Footprint>, 3> footprints;
  double voxelCount = 1;
  for (int a = 0; a < 3; ++a)
  {
    footprints[a] = FootprintsAlong(labels.Size[a], labels.Spacing[a], spacingMm);
    result.Size[a] = static_cast<int>(footprints[a].size());
    result.Spacing[a] = spacingMm;
    result.Origin = result.Origin + (0.5 * (spacingMm - labels.Spacing[a])) * labels.Direction[a];
    voxelCount *= result.Size[a];
  }
  if (voxelCount > 4e9)
  {
    throw InputError("spacing " + std::to_string(spacingMm) +
      " mm: expected a coarser one, this makes " + std::to_string(voxelCount) + " voxels");
  }
  result.Voxels.assign(static_cast<std::size_t>(voxelCount), 0);
  std::vector<double> votes(65536, 0.0);
  std::vector<std::uint16_t> candidates;
  std::size_t voxel = 0;
  for (const Footprint& fz : footprints[2])
  {
    for (const Footprint& fy : footprints[1])
    {
      for (const Footprint& fx : footprints[0])
      {
        // The last voxels may extend beyond the volume.
        if (&fx != &footprints[0].back() && &fy != &footprints[1].back() &&
          &fz != &footprints[2].back() && IsUniform(labels, fx, fy, fz))
        {
          result.Voxels[voxel++] = labels.Voxels[labels.Index(fx.First, fy.First, fz.First)];
          continue;
        }
        double inside = 0;
        candidates.clear();
        for (std::size_t k = 0; k < fz.Shares.size(); ++k)
        {
          for (std::size_t j = 0; j < fy.Shares.size(); ++j)
          {
            const double shareJK = fy.Shares[j] * fz.Shares[k];
            const std::uint16_t* row = &labels.Voxels[labels.Index(fx.First,
              fy.First + static_cast<int>(j), fz.First + static_cast<int>(k))];
            for (std::size_t i = 0; i < fx.Shares.size(); ++i)
            {
              const double share = fx.Shares[i] * shareJK;
              if (share > 0 && votes[row[i]] == 0)
              {
                candidates.push_back(row[i]);
              }
              votes[row[i]] += share;
              inside += share;
            }
          }
        }
        if (inside < 1 - 1e-9)
        {
          candidates.push_back(0);
          votes[0] += 1 - inside;
        }
        std::sort(candidates.begin(), candidates.end());
        double most = 0;
        for (const std::uint16_t label : candidates)
        {
          // 1e-9: equal shares that are summed in another order differ by rounding.
          if (votes[label] > most + 1e-9)
          {
            most = votes[label];
            result.Voxels[voxel] = label;
          }
          votes[label] = 0;
        }
        ++voxel;
      }
    }
  }
  return result;
}

VoxelBox FindTissueBox(const LabelVolume& labels)
{
  labels.Validate("volume to crop");
  VoxelBox box{ labels.Size, { -1, -1, -1 } };
  labels.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (labels.Voxels[voxel] != 0)
      {
        const int index[3] = { i, j, k };
        for (int a = 0; a < 3; ++a)
        {
          box.First[a] = std::min(box.First[a], index[a]);
          box.Last[a] = std::max(box.Last[a], index[a]);
        }
      }
    });
  if (box.Last[0] < 0)
  {
    throw InputError("volume to crop: expected labels other than 0, found none");
  }
  return box;
}

LabelVolume CropToTissue(const LabelVolume& labels, int marginVoxels)
{
  VoxelBox box = FindTissueBox(labels);
  for (int a = 0; a < 3; ++a)
  {
    box.First[a] = std::max(0, box.First[a] - std::max(0, marginVoxels));
    box.Last[a] = std::min(labels.Size[a] - 1, box.Last[a] + std::max(0, marginVoxels));
  }
  return CropToBox(labels, box);
}

LabelVolume CropToBox(const LabelVolume& labels, const VoxelBox& box)
{
  labels.Validate("volume to crop");
  LabelVolume result;
  static_cast<VolumeGrid&>(result) = labels;
  result.Names = labels.Names;
  for (int a = 0; a < 3; ++a)
  {
    if (box.First[a] < 0 || box.First[a] > box.Last[a] || box.Last[a] >= labels.Size[a])
    {
      throw InputError("crop " + BoxText(box) + ": expected a box within the volume's voxels " +
        BoxText({ { 0, 0, 0 }, { labels.Size[0] - 1, labels.Size[1] - 1, labels.Size[2] - 1 } }));
    }
    result.Size[a] = box.Last[a] - box.First[a] + 1;
  }
  result.Origin = labels.PointAt(box.First[0], box.First[1], box.First[2]);
  result.Voxels.reserve(static_cast<std::size_t>(result.Size[0]) * result.Size[1] * result.Size[2]);
  for (int k = box.First[2]; k <= box.Last[2]; ++k)
  {
    for (int j = box.First[1]; j <= box.Last[1]; ++j)
    {
      const auto row =
        labels.Voxels.begin() + static_cast<std::ptrdiff_t>(labels.Index(box.First[0], j, k));
      result.Voxels.insert(result.Voxels.end(), row, row + result.Size[0]);
    }
  }
  return result;
}

std::vector<float> DepthBelowAir(const LabelVolume& labels, double reachMm,
  const std::vector<bool>& fixed)
{
  const std::vector<unsigned char> air = FindOuterAir(labels);
  const RasterShape shape(labels);
  // Distances to half of each voxel of air that touches tissue, which is the nearest air.
  std::vector<unsigned char> nearest(labels.Voxels.size(), 0);
  for (std::size_t voxel = 0; voxel < nearest.size(); ++voxel)
  {
    if (air[voxel])
    {
      shape.ForEachNeighbour(voxel,
        [&](std::size_t other, int)
        {
          const std::uint16_t label = labels.Voxels[other];
          nearest[voxel] = nearest[voxel] || (label != 0 && !IsFixed(fixed, label)) ? 1 : 0;
        });
    }
  }
  std::vector<float> depth = DistanceToSet(shape, labels.Spacing, nearest, 0.25);
  // 1e-5: a depth of the reach itself shall not be lost to rounding.
  const auto most = static_cast<float>(reachMm * (1 + 1e-5));
  for (std::size_t voxel = 0; voxel < depth.size(); ++voxel)
  {
    depth[voxel] = air[voxel] ? 0.0f : depth[voxel] <= most ? depth[voxel] : Far;
  }
  return depth;
}

LabelVolume AddSkin(const LabelVolume& labels, double thicknessMm, int skin,
  const std::vector<bool>& fixed)
{
  labels.Validate("volume for a skin");
  const double coarsest = *std::max_element(labels.Spacing.begin(), labels.Spacing.end());
  if (!(thicknessMm >= coarsest) || !std::isfinite(thicknessMm))
  {
    std::ostringstream text;
    text << "skin of " << thicknessMm << " mm: expected at least the voxel spacing, " << coarsest
         << " mm; a smaller spacing allows a thinner skin";
    throw InputError(text.str());
  }
  if (skin < 1 || skin > 65535 || IsFixed(fixed, static_cast<std::uint16_t>(skin)))
  {
    throw InputError(
      "skin: expected a label of tissue that is not fixed, found " + std::to_string(skin));
  }
  const std::vector<float> depth = DepthBelowAir(labels, thicknessMm, fixed);
  LabelVolume result = labels;
  for (std::size_t voxel = 0; voxel < depth.size(); ++voxel)
  {
    std::uint16_t& label = result.Voxels[voxel];
    if (label != 0 && !IsFixed(fixed, label) && depth[voxel] != Far)
    {
      label = static_cast<std::uint16_t>(skin);
    }
  }
  return result;
}
}
