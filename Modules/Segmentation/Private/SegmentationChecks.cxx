// SPDX-License-Identifier: Apache-2.0
#include "Private/SegmentationChecks.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/Segmentation/BreastSegmentation.h"

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
}
