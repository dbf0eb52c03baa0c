// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/LabelSkin.h"

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
