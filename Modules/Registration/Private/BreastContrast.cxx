// SPDX-License-Identifier: Apache-2.0
#include "Private/BreastContrast.h"

#include "Private/AirLevel.h"
#include "Private/PixelFilters.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
std::vector<float> Select(const std::vector<float>& values, const PixelMask& mask)
{
  std::vector<float> selected;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (mask[i])
    {
      selected.push_back(values[i]);
    }
  }
  return selected;
}

/// Otsu (1979): the threshold that leaves the least variance within two classes.
float OtsuThreshold(const std::vector<float>& values, float low, float high)
{
  constexpr int Bins = 512;
  std::vector<double> histogram(Bins, 0.0);
  for (const float value : values)
  {
    const double bin = Bins * (static_cast<double>(value) - low) / (high - low);
    histogram[static_cast<std::size_t>(std::clamp(bin, 0.0, Bins - 1.0))] += 1;
  }
  double total = 0;
  for (int bin = 0; bin < Bins; ++bin)
  {
    total += bin * histogram[bin];
  }
  double weight = 0;
  double sum = 0;
  double best = -1;
  int bestFirst = 0;
  int bestLast = 0;
  const double count = static_cast<double>(values.size());
  for (int bin = 0; bin < Bins - 1; ++bin)
  {
    weight += histogram[bin];
    sum += bin * histogram[bin];
    if (weight == 0 || weight == count)
    {
      continue;
    }
    const double difference = sum / weight - (total - sum) / (count - weight);
    const double between = weight * (count - weight) * difference * difference;
    if (between > best)
    {
      best = between;
      bestFirst = bin;
    }
    // Empty bins between the classes are equally good: take their middle.
    if (between >= best)
    {
      bestLast = bin;
    }
  }
  return low + (high - low) * (0.5F * static_cast<float>(bestFirst + bestLast) + 1) / Bins;
}

/// More where more is absorbed, by what the header says. Air is not at 0 yet.
std::vector<float> ToLogAttenuation(const Mammogram& mammogram, RegistrationTarget& target)
{
  using Relationship = Mammogram::Relationship;
  const bool processing = mammogram.PresentationIntent == Mammogram::Intent::ForProcessing;
  Relationship relationship = mammogram.IntensityRelationship;
  if (relationship == Relationship::Unknown && processing)
  {
    relationship = Relationship::Linear;
    target.Warnings.push_back(
      "The header does not say how stored values follow X-ray intensity; a For "
      "Processing image is taken as linear.");
  }
  if (relationship == Relationship::Logarithmic && processing)
  {
    target.Warnings.push_back(
      "The header calls this For Processing image logarithmic: its values are used "
      "as log attenuation up to scale and offset.");
  }
  // Small values shown bright: they are where little got through. What is made to be looked at is
  // shown right, whatever else its header says.
  const int bySign = mammogram.IntensitySign;
  const int byDisplay = mammogram.InvertedForDisplay ? 1 : -1;
  const int sign = bySign != 0 && processing ? bySign : byDisplay;
  if (bySign != 0 && bySign != byDisplay && !processing)
  {
    target.Disagreements.emplace_back(
      "Pixel Intensity Relationship Sign contradicts the photometric interpretation of this For "
      "Presentation image; the latter is followed.");
  }
  std::vector<float> result(mammogram.Pixels.size());
  if (relationship != Relationship::Linear || !processing)
  {
    std::transform(mammogram.Pixels.begin(), mammogram.Pixels.end(), result.begin(),
      [sign](float value) { return static_cast<float>(-sign) * value; });
    return result;
  }
  if (sign < 0)
  {
    // Linear and falling with intensity: counts are what is missing to the largest stored value.
    target.Warnings.push_back(
      "Stored values fall linearly with X-ray intensity; they are subtracted from "
      "the largest value the stored bits can hold.");
  }
  const float full = std::ldexp(1.0F, mammogram.BitsStored) - 1;
  // Half a count stands for none, so that dead pixels stay finite.
  std::transform(mammogram.Pixels.begin(), mammogram.Pixels.end(), result.begin(),
    [sign, full](float value) {
      return std::isnan(value) ? value : -std::log(std::max(sign > 0 ? value : full - value, 0.5F));
    });
  return result;
}

