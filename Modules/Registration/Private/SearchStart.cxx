// SPDX-License-Identifier: Apache-2.0
#include "Private/SearchStart.h"

#include "Private/Silhouette.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace mammoray
{
namespace
{
/// Extent of the breast at rest along the beam's axis, mm: of what is a third of its depth and more
/// in front of the chest wall, which may be taller, as may be the fat and skin of the body on it.
double UncompressedHeight(const SearchedBreast& breast, const BreastPose& pose)
{
  const UnitPlacement& placement = breast.Placement;
  const Vector3 axis = placement.At(pose).Z;
  const std::vector<double>& points = breast.Body->Simulation().RestPositions();
  const auto depth = [&](std::size_t index)
  {
    const Vector3 point{ points[index], points[index + 1], points[index + 2] };
    return Dot(point - placement.Frame.Anchor, placement.Frame.Axes.Anterior);
  };
  double deepest = 0;
  for (std::size_t index = 0; index < points.size(); index += 3)
  {
    deepest = std::max(deepest, depth(index));
  }
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t index = 0; index < points.size(); index += 3)
  {
    const Vector3 point{ points[index], points[index + 1], points[index + 2] };
    if (depth(index) >= deepest / 3)
    {
      const double height = Dot(point, axis);
      low = std::min(low, height);
      high = std::max(high, height);
    }
  }
  return high - low;
}

/// Thickness that is too small for the breast: opened and bounded, with a warning.
void OpenTo(double thicknessMm, double heightMm, ViewResult& result)
{
  RegistrationParameter& thickness = result.Parameters[ThicknessParameter];
  double& value = result.Values[ThicknessParameter];
  char sentence[240];
  std::snprintf(sentence, sizeof sentence,
    "The breast of the volume is %.0f mm high; it is not compressed to the %.1f mm the search "
    "should start from, but to no less than %.1f mm.",
    heightMm, value, thicknessMm);
  result.Warnings.push_back(sentence);
  value = thicknessMm;
  thickness.Start = thicknessMm;
  thickness.Lower = thicknessMm;
  thickness.Upper = std::max(thickness.Upper, 1.5 * thicknessMm);
}

/// How far the breast reaches on the receptor: its ends across and its tip, mm.
struct Reach
{
  double Low = std::numeric_limits<double>::infinity();
  double High = -std::numeric_limits<double>::infinity();
  double Tip = 0;

  void Add(const ReceptorPoint& point)
  {
    this->Low = std::min(this->Low, point[0]);
    this->High = std::max(this->High, point[0]);
    this->Tip = std::max(this->Tip, point[1]);
  }
};

/// Reach of the silhouette farther than `fromMm` from the chest wall.
Reach ReachOf(PosedBreast& breast, const ReceptorPoint& centre, double fromMm)
{
  const auto directions = HalfCircleDirections(180);
  const std::vector<double>& radii = breast.SilhouetteFrom(centre, directions).Radii;
  Reach reach;
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    const ReceptorPoint end{ centre[0] + radii[index] * directions[index][0],
      centre[1] + radii[index] * directions[index][1] };
    if (end[1] >= fromMm)
    {
      reach.Add(end);
    }
  }
  return reach;
}

/// Reach of the breast in the mammogram.
Reach ReachOf(const RegistrationTarget& target, double fromMm)
{
  Reach reach;
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      const ReceptorPoint point = target.Grid.PositionOf(column, row);
      if (target.BreastMask[target.Grid.Index(column, row)] && point[1] >= fromMm)
      {
        reach.Add(point);
      }
    }
  }
  return reach;
}

/**
 * The values at which the unit is shifted so that the silhouette has its middle and its tip where
 * the mammogram's outline has them: cheap, and it spares the optimiser the long way from a wrong
 * position. The middle of what is a third of the tip's way and more from the chest wall: behind,
 * the MRI's breast may go on into the body beside it.
 */
