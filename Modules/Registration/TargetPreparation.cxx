// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationTarget.h"

#include "Private/BreastContrast.h"
#include "Private/GantryGrid.h"
#include "Private/MammogramMask.h"
#include "Private/PixelFilters.h"
#include "Private/PixelMask.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

namespace mammoray
{
namespace
{
/// Excludes pectoral muscle and markers as TargetOptions requests.
void Exclude(const Mammogram& mammogram, double rollDeg, const TargetOptions& options,
  RegistrationTarget& target)
{
  const bool oblique = mammogram.View == "MLO" || mammogram.View == "LMO";
  if (options.ExcludePectoral && oblique)
  {
    const int headward = AlongX("H", rollDeg) > 0 ? 1 : -1;
    if (const std::optional<PectoralEdge> edge = FindPectoralEdge(target, headward))
    {
      ExcludePectoral(*edge, headward, target);
    }
  }
  if (options.ExcludeMarkers)
  {
    ExcludeSaturated(target);
  }
}

/// An odd number of fine pixels per pixel.
int RefinementFactor(double spacing, double wanted)
{
  const int factor = std::max(1, static_cast<int>(std::ceil(spacing / wanted - 1e-9)));
  return factor % 2 == 1 ? factor : factor + 1;
}

void Validate(const Mammogram& mammogram, const TargetOptions& options)
{
  const std::size_t count = mammogram.Columns > 0 && mammogram.Rows > 0
    ? static_cast<std::size_t>(mammogram.Columns) * static_cast<std::size_t>(mammogram.Rows)
    : 0;
  if (mammogram.Columns < 8 || mammogram.Rows < 8 || mammogram.Pixels.size() != count)
  {
    throw InputError("mammogram: expected at least 8 x 8 pixels and a value for each, found " +
      std::to_string(mammogram.Columns) + " x " + std::to_string(mammogram.Rows) + " with " +
      std::to_string(mammogram.Pixels.size()) + " values");
  }
  if (!(mammogram.ColumnSpacingMm > 0) || !(mammogram.RowSpacingMm > 0))
  {
    throw InputError("mammogram: expected positive pixel spacings");
  }
  if (!(options.EdgeFraction > 0 && options.EdgeFraction < 1) || !(options.EdgeSigmas > 0) ||
    !(options.OutlineGridMm > 0) || !(options.ThinnestFeatureMm >= 0) ||
    !(options.ChestWallMarginMm >= 0))
  {
    throw InputError(
      "target options: expected an edge fraction in (0, 1), positive edge sigmas and "
      "outline grid, and a thinnest feature and a chest-wall margin of 0 or more");
  }
}

/// The breast on a grid that is `Factor` times as fine as the mammogram's.
struct FineBreast
{
  PixelGrid Grid;
  int Factor = 1;
  /// The breast, and those of its pixels that are above the edge level rather than filled in.
  PixelMask Mask;
  PixelMask Seen;
};

FineBreast OutlineBreast(const PixelGrid& grid, BreastContrast& contrast,
  const TargetOptions& options)
{
  FineBreast breast;
  breast.Factor = std::max(RefinementFactor(grid.ColumnSpacing, options.OutlineGridMm),
    RefinementFactor(grid.RowSpacing, options.OutlineGridMm));
  breast.Grid = { grid.Columns * breast.Factor, grid.Rows * breast.Factor,
    grid.ColumnSpacing / breast.Factor, grid.RowSpacing / breast.Factor };
  const std::vector<float> image = Refine(grid, contrast.Smooth, breast.Grid, breast.Factor);
  breast.Seen.resize(image.size());
  std::transform(image.begin(), image.end(), breast.Seen.begin(),
    [edge = contrast.EdgeLevel](float value) { return value > edge ? 1 : 0; });
  breast.Mask = breast.Seen;
  FillDarkFrame(breast.Grid, breast.Mask);
  breast.Mask = WithoutThinParts(breast.Grid, std::move(breast.Mask), options.ThinnestFeatureMm);
  if (!KeepLargestPiece(breast.Grid.Shape(), breast.Mask))
  {
    throw InputError("mammogram: expected a breast, found nothing brighter than the air");
  }
  FillHoles(breast.Grid.Shape(), breast.Mask);
  return breast;
}

/// The breast in the mammogram's own pixels.
void KeepBreast(const PixelGrid& grid, const FineBreast& breast, const TargetOptions& options,
  RegistrationTarget& target)
{
  const std::vector<float> distances = SignedDistance(breast.Grid, breast.Mask);
  const int factor = breast.Factor;
  target.SignedDistanceMm.resize(grid.Count());
  target.BreastMask.resize(grid.Count());
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      const std::size_t from =
        breast.Grid.Index(column * factor + factor / 2, row * factor + factor / 2);
      const std::size_t to = grid.Index(column, row);
      target.SignedDistanceMm[to] = distances[from];
      target.BreastMask[to] = distances[from] < 0 ? 1 : 0;
      // Filled: a dark frame of the detector, or a hole.
      if (options.ExcludeUnseen && breast.Mask[from] && !breast.Seen[from])
      {
        target.Excluded.resize(grid.Count(), 0);
        target.Excluded[to] = 1;
      }
    }
  }
}

