// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/SyntheticMammogram.h"

#include "Private/ZScores.h"
#include "mammoray/Foundation/Vector3.h"

#include "vtkLine.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
/// In which outlines are drawn and measured.
std::vector<ReceptorPoint> DrawnDirections()
{
  return HalfCircleDirections(360);
}
}

SyntheticMammogram Synthesize(EvaluatedState& breast, const RegistrationTarget& grid, int samples)
{
  SyntheticMammogram synthetic;
  const EvaluatedState::Picture& picture = breast.PictureOn(grid, samples);
  synthetic.LogAttenuation = picture.LogAttenuation;
  synthetic.InconsistentRays = picture.Lengths.NumberOfInconsistentRays();

  const ReceptorPoint centre = ChestWallCentre(grid);
  const auto directions = DrawnDirections();
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

namespace
{
/// From a point to a line of at least one point, mm.
double DistanceToLine(const ReceptorPoint& point, const std::vector<ReceptorPoint>& line)
{
  const auto inSpace = [](const ReceptorPoint& at) -> Vector3 { return { at[0], at[1], 0 }; };
  double least = std::hypot(point[0] - line[0][0], point[1] - line[0][1]);
  for (std::size_t index = 0; index + 1 < line.size(); ++index)
  {
    double along = 0;
    least = std::min(least,
      std::sqrt(vtkLine::DistanceToLine(inSpace(point).data(), inSpace(line[index]).data(),
        inSpace(line[index + 1]).data(), along, nullptr)));
  }
  return least;
}

void CompareOutlines(const SyntheticMammogram& synthetic, const RegistrationTarget& target,
  Agreement& agreement)
{
  const auto outline = OutlineAlong(target, ChestWallCentre(target), DrawnDirections());
  double distances = 0;
  double length = 0;
  // Weighted by arc length, so that dense directions near the centre do not count more.
  for (std::size_t index = 0; index + 1 < outline.size() && !synthetic.Outline.empty(); ++index)
  {
    if (!outline[index] || !outline[index + 1])
    {
      continue;
    }
    const ReceptorPoint& a = *outline[index];
    const ReceptorPoint& b = *outline[index + 1];
    const double arc = std::hypot(b[0] - a[0], b[1] - a[1]);
    const double distance =
      DistanceToLine({ 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) }, synthetic.Outline);
    distances += arc * distance;
    length += arc;
    agreement.LargestOutlineDistanceMm = std::max(agreement.LargestOutlineDistanceMm, distance);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  agreement.MeanOutlineDistanceMm = length > 0 ? distances / length : nan;
  agreement.LargestOutlineDistanceMm = length > 0 ? agreement.LargestOutlineDistanceMm : nan;
}
}

Agreement Compare(const SyntheticMammogram& synthetic, const RegistrationTarget& target)
{
  Agreement agreement;
  CompareOutlines(synthetic, target, agreement);
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