std::vector<double> Aligned(PosedBreast& breast, const RegistrationTarget& target,
  const std::vector<RegistrationParameter>& parameters)
{
  std::vector<double> values = ValuesOf(breast.Pose());
  const double margin = target.OutlineFromMm;
  const double from = margin > 0 ? std::max(margin, ReachOf(target, 0).Tip / 3) : 0;
  const Reach wanted = ReachOf(target, from);
  const Reach reach = ReachOf(breast, ChestWallCentre(target), from);
  if (reach.Low > reach.High || wanted.Low > wanted.High)
  {
    return values;
  }
  const MammographyUnit& unit = breast.Placement().Unit;
  const double sid = unit.SourceToDetectorMm; // shadows move so much wherever the focal spot is
  const double magnification = sid / (sid - unit.SupportHeightMm - 0.5 * breast.Pose().ThicknessMm);
  const auto shift = [&](int index, double by)
  {
    const RegistrationParameter& parameter = parameters[index];
    if (!parameter.Fixed)
    {
      values[index] = std::clamp(values[index] + by, parameter.Lower, parameter.Upper);
    }
  };
  shift(LateralParameter,
    0.5 * (reach.Low + reach.High - wanted.Low - wanted.High) / magnification);
  shift(AnteriorParameter, (reach.Tip - wanted.Tip) / magnification);
  return values;
}

/**
 * Compresses the breast at `aligned`, where the outlines meet; without an equilibrium there only
 * sideways of Current, which the plates do not feel. False without one there, too.
 */
bool MoveTo(const SearchedBreast& breast, const std::vector<double>& aligned, ViewSearch& search,
  const ProgressCallback& progress)
{
  std::vector<double> sideways = search.Result.Values;
  sideways[LateralParameter] = aligned[LateralParameter];
  for (const std::vector<double>& values : { aligned, sideways })
  {
    try
    {
      search.Current =
        CompressForStart(breast, values, search.Current.get(), search.Result, progress);
      search.Result.Values = values;
      return true;
    }
    catch (const ConvergenceError&)
    {
      // The next, or none.
    }
  }
  return false;
}

/**
 * Moves so often from Current to where the outlines would meet, as long as the cost falls. Plates
 * farther in front of the chest wall hold less of the breast, so that its tip does not stay where a
 * shift had put it: 9 mm too far, a search ended in a dent of the cost 13 mm of thickness away from
 * its bottom.
 */
void Align(const SearchedBreast& breast, const RegistrationTarget& target,
  const RegistrationResiduals& compared, int moves, ViewSearch& search,
  const ProgressCallback& progress)
{
  const auto costHere = [&]
  {
    ++search.Result.Projections;
    return compared.Costs(compared.Evaluate(*search.Current)).Sum();
  };
  double least = costHere();
  for (int move = 0; move < moves; ++move)
  {
    const std::vector<double> values = search.Result.Values;
    const std::shared_ptr<PosedBreast> here = search.Current;
    if (!MoveTo(breast, Aligned(*here, target, search.Result.Parameters), search, progress))
    {
      return;
    }
    const double cost = costHere();
    if (cost >= least)
    {
      search.Result.Values = values;
      search.Current = here;
      return;
    }
    least = cost;
  }
}

/// Nearer than this, equilibria are one, folded a little otherwise at the plates' edges, mm.
constexpr double SameEquilibriumMm = 0.1;

/// Mean distance of nodes, 3 x nodeCount, mm.
double MeanDistance(const std::vector<double>& a, const std::vector<double>& b)
{
  double sum = 0;
  for (std::size_t c = 0; c < a.size(); c += 3)
  {
    sum += std::hypot(a[c] - b[c], a[c + 1] - b[c + 1], a[c + 2] - b[c + 2]);
  }
  return 3 * sum / static_cast<double>(a.size());
}

/// Rolls at which a search may begin beside its start, degrees off it.
std::vector<double> RollOffsets(const RegistrationOptions& options, const ViewResult& result)
{
  std::vector<double> offsets{ 0 };
  // A start that had to be opened is another breast's: every equilibrium costs much there.
  if (!result.Parameters[RollParameter].Fixed && result.Warnings.empty())
  {
    offsets.insert(offsets.end(), options.RollOffsetsDeg.begin(), options.RollOffsetsDeg.end());
  }
  return offsets;
}

/// The breast rolled by `offset` from Current; null out of the bounds and where it has no
/// equilibrium.
std::shared_ptr<PosedBreast> Rolled(const SearchedBreast& breast, double offset, ViewSearch& search,
  const ProgressCallback& progress)
{
  std::vector<double> values = search.Result.Values;
  values[RollParameter] += offset;
  const RegistrationParameter& roll = search.Result.Parameters[RollParameter];
  if (values[RollParameter] < roll.Lower || values[RollParameter] > roll.Upper)
  {
    return nullptr;
  }
  if (offset == 0)
  {
    return search.Current;
  }
  try
  {
    return CompressForStart(breast, values, search.Current.get(), search.Result, progress);
  }
  catch (const ConvergenceError&)
  {
    return nullptr;
  }
}
}

