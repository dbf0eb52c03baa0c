// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/PosedBreast.h"

#include "Private/Silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mammoray
{
namespace
{
std::vector<double> PrimaryOf(const BreastModel& model, const PathLengthImage& lengths)
{
  std::vector<double> primary(lengths.NumberOfPixels());
  model.XRays().AddTransmission(lengths, 1, primary);
  return primary;
}

std::vector<float> DetectedAttenuation(const BreastModel& model, const XRaySource& source,
  const XRayDetector& detector, const PathLengthImage& lengths)
{
  if (!model.Scatter())
  {
    return model.XRays().LogAttenuation(lengths);
  }
  const std::vector<double> primary = PrimaryOf(model, lengths);
  const std::vector<double> scatter =
    model.Scatter()->Scatter(source, detector, TissueThickness(lengths), primary);
  std::vector<float> attenuation(primary.size());
  std::transform(primary.begin(), primary.end(), scatter.begin(), attenuation.begin(),
    [](double through, double scattered)
    { return static_cast<float>(-std::log(std::max(through + scattered, 1e-300))); });
  return attenuation;
}

std::vector<std::vector<double>> DetectedRates(const BreastModel& model, const XRaySource& source,
  const XRayDetector& detector, const PathLengthImage& lengths,
  const std::vector<float>& attenuation, const PathLengthDerivatives& derivatives)
{
  const std::size_t pixels = lengths.NumberOfPixels();
  const std::vector<float> mean = model.XRays().MeanAttenuation(lengths);
  // Rates of the primary radiation alone.
  std::vector<std::vector<double>> rates(static_cast<std::size_t>(derivatives.Fields),
    std::vector<double>(pixels));
  for (int field = 0; field < derivatives.Fields; ++field)
  {
    std::vector<double>& rate = rates[static_cast<std::size_t>(field)];
    for (int material = 1; material < lengths.Materials; ++material)
    {
      const float* mu = mean.data() + static_cast<std::size_t>(material) * pixels;
      const float* length = derivatives.Of(field, material);
      for (std::size_t pixel = 0; pixel < pixels; ++pixel)
      {
        rate[pixel] += static_cast<double>(mu[pixel]) * length[pixel];
      }
    }
  }
  if (!model.Scatter())
  {
    return rates;
  }
  const std::vector<double> primary = PrimaryOf(model, lengths);
  std::vector<ScatterModel::SignalRates> signals;
  for (int field = 0; field < derivatives.Fields; ++field)
  {
    ScatterModel::SignalRates& signal = signals.emplace_back();
    signal.ThicknessesMm.resize(pixels);
    for (int material = 1; material < lengths.Materials; ++material)
    {
      const float* length = derivatives.Of(field, material);
      for (std::size_t pixel = 0; pixel < pixels; ++pixel)
      {
        signal.ThicknessesMm[pixel] += length[pixel];
      }
    }
    signal.Primary = std::move(rates[static_cast<std::size_t>(field)]);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    {
      signal.Primary[pixel] *= -primary[pixel];
    }
  }
  rates =
    model.Scatter()->Differentiate(source, detector, TissueThickness(lengths), primary, signals);
  for (std::size_t field = 0; field < rates.size(); ++field)
  {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    {
      const double detected = std::exp(-static_cast<double>(attenuation[pixel]));
      rates[field][pixel] = -(signals[field].Primary[pixel] + rates[field][pixel]) / detected;
    }
  }
  return rates;
}
}

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

ReceptorPoint ShadowOf(const Vector3& gantry, const MammographyUnit& unit)
{
  const auto [x, y, sid] = unit.FocalSpot();
  const double magnification =
    gantry[2] < sid ? sid / (sid - gantry[2]) : std::numeric_limits<double>::quiet_NaN();
  return { x + magnification * (gantry[0] - x), y + magnification * (gantry[1] - y) };
}

std::vector<ReceptorPoint> ProjectToReceptor(const std::vector<double>& points,
  const VolumeFromGantry& placed, const MammographyUnit& unit)
{
  std::vector<ReceptorPoint> projected(points.size() / 3);
  for (std::size_t index = 0; index < projected.size(); ++index)
  {
    projected[index] = ShadowOf(
      placed.ToGantry({ points[3 * index], points[3 * index + 1], points[3 * index + 2] }), unit);
  }
  return projected;
}

std::vector<ReceptorPoint> ReceptorVelocities(const std::vector<double>& points,
  std::span<const double> velocities, const VolumeFromGantry& placed, const MammographyUnit& unit)
{
  std::vector<ReceptorPoint> moved(points.size() / 3);
  const auto [x, y, sid] = unit.FocalSpot();
  for (std::size_t index = 0; index < moved.size(); ++index)
  {
    const Vector3 gantry =
      placed.ToGantry({ points[3 * index], points[3 * index + 1], points[3 * index + 2] });
    const Vector3 velocity{ velocities[3 * index], velocities[3 * index + 1],
      velocities[3 * index + 2] };
    const double magnification = sid / (sid - gantry[2]);
    // d magnification = magnification^2 / sid dz
    const double growth = magnification * magnification / sid * Dot(velocity, placed.Z);
    moved[index] = { magnification * Dot(velocity, placed.X) + growth * (gantry[0] - x),
      magnification * Dot(velocity, placed.Y) + growth * (gantry[1] - y) };
  }
  return moved;
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
