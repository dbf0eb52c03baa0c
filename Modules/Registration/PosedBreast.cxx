// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/PosedBreast.h"

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

PosedBreast::PosedBreast(BreastModel& model, BreastBody& body, const UnitPlacement& placement,
  const BreastPose& pose, CompressionState state)
  : Breast(model)
  , Body(body)
  , Unit(placement)
  , UnitPose(pose)
  , Equilibrium(std::move(state))
  , UnitFrame(placement.At(pose))
{
}

PosedBreast PosedBreast::MovedTo(const BreastPose& pose)
{
  PosedBreast moved(this->Breast, this->Body, this->Unit, pose, this->Equilibrium);
  moved.Points = this->SurfacePoints();
  return moved;
}

PosedBreast& PosedBreast::SeenFrom(const Vector3& focalSpotMm)
{
  for (const std::shared_ptr<PosedBreast>& other : this->OtherSpots)
  {
    if (other->Unit.Unit.FocalSpot() == focalSpotMm)
    {
      return *other;
    }
  }
  UnitPlacement placement = this->Unit;
  placement.Unit = WithFocalSpot(placement.Unit, focalSpotMm);
  auto other = std::make_shared<PosedBreast>(this->Breast, this->Body, placement, this->UnitPose,
    this->Equilibrium);
  other->Points = this->SurfacePoints();
  this->OtherSpots.push_back(std::move(other));
  return *this->OtherSpots.back();
}

const std::vector<double>& PosedBreast::SurfacePoints()
{
  if (this->Points.empty())
  {
    this->Points = this->Body.Surface().Map(this->Equilibrium.Positions);
  }
  return this->Points;
}

const std::vector<ReceptorPoint>& PosedBreast::SurfaceOnReceptor()
{
  if (this->Projected.empty())
  {
    this->Projected = ProjectToReceptor(this->SurfacePoints(), this->UnitFrame, this->Unit.Unit);
  }
  return this->Projected;
}

const PosedBreast::Silhouette& PosedBreast::SilhouetteFrom(const ReceptorPoint& centre,
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

bool PosedBreast::Shows(const XRayDetector& detector) const
{
  return this->LastPicture && this->Detector == detector;
}

void PosedBreast::KeepPicture(const XRaySource& source, const XRayDetector& detector,
  PathLengthImage lengths)
{
  this->Detector = detector;
  std::vector<float> attenuation = DetectedAttenuation(this->Breast, source, detector, lengths);
  this->LastPicture = Picture{ std::move(lengths), std::move(attenuation) };
}

const PosedBreast::Picture& PosedBreast::PictureOn(const ReceptorGrid& grid, int samples)
{
  const XRayDetector detector = DetectorOf(this->UnitFrame, grid, samples);
  if (!this->Shows(detector))
  {
    ++this->Projections;
    const XRaySource source = SourceOf(this->UnitFrame, this->Unit.Unit);
    this->KeepPicture(source, detector,
      this->Breast.Project(this->SurfacePoints(), source, detector));
  }
  return *this->LastPicture;
}

VectorFields PosedBreast::Velocities(const std::vector<int>& wanted)
{
  return this->Body.VelocitiesSeenFromUnit(this->Unit, this->UnitPose, this->Equilibrium,
    this->Body.Surface(), this->SurfacePoints(), wanted);
}

std::vector<std::vector<double>> PosedBreast::DifferentiatePicture(const ReceptorGrid& grid,
  int samples, const VectorFields& velocities)
{
  const XRayDetector detector = DetectorOf(this->UnitFrame, grid, samples);
  const XRaySource source = SourceOf(this->UnitFrame, this->Unit.Unit);
  PathLengthDerivatives rates;
  PathLengthImage lengths =
    this->Breast.Project(this->SurfacePoints(), source, detector, velocities, rates);
  if (!this->Shows(detector))
  {
    ++this->Projections;
    this->KeepPicture(source, detector, std::move(lengths));
  }
  return DetectedRates(this->Breast, source, detector, this->LastPicture->Lengths,
    this->LastPicture->LogAttenuation, rates);
}

int PosedBreast::NumberOfProjections() const
{
  int count = this->Projections;
  for (const std::shared_ptr<PosedBreast>& other : this->OtherSpots)
  {
    count += other->NumberOfProjections();
  }
  return count;
}
}