std::shared_ptr<PosedBreast> CompressForStart(const SearchedBreast& breast,
  const std::vector<double>& values, const PosedBreast* near, ViewResult& result,
  const ProgressCallback& progress)
{
  const BreastPose pose = PoseOf(values);
  if (near && TravelFrom(near->State(), breast.Placement, pose) > LongestWarmTravelMm)
  {
    near = nullptr;
  }
  ++result.Evaluations;
  const ScopeTimer timer(result.MechanicsSeconds);
  return breast.At(values,
    breast.Body->Compress(breast.Placement, pose, near ? &near->State() : nullptr, progress));
}

void AdoptPredicted(ViewSearch& search, const ProgressCallback& progress)
{
  const SearchedBreast breast = search.Breast();
  const std::vector<double>& values = search.Result.Values;
  ++search.Result.Evaluations;
  const ScopeTimer timer(search.Result.MechanicsSeconds);
  search.Current = breast.At(values,
    breast.Body->Adopt(*search.Model->Predictor(), search.Current->State(),
      PoseOf(values).Stiffness, progress));
}

void ChooseEquilibrium(const SearchedBreast& breast, const RegistrationTarget& target,
  const RegistrationOptions& options, ViewSearch& search, const ProgressCallback& progress)
{
  std::shared_ptr<PosedBreast> other;
  try
  {
    other = CompressForStart(breast, search.Result.Values, nullptr, search.Result, progress);
  }
  catch (const ConvergenceError&)
  {
    return;
  }
  search.Result.OtherEquilibriumMm =
    MeanDistance(search.Current->State().Positions, other->State().Positions);
  if (search.Result.OtherEquilibriumMm < SameEquilibriumMm)
  {
    return;
  }
  const RegistrationResiduals compared(target, search.Result.Parameters, options);
  search.Result.Projections += 2;
  const double here = compared.Costs(compared.Evaluate(*search.Current)).Sum();
  if (compared.Costs(compared.Evaluate(*other)).Sum() < here)
  {
    search.Current = std::move(other);
  }
}

void OpenToLeastHeight(ViewSearch& search)
{
  ViewResult& result = search.Result;
  const double height = UncompressedHeight(search.Breast(), PoseOf(result.Values));
  if (!result.Parameters[ThicknessParameter].Fixed &&
    result.Values[ThicknessParameter] < LeastShareOfHeight * height)
  {
    OpenTo(LeastShareOfHeight * height, height, result);
  }
}

void CompressStart(ViewSearch& search, const ProgressCallback& progress)
{
  constexpr int attempts = 3;
  const SearchedBreast breast = search.Breast();
  ViewResult& result = search.Result;
  for (int attempt = 1;; ++attempt)
  {
    try
    {
      search.Current = CompressForStart(breast, result.Values, nullptr, result, progress);
      return;
    }
    catch (const CompressionError& error)
    {
      const double opened = 1.1 * error.LastGapMm();
      if (result.Parameters[ThicknessParameter].Fixed || attempt == attempts ||
        !(opened > result.Values[ThicknessParameter]))
      {
        throw;
      }
      OpenTo(opened, UncompressedHeight(breast, PoseOf(result.Values)), result);
    }
  }
}

void ChooseStart(const SearchedBreast& breast, const RegistrationTarget& target,
  const RegistrationOptions& options, ViewSearch& search, const ProgressCallback& progress)
{
  constexpr int LargestNumberOfMoves = 4;
  const RegistrationResiduals compared(target, search.Result.Parameters, options);
  double least = std::numeric_limits<double>::infinity();
  std::shared_ptr<PosedBreast> best;
  for (const double offset : RollOffsets(options, search.Result))
  {
    const std::shared_ptr<PosedBreast> rolled = Rolled(breast, offset, search, progress);
    if (!rolled)
    {
      continue;
    }
    // Rated as it is, moved but not compressed anew: what the plates do to it there would hide
    // which roll it looks like.
    PosedBreast moved = rolled->MovedTo(PoseOf(Aligned(*rolled, target, search.Result.Parameters)));
    const double cost = compared.Costs(compared.Evaluate(moved)).Sum();
    ++search.Result.Projections;
    if (cost < least)
    {
      least = cost;
      best = rolled;
    }
  }
  if (best)
  {
    search.Result.Values = ValuesOf(best->Pose());
    search.Current = best;
    Align(breast, target, compared, LargestNumberOfMoves, search, progress);
  }
}
}