void ExcludeChestWall(const PixelGrid& grid, double marginMm, RegistrationTarget& target)
{
  target.OutlineFromMm = marginMm;
  if (marginMm == 0)
  {
    return;
  }
  target.Excluded.resize(grid.Count(), 0);
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      if (target.Grid.PositionOf(column, row)[1] < marginMm)
      {
        target.Excluded[grid.Index(column, row)] = 1;
      }
    }
  }
}

/// Lengths of the picture's borders that are breast: at its front, at the chest wall, and at the
/// ends along that, mm.
struct CutBorders
{
  double FrontMm = 0;
  double ChestWallMm = 0;
  double LowerEndMm = 0;
  double UpperEndMm = 0;
};

CutBorders FindCutBorders(const PixelGrid& grid, const RegistrationTarget& target)
{
  CutBorders cut;
  // The front is where gantry y is largest, the ends where x is smallest and largest.
  const bool alongColumns = target.Grid.ColumnStep[1] != 0;
  const double frontward = alongColumns ? target.Grid.ColumnStep[1] : target.Grid.RowStep[1];
  const int fronts = alongColumns ? grid.Columns : grid.Rows;
  const int sides = alongColumns ? grid.Rows : grid.Columns;
  const auto inBreast = [&](int deep, int side) {
    return target.BreastMask[alongColumns ? grid.Index(deep, side) : grid.Index(side, deep)] != 0;
  };
  const double along = alongColumns ? grid.RowSpacing : grid.ColumnSpacing;
  for (int side = 0; side < sides; ++side)
  {
    cut.FrontMm += inBreast(frontward > 0 ? fronts - 1 : 0, side) ? along : 0;
    cut.ChestWallMm += inBreast(frontward > 0 ? 0 : fronts - 1, side) ? along : 0;
  }
  const double across = alongColumns ? grid.ColumnSpacing : grid.RowSpacing;
  for (int deep = 0; deep < fronts; ++deep)
  {
    cut.LowerEndMm += inBreast(deep, 0) ? across : 0;
    cut.UpperEndMm += inBreast(deep, sides - 1) ? across : 0;
  }
  return cut;
}

/// A border that ends a breast of 30 to 80 mm of curvature over so much cuts off a millimetre or
/// two of it.
constexpr double MostCutMm = 20;

