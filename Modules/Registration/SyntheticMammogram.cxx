// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationResult.h"

#include "Private/PixelFilters.h"
#include "Private/Silhouette.h"
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
/// Directions in which outlines are drawn and measured.
std::vector<ReceptorPoint> DrawnDirections()
{
  return HalfCircleDirections(360);
}
}

SyntheticMammogram Synthesize(PosedBreast& breast, const ReceptorGrid& grid,
  const ReceptorPoint& centre, int samples)
{
  SyntheticMammogram synthetic;
  const PosedBreast::Picture& picture = breast.PictureOn(grid, samples);
  synthetic.LogAttenuation = picture.LogAttenuation;
  synthetic.InconsistentRays = picture.Lengths.NumberOfInconsistentRays();

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
/// Radius of a receptor's edge, mm: the outline bends away there.
constexpr double RoundedEdgeMm = 3;

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

/// Distances from an outline to the synthetic one: their integral along it, its length, and the
/// largest of them, mm. Weighted by arc length, so that dense directions near the centre do not
/// count more.
struct OutlineDistances
{
  double Sum = 0;
  double Length = 0;
  double Largest = 0;

  OutlineDistances(const std::vector<std::optional<ReceptorPoint>>& outline,
    const std::vector<ReceptorPoint>& synthetic)
  {
    for (std::size_t index = 0; index + 1 < outline.size() && !synthetic.empty(); ++index)
    {
      if (!outline[index] || !outline[index + 1])
      {
        continue;
      }
      const ReceptorPoint& a = *outline[index];
      const ReceptorPoint& b = *outline[index + 1];
      const double arc = std::hypot(b[0] - a[0], b[1] - a[1]);
      const double distance =
        DistanceToLine({ 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) }, synthetic);
      this->Sum += arc * distance;
      this->Length += arc;
      this->Largest = std::max(this->Largest, distance);
    }
  }
};

void CompareOutlines(const SyntheticMammogram& synthetic, const RegistrationTarget& target,
  Similarity& agreement)
{
  const ReceptorPoint centre = ChestWallCentre(target);
  const auto outlineOf = [&](const RegistrationTarget& from)
  { return OutlineAlong(from, centre, DrawnDirections()); };
  const OutlineDistances compared(outlineOf(target), synthetic.Outline);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  agreement.MeanOutlineDistanceMm = compared.Length > 0 ? compared.Sum / compared.Length : nan;
  RegistrationTarget whole = target;
  whole.OutlineFromMm = std::min(target.OutlineFromMm, RoundedEdgeMm);
  agreement.LargestOutlineDistanceMm =
    compared.Length > 0 ? OutlineDistances(outlineOf(whole), synthetic.Outline).Largest : nan;
}
}

namespace
{
/// Half of the distance of the plates is 15 to 40 mm: there a breast bulges out between them.
constexpr double BulgeMm = 20;
constexpr double TissuePixelMm = 1.5;
constexpr double DetailMm = 3;
constexpr double LeastAreaMm2 = 100;

/// Pearson's, of the values at some pixels, at least one.
double CorrelationAt(const std::vector<std::size_t>& pixels, const std::vector<float>& first,
  const std::vector<float>& second)
{
  const ZScores a(first, pixels);
  const ZScores b(second, pixels);
  double sum = 0;
  for (std::size_t index = 0; index < pixels.size(); ++index)
  {
    sum += a.Scores[index] * b.Scores[index];
  }
  return sum / static_cast<double>(pixels.size());
}

/// Correlation of the tissue (Similarity::TissueCorrelation), in pixels large enough for low noise
/// that are breast in both pictures and not excluded.
double CorrelateTissue(const SyntheticMammogram& synthetic, const RegistrationTarget& target)
{
  const RegistrationTarget real = CoarsenTo(target, TissuePixelMm);
  RegistrationTarget fine = target;
  fine.LogAttenuation = synthetic.LogAttenuation;
  const std::vector<float> model = CoarsenTo(fine, TissuePixelMm).LogAttenuation;
  const PixelGrid grid{ real.Grid.Columns, real.Grid.Rows, real.Grid.ColumnSpacingMm(),
    real.Grid.RowSpacingMm() };
  PixelMask mask(grid.Count(), 0);
  double deepest = 0;
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    mask[pixel] = real.BreastMask[pixel] != 0 && !IsExcluded(real, pixel) && model[pixel] > 0;
    deepest = mask[pixel] != 0
      ? std::max(deepest, -static_cast<double>(real.SignedDistanceMm[pixel]))
      : deepest;
  }
  std::vector<std::size_t> inner;
  for (std::size_t pixel = 0; pixel < mask.size(); ++pixel)
  {
    if (mask[pixel] != 0 && -real.SignedDistanceMm[pixel] >= std::min(BulgeMm, 0.5 * deepest))
    {
      inner.push_back(pixel);
    }
  }
  if (static_cast<double>(inner.size()) * grid.ColumnSpacing * grid.RowSpacing < LeastAreaMm2)
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return CorrelationAt(inner, Details(grid, model, mask, DetailMm),
    Details(grid, real.LogAttenuation, mask, DetailMm));
}
}

Similarity Compare(const SyntheticMammogram& synthetic, const RegistrationTarget& target)
{
  Similarity agreement;
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
  agreement.TissueCorrelation = CorrelateTissue(synthetic, target);
  if (!pixels.empty())
  {
    agreement.Correlation = CorrelationAt(pixels, synthetic.LogAttenuation, target.LogAttenuation);
  }
  return agreement;
}
}
