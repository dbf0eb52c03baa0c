// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/EvaluatedState.h"

#include "Private/DetectedPicture.h"

#include <utility>

namespace mammoray
{
XRaySource SourceOf(const VolumeFromGantry& placed, const MammographyUnit& unit)
{
  XRaySource source;
  source.Position = placed.Point(unit.FocalSpot());
  return source;
}

XRayDetector DetectorOf(const VolumeFromGantry& placed, const ReceptorGrid& grid, int samples)
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

EvaluatedState::EvaluatedState(BreastModel& model, BreastBody& body, const UnitPlacement& placement,
  const BreastPose& pose, CompressionState state)
  : Breast(model)
  , Body(body)
  , Around(placement)
  , At(pose)
  , Equilibrium(std::move(state))
  , UnitHere(placement.At(pose))
{
}

EvaluatedState EvaluatedState::MovedTo(const BreastPose& pose)
{
  EvaluatedState moved(this->Breast, this->Body, this->Around, pose, this->Equilibrium);
  moved.Points = this->SurfacePoints();
  return moved;
}

EvaluatedState& EvaluatedState::SeenFrom(const Vector3& focalSpotMm)
{
  for (const std::shared_ptr<EvaluatedState>& other : this->Others)
  {
    if (other->Around.Unit.FocalSpot() == focalSpotMm)
    {
      return *other;
    }
  }
  UnitPlacement placement = this->Around;
  placement.Unit = WithFocalSpot(placement.Unit, focalSpotMm);
  auto other = std::make_shared<EvaluatedState>(this->Breast, this->Body, placement, this->At,
    this->Equilibrium);
  other->Points = this->SurfacePoints();
  this->Others.push_back(std::move(other));
  return *this->Others.back();
}

const std::vector<double>& EvaluatedState::SurfacePoints()
{
  if (this->Points.empty())
  {
    this->Points = this->Body.Surface().Map(this->Equilibrium.Positions);
  }
  return this->Points;
}

const std::vector<ReceptorPoint>& EvaluatedState::SurfaceOnReceptor()
{
  if (this->Projected.empty())
  {
    this->Projected = ProjectToReceptor(this->SurfacePoints(), this->UnitHere, this->Around.Unit);
  }
  return this->Projected;
}

const EvaluatedState::Silhouette& EvaluatedState::SilhouetteFrom(const ReceptorPoint& centre,
  const std::vector<ReceptorPoint>& directions)
{
  if (!this->Outline || centre != this->Centre || directions != this->Directions)
  {
    Silhouette outline;
    outline.Radii = SilhouetteRadii(this->SurfaceOnReceptor(), this->Breast.SurfaceEdges(), centre,
      directions, &outline.Crossed);
    this->Outline = std::move(outline);
    this->Centre = centre;
    this->Directions = directions;
  }
  return *this->Outline;
}

bool EvaluatedState::Shows(const XRayDetector& detector) const
{
  return this->Shown && this->Detector == detector;
}

void EvaluatedState::KeepPicture(const XRaySource& source, const XRayDetector& detector,
  PathLengthImage lengths)
{
  this->Detector = detector;
  std::vector<float> attenuation = DetectedAttenuation(this->Breast, source, detector, lengths);
  this->Shown = Picture{ std::move(lengths), std::move(attenuation) };
}

const EvaluatedState::Picture& EvaluatedState::PictureOn(const ReceptorGrid& grid, int samples)
{
  const XRayDetector detector = DetectorOf(this->UnitHere, grid, samples);
  if (!this->Shows(detector))
  {
    ++this->Projections;
    const XRaySource source = SourceOf(this->UnitHere, this->Around.Unit);
    this->KeepPicture(source, detector,
      this->Breast.Project(this->SurfacePoints(), source, detector));
  }
  return *this->Shown;
}

std::vector<double> EvaluatedState::Velocities(const std::vector<int>& wanted)
{
  return this->Body
    .VelocitiesSeenFromUnit(this->Around, this->At, this->Equilibrium, this->Body.Surface(),
      this->SurfacePoints(), wanted)
    .Values;
}

std::vector<std::vector<double>> EvaluatedState::DifferentiatePicture(const ReceptorGrid& grid,
  int samples, const std::vector<double>& velocities, int fields)
{
  const XRayDetector detector = DetectorOf(this->UnitHere, grid, samples);
  const XRaySource source = SourceOf(this->UnitHere, this->Around.Unit);
  PathLengthDerivatives rates;
  PathLengthImage lengths =
    this->Breast.Project(this->SurfacePoints(), source, detector, velocities, fields, rates);
  if (!this->Shows(detector))
  {
    ++this->Projections;
    this->KeepPicture(source, detector, std::move(lengths));
  }
  return DetectedRates(this->Breast, source, detector, this->Shown->Lengths,
    this->Shown->LogAttenuation, rates);
}

int EvaluatedState::NumberOfProjections() const
{
  int count = this->Projections;
  for (const std::shared_ptr<EvaluatedState>& other : this->Others)
  {
    count += other->NumberOfProjections();
  }
  return count;
}
}
