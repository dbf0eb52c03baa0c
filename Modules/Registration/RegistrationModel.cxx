// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationModel.h"

#include "Private/ZScores.h"
#include "mammoray/Registration/TargetImage.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
VolumeFromGantry Place(const RegistrationModel& model, const BreastPose& pose)
{
  return PlaceUnit(model.Axes, model.Anchor, model.Unit, pose);
}

/// Leaves a simulation alone that has this stiffness.
void SetStiffness(const RegistrationModel& model, double factor)
{
  std::vector<ElasticMaterial> materials = model.Elastic;
  bool differs = false;
  for (const int index : model.ScaledMaterials)
  {
    materials[index].YoungsModulusKPa *= factor;
    differs = differs ||
      materials[index].YoungsModulusKPa != model.Simulation->Materials()[index].YoungsModulusKPa;
  }
  if (differs)
  {
    model.Simulation->SetMaterials(materials);
  }
}

MaterialVelocity StiffnessVelocity(const RegistrationModel& model)
{
  MaterialVelocity velocity(model.Elastic.size());
  for (const int index : model.ScaledMaterials)
  {
    velocity[index].YoungsModulusKPa = model.Elastic[index].YoungsModulusKPa;
  }
  return velocity;
}
}

PlatePair PlatesAt(const RegistrationModel& model, const BreastPose& pose)
{
  return PlatesOf(Place(model, pose), model.Unit, pose.ThicknessMm, pose.TiltDeg);
}

CompressionState CompressAt(const RegistrationModel& model, const std::vector<double>& values,
  const CompressionState* start, const ProgressCallback& progress)
{
  SetStiffness(model, values[StiffnessParameter]);
  return model.Simulation->Compress(PlatesAt(model, PoseOf(values)), start, progress,
    CompressionSimulation::Refusal::AtOnce);
}

std::vector<PlatePairVelocity> PlateVelocities(const RegistrationModel& model,
  const BreastPose& pose)
{
  const PlatePair plates = PlatesAt(model, pose);
  std::vector<PlatePairVelocity> velocities;
  for (const UnitVelocity& unit : UnitVelocities(model.Axes, model.Anchor, model.Unit, pose))
  {
    const auto carried = [&](const Plate& plate) {
      return PlateVelocity{ unit.Shift + Cross(unit.Turn, plate.Edge - model.Anchor), unit.Turn };
    };
    PlatePairVelocity pair{ carried(plates.Support), carried(plates.Paddle) };
    pair.Paddle.Linear = pair.Paddle.Linear + unit.PaddleShift;
    pair.Paddle.Angular = pair.Paddle.Angular + unit.PaddleTurn;
    velocities.push_back(pair);
  }
  velocities.resize(StiffnessParameter);
  return velocities;
}

std::vector<std::vector<double>> VelocitiesSeenFromUnit(const RegistrationModel& model,
  const std::vector<double>& values, const CompressionState& state, const Embedding& points,
  const std::vector<int>& wanted)
{
  // The last equilibrium may have been a refused step's, of another stiffness.
  SetStiffness(model, values[StiffnessParameter]);
  const BreastPose pose = PoseOf(values);
  const Plate support = PlatesAt(model, pose).Support;
  const std::vector<PlatePairVelocity> all = PlateVelocities(model, pose);
  std::vector<PlatePairVelocity> motions;
  std::vector<MaterialVelocity> stiffening;
  for (const int parameter : wanted)
  {
    if (parameter == StiffnessParameter)
    {
      stiffening.push_back(StiffnessVelocity(model));
    }
    else
    {
      motions.push_back(all[parameter]);
    }
  }
  const std::vector<double> positions = points.Map(state.Positions);
  const std::vector<std::vector<double>> nodes =
    model.Simulation->Sensitivities(state, motions, stiffening);
  std::vector<std::vector<double>> velocities;
  std::size_t motion = 0;
  for (const int parameter : wanted)
  {
    if (parameter == StiffnessParameter)
    {
      velocities.push_back(points.Map(nodes.back()));
      continue;
    }
    // Rays and pixels move with the unit, and the unit with its support.
    const PlateVelocity& unit = motions[motion].Support;
    std::vector<double> moved = points.Map(nodes[motion]);
    ++motion;
    for (std::size_t index = 0; index < moved.size(); index += 3)
    {
      const Vector3 carried =
        unit.At(support, { positions[index], positions[index + 1], positions[index + 2] });
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
  const VolumeFromGantry placed = Place(model, pose);
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
