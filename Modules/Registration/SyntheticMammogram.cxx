// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/SyntheticMammogram.h"

#include "Private/ZScores.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
SyntheticMammogram Synthesize(EvaluatedState& breast, const RegistrationTarget& grid, int samples)
{
  SyntheticMammogram synthetic;
  const EvaluatedState::Picture& picture = breast.PictureOn(grid, samples);
  synthetic.LogAttenuation = picture.LogAttenuation;
  synthetic.InconsistentRays = picture.Lengths.NumberOfInconsistentRays();

  const ReceptorPoint centre = ChestWallCentre(grid);
  const auto directions = HalfCircleDirections(360);
  const std::vector<double>& radii = breast.SilhouetteFrom(centre, directions).Radii;
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    if (radii[index] > 0)
    {
      synthetic.Outline.push_back({ centre[0] + radii[index] * directions[index][0],
        centre[1] + radii[index] * directions[index][1] });
    }
  }
  return synthetic;
}

Agreement Compare(const SyntheticMammogram& synthetic, const RegistrationTarget& target)
{
  Agreement agreement;
  double distances = 0;
  double length = 0;
  // Weighted by arc length, so that dense directions near the centre do not count more.
  for (std::size_t index = 0; index + 1 < synthetic.Outline.size(); ++index)
  {
    const ReceptorPoint& a = synthetic.Outline[index];
    const ReceptorPoint& b = synthetic.Outline[index + 1];
    const ReceptorPoint middle{ 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) };
    if (!Contains(target, middle, 0) || middle[1] < target.OutlineFromMm)
    {
      continue;
    }
    const double arc = std::hypot(b[0] - a[0], b[1] - a[1]);
    const double distance = std::abs(SignedDistanceAt(target, middle));
    distances += arc * distance;
    length += arc;
    agreement.LargestOutlineDistanceMm = std::max(agreement.LargestOutlineDistanceMm, distance);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  agreement.MeanOutlineDistanceMm = length > 0 ? distances / length : nan;
  if (!(length > 0))
  {
    agreement.LargestOutlineDistanceMm = nan;
  }

  std::vector<std::size_t> pixels;
  for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
  {
    if (target.BreastMask[pixel] != 0 && !IsExcluded(target, pixel) &&
      synthetic.LogAttenuation[pixel] > 0)
    {
      pixels.push_back(pixel);
    }
  }
  if (!pixels.empty())
  {
    const ZScores a(synthetic.LogAttenuation, pixels);
    const ZScores b(target.LogAttenuation, pixels);
    for (std::size_t index = 0; index < pixels.size(); ++index)
    {
      agreement.Correlation += a.Scores[index] * b.Scores[index] / pixels.size();
    }
  }
  return agreement;
}
}
