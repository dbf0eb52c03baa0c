// SPDX-License-Identifier: Apache-2.0
#include "Private/LiveProjection.h"

#include "Private/KilovoltageSpectrum.h"
#include "Private/PaneOverlay.h"
#include "mammoray/Foundation/Error.h"

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

XRayDetector OneRay(XRayDetector detector)
{
  detector.Samples = 1;
  return detector;
}

/// Two by two pixels as one; the rest at the far borders is dropped.
XRayDetector Halved(XRayDetector detector)
{
  detector.Origin = detector.Origin + 0.5 * (detector.ColumnStep + detector.RowStep);
  detector.ColumnStep = 2.0 * detector.ColumnStep;
  detector.RowStep = 2.0 * detector.RowStep;
  detector.Columns = std::max(detector.Columns / 2, 1);
  detector.Rows = std::max(detector.Rows / 2, 1);
  return detector;
}
}

LiveProjection::LiveProjection(const Scene& viewed, const ProjectorOptions& options)
  : Viewed(viewed)
  , Full(OneRay(viewed.Detector))
  , Half(Halved(this->Full))
  , Samples(Assemble(viewed))
  , TurnAxis{ MiddleOf(BoxOf(*this->Samples)), -1.0 * viewed.Detector.RowStep }
  , Device(options)
  , Current(viewed)
  , SourceNow(viewed.Source)
{
  this->Current.Samples = { { this->Samples } };
  this->Current.Detection = {};
  this->Current.Field = {};
  this->Current.Scatter = {};
  this->Current.Refraction.reset();
  this->SetSpectrum(viewed.XRays);
  this->Project(1); // refuses a detector or a source that is none
}

void LiveProjection::SetSpectrum(const Spectrum& spectrum)
{
  spectrum.Validate();
  this->Given = this->Current.XRays = spectrum;
  this->SingleEnergy = spectrum.EnergiesKeV.size() == 1;
  if (this->SingleEnergy)
  {
    const double energy = spectrum.EnergiesKeV.front();
    this->Range = { std::min(std::max(0.5 * energy, LeastEnergyKeV), energy),
      std::max(std::min(2 * energy, MostEnergyKeV), energy) };
    this->EnergyNow = energy;
  }
  else
  {
    const double voltage = KilovoltageOf(spectrum);
    this->Range = { std::max(voltage - TubeRange, spectrum.EnergiesKeV.front() + 2),
      voltage + TubeRange };
    this->EnergyNow = voltage;
  }
  this->IsStale = true;
}

void LiveProjection::SetTurn(double degrees)
{
  this->IsStale = this->IsStale || degrees != this->TurnDeg;
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
  this->IsStale = true;
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
  if (energy == this->EnergyNow)
  {
    return;
  }
  this->Current.XRays = this->SingleEnergy ? Spectrum::Monochromatic(energy)
    : energy == KilovoltageOf(this->Given) ? this->Given
                                           : AtKilovoltage(this->Given, energy);
  this->EnergyNow = energy;
  this->IsStale = true;
}

const std::vector<float>& LiveProjection::Project(int divisor)
{
  if (this->IsStale || divisor != this->PictureDivisor)
  {
    // The samples turn: so do, the other way about, source and detector before them.
    const ProjectionView view =
      TurnSample(this->SourceNow, this->Detector(divisor), this->TurnAxis, 2, 2 * this->TurnDeg)[1];
    this->Current.Source = view.Source;
    this->Current.Detector = view.Detector;
    this->Picture = this->Device.Expose(this->Current);
  }
  this->IsStale = false;
  this->PictureDivisor = divisor;
  return this->Picture.LogAttenuation;
}

std::string LiveProjection::Describe(double column, double row)
{
  if (!(column >= -0.5 && row >= -0.5 && column <= this->Full.Columns - 0.5 &&
        row <= this->Full.Rows - 0.5))
  {
    throw InputError("expected a pixel of the picture, " + std::to_string(this->Full.Columns) +
      " x " + std::to_string(this->Full.Rows));
  }
  this->Project(this->PictureDivisor);
  const PathLengthImage& lengths = *this->Picture.Lengths;
  const auto index = [this](double at, int most)
  { return std::clamp(static_cast<int>(std::lround(at)) / this->PictureDivisor, 0, most - 1); };
  const std::size_t pixel =
    static_cast<std::size_t>(index(row, lengths.Rows)) * static_cast<std::size_t>(lengths.Columns) +
    static_cast<std::size_t>(index(column, lengths.Columns));
  char text[120];
  std::snprintf(text, sizeof text, "pixel (%.1f, %.1f): transmission %.4g", column, row,
    std::exp(-this->Picture.LogAttenuation[pixel]));
  std::string found = text;
  double sum = 0;
  for (int material = 1; material < lengths.Materials; ++material)
  {
    sum += lengths.Material(material)[pixel];
  }
  for (int material = 1; material < lengths.Materials; ++material)
  {
    const double length = lengths.Material(material)[pixel];
    if (length > 1e-6 * sum) // less is rounding, where parts overlap
    {
      found += ", " + this->Viewed.Materials.Materials[static_cast<std::size_t>(material)].Name +
        " " + LengthText(length);
    }
  }
  return found;
}
}
