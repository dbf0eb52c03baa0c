// SPDX-License-Identifier: Apache-2.0
#include "Private/Plausibility.h"

#include "Private/SegmentationChecks.h"
#include "Private/Thresholds.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <cmath>

namespace mammoray
{
namespace
{
std::string Rounded(double value, double digits)
{
  return NumberText(std::round(value * digits) / digits);
}

void Refuse(bool bad, const std::string& expected, const std::string& found)
{
  if (bad)
  {
    throw InputError("MRI: expected " + expected + ", found " + found);
  }
}
}

void Measure(SegmentationResult& result)
{
  const double voxelCm3 = result.Labels.VoxelVolume() / 1000;
  std::vector<float> gland;
  std::vector<double> volumes(5, 0.0);
  for (std::size_t voxel = 0; voxel < result.Labels.Voxels.size(); ++voxel)
  {
    const std::uint16_t label = result.Labels.Voxels[voxel];
    volumes[label] += voxelCm3;
    if (label == static_cast<std::uint16_t>(TissueLabel::Gland))
    {
      gland.push_back(result.Corrected.Voxels[voxel]);
    }
  }
  BreastMeasures& measures = result.Measures;
  measures.FatCm3 = volumes[static_cast<std::size_t>(TissueLabel::Fat)];
  measures.GlandCm3 = volumes[static_cast<std::size_t>(TissueLabel::Gland)];
  measures.SkinCm3 = volumes[static_cast<std::size_t>(TissueLabel::Skin)];
  measures.ChestWallCm3 = volumes[static_cast<std::size_t>(TissueLabel::ChestWall)];
  const double breast = measures.FatCm3 + measures.GlandCm3 + measures.SkinCm3;
  measures.GlandFraction = breast > 0 ? measures.GlandCm3 / breast : 0.0;
  measures.GlandOverMuscle =
    gland.empty() || !(result.MuscleLevel > 0) ? 0.0 : Quantile(gland, 0.5) / result.MuscleLevel;
}

void Judge(SegmentationResult& result, int breasts, bool glandGiven)
{
  const BreastMeasures& measures = result.Measures;
  const double whole = measures.FatCm3 + measures.GlandCm3 + measures.SkinCm3;
  const double one = whole / breasts;
  const double fraction = measures.GlandFraction;
  Refuse(one < 15 || one > 5000, "15 to 5000 cm3 of a breast", Rounded(one, 1));
  Refuse(measures.DepthMm > 300, "a breast at most 300 mm before the chest wall",
    Rounded(measures.DepthMm, 1));
  Refuse(!glandGiven && fraction > 0.9, "at most 0.9 of gland", Rounded(fraction, 100));
  const auto warn = [&](bool unusual, const std::string& text)
  {
    if (unusual)
    {
      result.Warnings.push_back(text);
    }
  };
  warn(one < 60 || one > 3000, "a breast of " + Rounded(one, 1) + " cm3; most have 60 to 3000");
  warn(!glandGiven && (fraction < 0.005 || fraction > 0.6),
    "gland is " + Rounded(fraction, 1000) + " of the breast; most have 0.005 to 0.6");
  warn(3 * measures.SkinCm3 > whole,
    "skin is " + Rounded(measures.SkinCm3 / whole, 100) + " of the breast; most have a fifth");
  const double ratio = measures.GlandOverMuscle;
  warn(!glandGiven && ratio > 0 && (ratio > 2 || ratio < 0.5),
    "gland is " + Rounded(ratio, 10) +
      " times as bright as muscle, in T1 nearly as bright: another weighting, or gland thinner "
      "than the voxels?");
}
}