void CheckWhole(const PixelGrid& grid, RegistrationTarget& target)
{
  const CutBorders cut = FindCutBorders(grid, target);
  char text[256];
  // If the breast touches the front more, the header takes the front for the chest wall. Another
  // warning says that.
  if (cut.FrontMm > MostCutMm && cut.FrontMm <= cut.ChestWallMm)
  {
    std::snprintf(text, sizeof text,
      "mammogram: expected the whole breast in the picture, found it cut off at its front: %.0f mm "
      "of the border opposite the chest wall are breast",
      cut.FrontMm);
    throw InputError(text);
  }
  if (cut.LowerEndMm > MostCutMm && cut.UpperEndMm > MostCutMm)
  {
    std::snprintf(text, sizeof text,
      "The picture cuts the breast off at both ends along the chest wall, over %.0f and %.0f mm: "
      "its outline says nothing of where it lies between them.",
      cut.LowerEndMm, cut.UpperEndMm);
    target.Disagreements.emplace_back(text);
  }
}

/// Raw data that is taken for a picture made to be looked at is registered with another thickness,
/// and looks right; so is the other way round. Its noise tells.
void CheckIntent(const Mammogram& mammogram, const PixelGrid& grid, RegistrationTarget& target)
{
  if (mammogram.PresentationIntent == Mammogram::Intent::ForPresentation)
  {
    if (FindNoiseTrend(grid, target.LogAttenuation, target.SignedDistanceMm) == NoiseTrend::Falls)
    {
      target.Disagreements.emplace_back(
        "The header says For Presentation, but the noise falls where more is absorbed, as in raw "
        "data (For Processing): the values may not mean what they are taken for.");
    }
    return;
  }
  if (mammogram.IntensityRelationship == Mammogram::Relationship::Logarithmic)
  {
    return;
  }
  std::vector<float> intensity(target.LogAttenuation.size());
  std::transform(target.LogAttenuation.begin(), target.LogAttenuation.end(), intensity.begin(),
    [](float log) { return -std::exp(-log); });
  if (FindNoiseTrend(grid, intensity, target.SignedDistanceMm) == NoiseTrend::Rises)
  {
    target.Disagreements.emplace_back(
      "The header says For Processing, but the noise rises where more is absorbed, as in a picture "
      "made to be looked at (For Presentation): the values may not mean what they are taken for.");
  }
}

void WarnOfShare(const PixelGrid& grid, RegistrationTarget& target)
{
  const double part = static_cast<double>(std::accumulate(target.BreastMask.begin(),
                        target.BreastMask.end(), std::size_t{ 0 })) /
    static_cast<double>(grid.Count());
  if (part < 0.02 || part > 0.95)
  {
    target.Warnings.push_back("The breast was found on " + std::to_string(std::lround(100 * part)) +
      " % of the picture: its outline should be looked at.");
  }
}
}

RegistrationTarget PrepareTarget(const Mammogram& mammogram, const TargetOptions& options)
{
  Validate(mammogram, options);
  RegistrationTarget target;
  target.Grid.Columns = mammogram.Columns;
  target.Grid.Rows = mammogram.Rows;
  target.HeaderThicknessMm = mammogram.BodyPartThicknessMm;
  const PixelGrid grid{ mammogram.Columns, mammogram.Rows, mammogram.ColumnSpacingMm,
    mammogram.RowSpacingMm };
  BreastContrast contrast = FindBreastContrast(mammogram, grid, options, target);
  const FineBreast breast = OutlineBreast(grid, contrast, options);
  target.LogAttenuation = std::move(contrast.LogAttenuation);
  const double rollDeg =
    PlaceInGantry(mammogram, grid, TouchedSides(breast.Grid, breast.Mask), target);
  if (std::find(breast.Mask.begin(), breast.Mask.end(), 0) == breast.Mask.end())
  {
    throw InputError("mammogram: expected air beside the breast, found none");
  }
  KeepBreast(grid, breast, options, target);
  CheckWhole(grid, target);
  CheckIntent(mammogram, grid, target);
  Exclude(mammogram, rollDeg, options, target);
  ExcludeChestWall(grid, options.ChestWallMarginMm, target);
  WarnOfShare(grid, target);
  return target;
}
}