/// Air that lies away from what is as bright as `threshold`, if there is enough of it.
PixelMask FarAir(const PixelGrid& grid, const std::vector<float>& smooth, const PixelMask& measured,
  float threshold)
{
  constexpr float EdgeZoneMm = 5; // the bulge's edge and the scatter beside it
  PixelMask air(smooth.size());
  for (std::size_t i = 0; i < smooth.size(); ++i)
  {
    air[i] = measured[i] && smooth[i] < threshold ? 1 : 0;
  }
  const std::vector<float> depth = DistanceToClear(grid, air);
  PixelMask farAir(smooth.size());
  std::transform(depth.begin(), depth.end(), farAir.begin(),
    [](float distance) { return distance > EdgeZoneMm ? 1 : 0; });
  constexpr std::ptrdiff_t Enough = 64;
  return std::count(farAir.begin(), farAir.end(), 1) < Enough ? air : farAir;
}

/// A level for each pixel taken from its value.
void Subtract(const PixelGrid& grid, const AirLevel& level, double (AirLevel::*at)(int, int) const,
  std::vector<float>& values)
{
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      values[grid.Index(column, row)] -= static_cast<float>((level.*at)(column, row));
    }
  }
}

/// Brings air to 0, in the picture and in its medians, and finds where the breast begins. What is
/// above `threshold` is breast, though not yet all of it.
void FlattenAir(const PixelGrid& grid, const PixelMask& measured, float threshold,
  const TargetOptions& options, BreastContrast& contrast)
{
  const std::vector<float> smooth = contrast.Smooth;
  PixelMask body(smooth.size());
  for (std::size_t i = 0; i < smooth.size(); ++i)
  {
    body[i] = measured[i] && smooth[i] >= threshold ? 1 : 0;
  }
  const PixelMask air = FarAir(grid, smooth, measured, threshold);
  const std::vector<float> bodyValues = Select(smooth, body);
  const std::vector<float> airValues = Select(smooth, air);
  if (airValues.empty() || bodyValues.empty())
  {
    throw InputError("mammogram: expected a breast and air, found only one of them");
  }
  double breast = QuantileElement(bodyValues, 0.5) - QuantileElement(airValues, 0.5);
  const auto flattenBy = [&](const PixelMask& trusted)
  {
    AirLevel level(grid, smooth, trusted, breast);
    contrast.Smooth = smooth;
    Subtract(grid, level, &AirLevel::LocalAt, contrast.Smooth);
    breast = QuantileElement(Select(contrast.Smooth, body), 0.5);
    contrast.EdgeLevel = static_cast<float>(
      std::max(options.EdgeFraction * breast, options.EdgeSigmas * level.Sigma()));
    return level;
  };
  // All that is below Otsu's threshold holds the thin margin of the breast, too; what is below the
  // edge over the level found of that does not.
  flattenBy(air);
  const AirLevel level = flattenBy(FarAir(grid, contrast.Smooth, measured, contrast.EdgeLevel));
  Subtract(grid, level, &AirLevel::At, contrast.LogAttenuation);
}
}

BreastContrast FindBreastContrast(const Mammogram& mammogram, const PixelGrid& grid,
  const TargetOptions& options, RegistrationTarget& target)
{
  BreastContrast contrast;
  std::vector<float>& log = contrast.LogAttenuation;
  log = ToLogAttenuation(mammogram, target);
  // Padding was not exposed: it is no breast, and takes the air's value below.
  PixelMask measured(log.size());
  std::transform(log.begin(), log.end(), measured.begin(),
    [](float value) { return std::isfinite(value) ? 1 : 0; });
  const std::vector<float> valid = Select(log, measured);
  if (valid.empty())
  {
    throw InputError("mammogram: expected a picture, found padding only");
  }
  const float low = QuantileElement(valid, 0.001);
  const float high = QuantileElement(valid, 0.999);
  if (!(high > low))
  {
    throw InputError("mammogram: expected a breast and air, found a flat picture");
  }
  for (std::size_t i = 0; i < log.size(); ++i)
  {
    log[i] = measured[i] ? log[i] : low;
  }
  contrast.Smooth = Median3x3(grid, log);
  FlattenAir(grid, measured, OtsuThreshold(valid, low, high), options, contrast);
  for (std::size_t i = 0; i < log.size(); ++i)
  {
    log[i] = measured[i] ? log[i] : 0.0F;
    contrast.Smooth[i] = measured[i] ? contrast.Smooth[i] : 0.0F;
  }
  return contrast;
}
}
