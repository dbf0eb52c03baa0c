// SPDX-License-Identifier: Apache-2.0
#include "Private/LiveProjection.h"

#include "Private/KilovoltageSpectrum.h"
#include "Private/PaneOverlay.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mammoray
{
namespace
{
/// How far a tube's voltage goes to either side of the spectrum's own, kV.
constexpr double TubeRange = 6;
/// Where our attenuation tables begin and end, keV.
constexpr double LeastEnergyKeV = 5;
constexpr double MostEnergyKeV = 500;

std::array<Extent, 3> BoxOf(const SurfaceMesh& surface)
{
  return ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, surface.Points);
}

Vector3 MiddleOf(const std::array<Extent, 3>& box)
{
  return { box[0].Middle(), box[1].Middle(), box[2].Middle() };
}

/// Two by two pixels as one; the rest at the far borders is dropped.
XRayDetector Halved(XRayDetector detector)
{
  detector.Origin = detector.Origin + 0.5 * (detector.ColumnStep + detector.RowStep);
  detector.ColumnStep = 2.0 * detector.ColumnStep;
  detector.RowStep = 2.0 * detector.RowStep;
  detector.Columns = std::max(detector.Columns / 2, 1);
  detector.Rows = std::max(detector.Rows / 2, 1);
  detector.Samples = 1;
  return detector;
}
}

void ViewedScene::PlaceAround()
{
  const std::array<Extent, 3> box = BoxOf(this->Surface);
  const double diagonal = Norm({ box[0].Length(), box[1].Length(), box[2].Length() });
  if (!(diagonal > 0) || !std::isfinite(diagonal))
  {
    throw InputError("view: expected surfaces with an extent, found none");
  }
  constexpr double Before = 4;
  constexpr double Behind = 1.5;
  constexpr int Pixels = 512;
  // A tenth wider than the shadow of the sphere around the box.
  const double width = 1.1 * diagonal * (Before + Behind) / Before;
  const Vector3 middle = MiddleOf(box);
  this->Source.Type = XRaySource::Kind::Point;
  this->Source.Position = middle - Vector3{ 0, Before * diagonal, 0 };
  const double spacing = width / Pixels;
  this->Detector.Columns = Pixels;
  this->Detector.Rows = Pixels;
  this->Detector.ColumnStep = { spacing, 0, 0 };
  this->Detector.RowStep = { 0, 0, -spacing };
  this->Detector.Origin =
    middle + Vector3{ -0.5 * (width - spacing), Behind * diagonal, 0.5 * (width - spacing) };
}

LiveProjection::LiveProjection(const ViewedScene& viewed, const ProjectorOptions& options)
  : Viewed(viewed)
  , Half(Halved(viewed.Detector))
  , TurnAxis{ MiddleOf(BoxOf(viewed.Surface)), -1.0 * viewed.Detector.RowStep }
  , Projector(MakeProjector(options))
  , SourceNow(viewed.Source)
{
  viewed.Spectrum.Validate();
  this->SingleEnergy = viewed.Spectrum.EnergiesKeV.size() == 1;
  if (this->SingleEnergy)
  {
    const double energy = viewed.Spectrum.EnergiesKeV.front();
    this->Range = { std::min(std::max(0.5 * energy, LeastEnergyKeV), energy),
      std::max(std::min(2 * energy, MostEnergyKeV), energy) };
    this->SetEnergy(energy);
  }
  else
  {
    const double voltage = KilovoltageOf(viewed.Spectrum);
    this->Range = { std::max(voltage - TubeRange, viewed.Spectrum.EnergiesKeV.front() + 2),
      voltage + TubeRange };
    this->SetEnergy(voltage);
  }
  this->Projector->SetSurface(viewed.Surface);
  this->Project(1); // refuses a detector or a source that is none
}

void LiveProjection::SetTurn(double degrees)
{
  this->RaysStale = this->RaysStale || degrees != this->TurnDeg;
  this->TurnDeg = degrees;
}

void LiveProjection::SetSourceOffset(const Vector3& offset)
{
  if (this->Viewed.Source.Type == XRaySource::Kind::Parallel)
  {
    return;
  }
  this->Offset = offset;
  this->SourceNow.Position = this->Viewed.Source.Position + offset;
  this->RaysStale = true;
}

double LiveProjection::SourceGain() const
{
  constexpr double Most = 20;
  const XRayDetector& grid = this->Viewed.Detector;
  const Vector3 normal = Cross(grid.ColumnStep, grid.RowStep);
  const double before = Dot(this->TurnAxis.Point - this->Viewed.Source.Position, normal);
  const double behind = Dot(grid.Origin - this->TurnAxis.Point, normal);
  const double gain = before / behind;
  return gain > 0 && gain < Most ? gain : Most;
}

void LiveProjection::SetEnergy(double energy)
{
  energy = std::clamp(energy, this->Range[0], this->Range[1]);
  if (this->XRays && energy == this->EnergyNow)
  {
    return;
  }
  const Spectrum& given = this->Viewed.Spectrum;
  const Spectrum spectrum = this->SingleEnergy ? Spectrum::Monochromatic(energy)
    : energy == KilovoltageOf(given)           ? given
                                               : AtKilovoltage(given, energy);
  this->XRays.emplace(
    MakeBeam(this->Viewed.Materials, spectrum, DetectorResponse::EnergyIntegrating));
  this->EnergyNow = energy;
  this->BeamStale = true;
}

const std::vector<float>& LiveProjection::Project(int divisor)
{
  const bool stale = this->RaysStale || divisor != this->PictureDivisor;
  if (stale)
  {
    // The samples turn: so do, the other way about, source and detector before them.
    const ProjectionView view =
      TurnSample(this->SourceNow, this->Detector(divisor), this->TurnAxis, 2, 2 * this->TurnDeg)[1];
    this->Lengths = this->Projector->Project(view.Source, view.Detector);
  }
  if (stale || this->BeamStale)
  {
    this->Picture = this->XRays->LogAttenuation(this->Lengths);
  }
  this->RaysStale = false;
  this->BeamStale = false;
  this->PictureDivisor = divisor;
  return this->Picture;
}

std::string LiveProjection::Describe(int column, int row)
{
  this->Project(this->PictureDivisor);
  column = std::clamp(column / this->PictureDivisor, 0, this->Lengths.Columns - 1);
  row = std::clamp(row / this->PictureDivisor, 0, this->Lengths.Rows - 1);
  const std::size_t pixel =
    static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Lengths.Columns) +
    static_cast<std::size_t>(column);
  char text[60];
  std::snprintf(text, sizeof text, "transmission %.4g", std::exp(-this->Picture[pixel]));
  std::string found = text;
  double sum = 0;
  for (int material = 1; material < this->Lengths.Materials; ++material)
  {
    sum += this->Lengths.Material(material)[pixel];
  }
  for (int material = 1; material < this->Lengths.Materials; ++material)
  {
    const double length = this->Lengths.Material(material)[pixel];
    if (length > 1e-6 * sum) // less is rounding, where parts overlap
    {
      found += ", " + this->Viewed.Materials.Materials[static_cast<std::size_t>(material)].Name +
        " " + LengthText(length);
    }
  }
  return found;
}
}
