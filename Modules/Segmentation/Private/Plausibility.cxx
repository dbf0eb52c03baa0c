// SPDX-License-Identifier: Apache-2.0
#include "Private/Plausibility.h"

#include "Private/Thresholds.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ValidRange.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace mammoray
{
namespace
{
/// Noise is measured in blocks of about 6 mm, and their averages need four of them along each axis.
constexpr double SmallestExtentMm = 30.0;

/// Smallest fractions of a breast's columns in which its borders must show. Of eight patients,
/// compared with slices drawn by hand, seven good ones have at least 0.56 of both wall's fractions,
/// the doubtful one 0.40 to 0.44 and 0.32 to 0.39.
constexpr double LeastWallSeen = 0.5;
constexpr double LeastWallAgreement = 0.35;
constexpr double LeastSkinSeen = 0.8;

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

void CheckImage(const IntensityVolume& image, bool acceptUnusual)
{
  image.Validate("MRI");
  if (!acceptUnusual)
  {
    CheckValidRange(ValidRanges::VoxelSpacing, image.Spacing, "MRI");
  }
  for (int a = 0; a < 3; ++a)
  {
    if (image.Size[a] < 8)
    {
      throw InputError("MRI: expected a volume of at least 8 voxels along each axis, found " +
        std::to_string(image.Size[0]) + " x " + std::to_string(image.Size[1]) + " x " +
        std::to_string(image.Size[2]));
    }
  }
  const auto [low, high] = std::minmax_element(image.Voxels.begin(), image.Voxels.end());
  if (*low == *high)
  {
    throw InputError(
      "MRI: expected air and tissue, found the intensity " + NumberText(*low) + " everywhere");
  }
  for (int a = 0; a < 3; ++a)
  {
    if (image.Size[a] * image.Spacing[a] < SmallestExtentMm)
    {
      throw InputError("MRI: expected a volume of at least " + NumberText(SmallestExtentMm) +
        " mm along each axis, found " + NumberText(image.Size[0] * image.Spacing[0]) + " x " +
        NumberText(image.Size[1] * image.Spacing[1]) + " x " +
        NumberText(image.Size[2] * image.Spacing[2]) + " mm");
    }
  }
}

void CheckSteps(const IntensityVolume& image, double airThreshold)
{
  constexpr std::size_t fewestMultiples = 16;
  float step = std::numeric_limits<float>::infinity();
  for (const float value : image.Voxels)
  {
    step = value > 0 ? std::min(step, value) : step;
  }
  if (!(airThreshold < static_cast<double>(step)))
  {
    return;
  }
  std::set<float> multiples;
  for (const float value : image.Voxels)
  {
    const float multiple = std::round(value / step);
    if (std::abs(value - multiple * step) > 1e-3f * step)
    {
      return;
    }
    if (multiples.size() < fewestMultiples)
    {
      multiples.insert(multiple);
    }
  }
  if (multiples.size() == fewestMultiples)
  {
    throw InputError("MRI: expected intensities in steps finer than the noise of air, found air to "
                     "end at " +
      NumberText(airThreshold) + " and steps of " + NumberText(step) +
      "; export it with its whole range of values");
  }
}

void CheckGlandThreshold(double given, bool fatBright)
{
  if (given > 0 && !IsThresholdOf(given, fatBright))
  {
    throw InputError("gland threshold: expected " +
      std::string(fatBright ? "less than 1 as fat is bright" : "more than 1 as fat is dark") +
      " in this MRI, found " + NumberText(given));
  }
}

void SegmentationOptions::Validate() const
{
  const auto check = [](bool good, const char* name, const char* expected, double found)
  {
    if (!good)
    {
      throw InputError(
        std::string(name) + ": expected " + expected + ", found " + NumberText(found));
    }
  };
  const auto atLeastZero = [](double value) { return value >= 0 && std::isfinite(value); };
  check(atLeastZero(this->SpacingMm), "spacing", "0 or a positive number of mm", this->SpacingMm);
  if (this->SpacingMm > 0 && !this->AcceptUnusual)
  {
    CheckValidRange(ValidRanges::VoxelSpacing, this->SpacingMm, "SpacingMm");
  }
  check(atLeastZero(this->SkinThicknessMm), "skin thickness", "0 or a positive number of mm",
    this->SkinThicknessMm);
  check(atLeastZero(this->ChestWallDepthMm) && this->ChestWallDepthMm > 0, "chest wall depth",
    "a positive number of mm", this->ChestWallDepthMm);
  check(this->Classes >= 2 && this->Classes <= 5, "classes", "2 to 5", this->Classes);
  check(atLeastZero(this->AirThreshold), "air threshold", "0 or a positive intensity",
    this->AirThreshold);
  const bool above = this->Contrast == FatContrast::FatDark && this->GlandThreshold > 1;
  check(above || (this->GlandThreshold >= 0 && this->GlandThreshold < 1), "gland threshold",
    "0 or a fraction of fat's intensity below 1 (fat suppressed: above 1)", this->GlandThreshold);
  check(atLeastZero(this->SmallestGlandMm3), "smallest gland", "0 or a positive number of mm3",
    this->SmallestGlandMm3);
}

BreastQuality QualityOf(BreastSide side, const ColumnCounts& columns, bool contrastIsClear)
{
  const auto share = [&](std::size_t count) {
    return columns.All == 0 ? 0.0 : static_cast<double>(count) / static_cast<double>(columns.All);
  };
  BreastQuality quality{ side, share(columns.Seen), share(columns.Agreeing), share(columns.Clear),
    "" };
  std::string faults = contrastIsClear
    ? ""
    : "the image does not tell whether fat is bright or dark (choose the contrast if you know it)";
  const auto require = [&faults](double least, double found, const std::string& what)
  {
    if (found < least)
    {
      faults += (faults.empty() ? "" : ", and ") + what + " in " + Rounded(found, 100) +
        " of its columns (expected " + NumberText(least) + ")";
    }
  };
  require(LeastWallSeen, quality.WallSeen, "the chest wall shows");
  require(LeastWallAgreement, quality.WallAgreement, "two ways to find the chest wall agree");
  require(LeastSkinSeen, quality.SkinSeen, "the skin stands out from the noise");
  if (!faults.empty())
  {
    quality.Doubt = std::string(side == BreastSide::Both ? "the breast"
                        : side == BreastSide::Left       ? "the left breast"
                                                         : "the right breast") +
      " is doubtful: " + faults;
  }
  return quality;
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
  for (const BreastQuality& quality : result.Quality)
  {
    warn(!quality.Doubt.empty(), quality.Doubt);
  }
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
