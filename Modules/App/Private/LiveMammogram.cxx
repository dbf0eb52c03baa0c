// SPDX-License-Identifier: Apache-2.0
#include "Private/LiveMammogram.h"

#include "Private/KilovoltageSpectrum.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/PosedBreast.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr double LeastSourceHeightMm = 20;
/// Neighbouring energies joined, so that few are left.
Spectrum Coarsened(const Spectrum& spectrum)
{
  constexpr double WidthKeV = 2;
  Spectrum coarse;
  coarse.Name = spectrum.Name;
  double begin = 0;
  double energySum = 0;
  for (std::size_t bin = 0; bin < spectrum.EnergiesKeV.size(); ++bin)
  {
    const double energy = spectrum.EnergiesKeV[bin];
    const double weight = spectrum.Weights[bin];
    if (!(weight > 0))
    {
      continue;
    }
    if (coarse.Weights.empty() || energy - begin >= WidthKeV)
    {
      begin = energy;
      energySum = 0;
      coarse.Weights.push_back(0);
      coarse.EnergiesKeV.push_back(0);
    }
    energySum += weight * energy;
    coarse.Weights.back() += weight;
    coarse.EnergiesKeV.back() = energySum / coarse.Weights.back();
  }
  return coarse;
}

/// Less than any detector tells from nothing.
constexpr float LeastTransmission = 1e-12F;
}

LiveMammogram::LiveMammogram(const ViewedBreast& viewed, const ProjectorOptions& options)
  : Viewed(viewed)
  , UnitPose(viewed.Pose)
  , Interfaces(ExtractInterfaces(viewed.Anatomy, &this->PointIds))
  , FullGrid(viewed.Breast.Grid)
  , HalfGrid(viewed.Breast.Grid.Coarsened(2))
  , Projector(MakeProjector(options))
{
  this->SetKilovoltage(KilovoltageOf(viewed.Spectrum));
  this->Projector->SetSurface(this->Interfaces);
  std::vector<double> points(viewed.Anatomy.Points.size());
  for (std::size_t id = 0; id < viewed.Anatomy.NumberOfPoints(); ++id)
  {
    viewed.Breast.Compressed->GetPoint(static_cast<vtkIdType>(id), &points[3 * id]);
  }
  this->SetPoints(points);
}

void LiveMammogram::SetPose(double thicknessMm, double rollDeg)
{
  this->RaysStale = this->RaysStale || thicknessMm != this->UnitPose.ThicknessMm ||
    rollDeg != this->UnitPose.RollDeg;
  this->UnitPose.ThicknessMm = thicknessMm;
  this->UnitPose.RollDeg = rollDeg;
}

void LiveMammogram::SetSourceOffset(const Vector3& offset)
{
  const MammographyUnit& unit = this->Viewed.Breast.Unit;
  const double least = unit.SupportHeightMm + this->UnitPose.ThicknessMm + LeastSourceHeightMm;
  this->Offset = offset;
  this->Offset[2] = std::max(offset[2], least - unit.SourceToDetectorMm);
  this->RaysStale = true;
}

void LiveMammogram::SetKilovoltage(double kilovoltage)
{
  if (kilovoltage == this->Voltage)
  {
    return;
  }
  const Spectrum& given = this->Viewed.Spectrum;
  const Spectrum spectrum =
    kilovoltage == KilovoltageOf(given) ? given : AtKilovoltage(given, kilovoltage);
  this->XRays.emplace(
    MakeBeam(this->Viewed.Materials, spectrum, DetectorResponse::EnergyIntegrating));
  this->QuickXRays.emplace(
    MakeBeam(this->Viewed.Materials, Coarsened(spectrum), DetectorResponse::EnergyIntegrating));
  this->Voltage = kilovoltage;
  this->BeamStale = true;
}

void LiveMammogram::SetPoints(const std::vector<double>& points)
{
  if (points.size() != this->Viewed.Anatomy.Points.size())
  {
    throw InputError("view: expected " + std::to_string(this->Viewed.Anatomy.NumberOfPoints()) +
      " points, found " + std::to_string(points.size() / 3));
  }
  this->Moved = points;
  std::vector<double> surface(3 * this->PointIds.size());
  for (std::size_t id = 0; id < this->PointIds.size(); ++id)
  {
    std::copy_n(&points[3 * static_cast<std::size_t>(this->PointIds[id])], 3, &surface[3 * id]);
  }
  this->Projector->UpdatePoints(surface);
  this->RaysStale = true;
}

VolumeFromGantry LiveMammogram::Placed() const
{
  return PlaceUnit(this->Viewed.Frame, this->Viewed.Breast.Unit, this->UnitPose);
}

PlatePair LiveMammogram::Plates() const
{
  return PlatesOf(this->Placed(), this->Viewed.Breast.Unit, this->UnitPose.ThicknessMm,
    this->UnitPose.TiltDeg);
}

Vector3 LiveMammogram::SourcePosition() const
{
  return this->Placed().Point(this->Viewed.Breast.Unit.FocalSpot() + this->Offset);
}

BreastInUnit LiveMammogram::InUnit() const
{
  BreastInUnit breast = this->Viewed.Breast;
  breast.Placed = this->Placed();
  breast.Unit = WithFocalSpot(breast.Unit, breast.Unit.FocalSpot() + this->Offset);
  breast.Compressed = WithPoints(breast.Compressed, this->Moved);
  return breast;
}

const std::vector<float>& LiveMammogram::Project(int divisor)
{
  if (this->RaysStale || divisor != this->PictureDivisor)
  {
    XRaySource source;
    source.Position = this->SourcePosition();
    this->Projector->Render(source, DetectorOf(this->Placed(), this->Grid(divisor), 1));
  }
  if (this->RaysStale || this->BeamStale || divisor != this->PictureDivisor)
  {
    this->Picture = this->Projector->Transmission(divisor == 1 ? *this->XRays : *this->QuickXRays);
    for (float& value : this->Picture)
    {
      value = -std::log(std::max(value, LeastTransmission));
    }
  }
  this->RaysStale = false;
  this->BeamStale = false;
  this->PictureDivisor = divisor;
  return this->Picture;
}
}
