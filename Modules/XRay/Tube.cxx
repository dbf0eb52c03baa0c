// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Tube.h"

#include "Private/TubeCoefficients.h"
#include "Private/TungstenTarget.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/XRay/Composition.h"

#include <xraylib.h>

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr double BinKeV = 0.5;
constexpr double LowestTubeKeV = 5;
constexpr double LeastKilovolts = 18;
constexpr double MostKilovolts = 42;
constexpr double LeastComputedKilovolts = 20;
constexpr double MostComputedKilovolts = 450;
constexpr double LeastAngleDeg = 3;
constexpr double MostAngleDeg = 60;
constexpr double UsualAngleDeg = 12;

/// Returns true if the spectrum is computed instead of interpolated from measured ones.
bool IsComputed(const XRayTube& tube)
{
  return tube.Anode == "W" && (tube.TargetAngleDeg != 0 || tube.KilovoltagePeak > MostKilovolts);
}

const TubeAnode& FindAnode(const std::string& name)
{
  const auto& anodes = TubeAnodes();
  const auto found = std::find_if(anodes.begin(), anodes.end(),
    [&](const TubeAnode& anode) { return name == anode.Name; });
  if (found == anodes.end())
  {
    throw InputError("tube: expected an anode of W, Mo or Rh, found '" + name + "'");
  }
  return *found;
}

/// The attenuation of a layer's material; refuses a thickness that is none.
AttenuationTable TableOf(const XRayFilter& layer, const std::string& who)
{
  if (!(layer.ThicknessMm >= 0 && std::isfinite(layer.ThicknessMm)))
  {
    throw InputError(who + ": expected a thickness that is not negative, found " +
      NumberText(layer.ThicknessMm) + " mm of " + layer.Material);
  }
  return RequireComposition(layer.Material, who);
}

Spectrum MeasuredSpectrum(const TubeAnode& anode, double kilovolts)
{
  Spectrum spectrum;
  for (std::size_t bin = 0; bin < anode.Bins->size(); ++bin)
  {
    const double energy = anode.FirstKeV + BinKeV * static_cast<double>(bin);
    if (energy < LowestTubeKeV || energy > kilovolts)
    {
      continue;
    }
    const TubePolynomial& a = (*anode.Bins)[bin];
    spectrum.EnergiesKeV.push_back(energy);
    spectrum.Weights.push_back(
      std::max(0.0, a[0] + kilovolts * (a[1] + kilovolts * (a[2] + kilovolts * a[3]))));
  }
  return spectrum;
}

/// Air kerma per photon, in any unit.
double KermaPerPhoton(double energyKeV)
{
  return energyKeV * CS_Energy_CP("Air, Dry (near sea level)", energyKeV, nullptr);
}
}

XRayFilter XRayFilter::FromText(const std::string& text, const std::string& what)
{
  XRayFilter filter;
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 ||
    !ToNumber(text.substr(colon + 1), filter.ThicknessMm) || !(filter.ThicknessMm >= 0) ||
    !std::isfinite(filter.ThicknessMm))
  {
    throw InputError(
      what + ": expected MATERIAL[@DENSITY]:MM, as in Rh:0.05, found '" + text + "'");
  }
  filter.Material = text.substr(0, colon);
  filter.DensityGPerCm3 = TakeDensity(filter.Material, what);
  return filter;
}

void XRayTube::Validate() const
{
  FindAnode(this->Anode);
  if (this->TargetAngleDeg != 0)
  {
    if (this->Anode != "W")
    {
      throw InputError("tube: expected a target angle of a tungsten anode only, found " +
        NumberText(this->TargetAngleDeg) + " degrees of " + this->Anode);
    }
    if (!(this->TargetAngleDeg >= LeastAngleDeg && this->TargetAngleDeg <= MostAngleDeg))
    {
      throw InputError("tube: expected a target angle of " + NumberText(LeastAngleDeg) + " to " +
        NumberText(MostAngleDeg) + " degrees, found " + NumberText(this->TargetAngleDeg));
    }
  }
  const double least = this->TargetAngleDeg != 0 ? LeastComputedKilovolts : LeastKilovolts;
  const double most = this->Anode == "W" ? MostComputedKilovolts : MostKilovolts;
  if (!(this->KilovoltagePeak >= least && this->KilovoltagePeak <= most))
  {
    throw InputError("tube: expected " + NumberText(least) + " to " + NumberText(most) +
      " kVp of an anode of " + this->Anode + ", found " + NumberText(this->KilovoltagePeak));
  }
}

