// SPDX-License-Identifier: Apache-2.0
#include "RegistrationModel.h"

#include "Private/ZScores.h"
#include "TargetImage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mammoray
{
std::vector<PlatePairVelocity> PlateVelocities(const RegistrationModel& model,
  const BreastPose& pose)
{
  const VolumeFromGantry placed = PlaceUnit(model.Axes, model.Anchor, model.Unit, pose);
  const PlatePair plates = PlatesOf(placed, model.Unit, pose.ThicknessMm);
  const auto both = [](const Vector3& linear) {
    return PlatePairVelocity{ { linear, {} }, { linear, {} } };
  };

  PlatePairVelocity thickness;
  thickness.Support.Linear = -0.5 * placed.Z;
  thickness.Paddle.Linear = 0.5 * placed.Z;
  // With omega = Z x X per radian: omega x X = -Z and omega x Z = X, as PlaceUnit turns them.
  const Vector3 omega = (std::numbers::pi / 180.0) * Cross(placed.Z, placed.X);
  // The shifts turn with the unit; only the anchor stays.
  const auto turning = [&](const Plate& plate) {
    return PlateVelocity{ Cross(omega, plate.Edge - model.Anchor), omega };
  };
  const PlatePairVelocity roll{ turning(plates.Support), turning(plates.Paddle) };
  return { thickness, roll, both(placed.X), both(placed.Y), both(placed.Z) };
}

std::vector<std::vector<double>> VelocitiesSeenFromUnit(const RegistrationModel& model,
  const BreastPose& pose, const CompressionState& state, const Embedding& points,
  const std::vector<int>& wanted)
{
  const PlatePair plates =
    PlatesOf(PlaceUnit(model.Axes, model.Anchor, model.Unit, pose), model.Unit, pose.ThicknessMm);
  const std::vector<PlatePairVelocity> all = PlateVelocities(model, pose);
  std::vector<PlatePairVelocity> motions;
  for (const int parameter : wanted)
  {
    motions.push_back(all[parameter]);
  }
  const std::vector<double> positions = points.Map(state.Positions);
  std::vector<std::vector<double>> velocities;
  for (const std::vector<double>& nodes : model.Simulation->Sensitivities(state, motions))
  {
    // Rays and pixels move with the unit, and the unit with its support.
    const PlateVelocity& unit = motions[velocities.size()].Support;
    std::vector<double> moved = points.Map(nodes);
    for (std::size_t index = 0; index < moved.size(); index += 3)
    {
      const Vector3 carried =
        unit.At(plates.Support, { positions[index], positions[index + 1], positions[index + 2] });
      for (int axis = 0; axis < 3; ++axis)
      {
        moved[index + axis] -= carried[axis];
      }
    }
    velocities.push_back(std::move(moved));
  }
  return velocities;
}

XRaySource SourceOf(const VolumeFromGantry& placed, const MammographyUnit& unit)
{
  XRaySource source;
  source.Position = placed.Point({ 0, 0, unit.SourceToDetectorMm });
  return source;
}

XRayDetector DetectorOf(const VolumeFromGantry& placed, const RegistrationTarget& grid, int samples)
{
  XRayDetector detector;
  detector.Origin = placed.Point({ grid.Origin[0], grid.Origin[1], 0 });
  detector.ColumnStep = placed.Direction({ grid.ColumnStep[0], grid.ColumnStep[1], 0 });
  detector.RowStep = placed.Direction({ grid.RowStep[0], grid.RowStep[1], 0 });
  detector.Columns = grid.Columns;
  detector.Rows = grid.Rows;
  detector.Samples = samples;
  return detector;
}

SyntheticMammogram Synthesize(const RegistrationModel& model, const BreastPose& pose,
  const CompressionState& state, const RegistrationTarget& grid, int samples)
{
  SyntheticMammogram synthetic;
  const VolumeFromGantry placed = PlaceUnit(model.Axes, model.Anchor, model.Unit, pose);
  const std::vector<double> points = model.SurfaceEmbedding->Map(state.Positions);
  model.Projector->UpdatePoints(points);
  const PathLengthImage lengths =
    model.Projector->Project(SourceOf(placed, model.Unit), DetectorOf(placed, grid, samples));
  synthetic.LogAttenuation = model.XRays->LogAttenuation(lengths);
  synthetic.InconsistentRays = lengths.NumberOfInconsistentRays();

  const ReceptorPoint centre = ChestWallCentre(grid);
  const auto directions = HalfCircleDirections(360);
  const std::vector<double> radii = SilhouetteRadii(ProjectToReceptor(points, placed, model.Unit),
    OuterEdges(*model.Surface), centre, directions);
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
    if (!Contains(target, middle, 0))
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
    if (target.BreastMask[pixel] != 0 && synthetic.LogAttenuation[pixel] > 0)
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