std::string XRayTube::Name() const
{
  std::string name = this->Anode + " " + NumberText(this->KilovoltagePeak) + " kVp";
  if (this->TargetAngleDeg != 0)
  {
    name += ", target at " + NumberText(this->TargetAngleDeg) + " degrees";
  }
  for (const XRayFilter& filter : this->Filters)
  {
    name += ", " + NumberText(filter.ThicknessMm) + " mm " + filter.Material;
  }
  return name;
}

Spectrum TubeSpectrum(const XRayTube& tube)
{
  tube.Validate();
  Spectrum spectrum = IsComputed(tube)
    ? TungstenSpectrum(tube.KilovoltagePeak,
        tube.TargetAngleDeg != 0 ? tube.TargetAngleDeg : UsualAngleDeg)
    : MeasuredSpectrum(FindAnode(tube.Anode), tube.KilovoltagePeak);
  for (const XRayFilter& filter : tube.Filters)
  {
    spectrum = FilterSpectrum(spectrum, filter);
  }
  spectrum.Name = tube.Name();
  spectrum.Validate();
  return spectrum;
}

Spectrum FilterSpectrum(const Spectrum& spectrum, const XRayFilter& filter)
{
  const AttenuationTable table = TableOf(filter, "filter");
  const double density = table.DensityOf(filter.DensityGPerCm3);
  Spectrum filtered = spectrum;
  for (std::size_t bin = 0; bin < filtered.Weights.size(); ++bin)
  {
    filtered.Weights[bin] *=
      std::exp(-filter.ThicknessMm * table.MuAt(filtered.EnergiesKeV[bin], density));
  }
  filtered.Validate();
  return filtered;
}

DetectorResponse AbsorbingDetector(const XRayFilter& layer)
{
  const AttenuationTable table = TableOf(layer, "detector");
  const double density = table.DensityOf(layer.DensityGPerCm3);
  DetectorResponse response = DetectorResponse::EnergyIntegrating;
  response.EnergiesKeV = table.EnergiesKeV;
  for (const double energy : table.EnergiesKeV)
  {
    response.Efficiency.push_back(-std::expm1(-layer.ThicknessMm * table.MuAt(energy, density)));
  }
  return response;
}

double HalfValueLayerMm(const Spectrum& spectrum, const std::string& composition)
{
  spectrum.Validate();
  const AttenuationTable table = RequireComposition(composition, "half-value layer");
  const double density = table.DensityOf(0);
  std::vector<double> kerma;
  std::vector<double> mu;
  double whole = 0;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    kerma.push_back(spectrum.Weights[bin] * KermaPerPhoton(spectrum.EnergiesKeV[bin]));
    mu.push_back(table.MuAt(spectrum.EnergiesKeV[bin], density));
    whole += kerma.back();
  }
  const auto left = [&](double thickness)
  {
    double sum = 0;
    for (std::size_t bin = 0; bin < kerma.size(); ++bin)
    {
      sum += kerma[bin] * std::exp(-mu[bin] * thickness);
    }
    return sum / whole;
  };
  // Between the layers of the most and the least absorbed photons.
  double low = std::log(2.0) / *std::max_element(mu.begin(), mu.end());
  double high = std::log(2.0) / *std::min_element(mu.begin(), mu.end());
  for (int step = 0; step < 60; ++step)
  {
    const double middle = 0.5 * (low + high);
    (left(middle) > 0.5 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}
}
