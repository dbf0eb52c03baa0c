// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scatter/Photons.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/XRay/Composition.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <xraylib.h>

namespace mammoray
{
namespace
{
constexpr int EnergyCount = 1500;
constexpr int TransferCount = 1500;
constexpr double ElectronRestKeV = 510.99895;
/// keV times Angstrom.
constexpr double WavelengthKeV = 12.398419843;
constexpr double MostTransfer = PhotonMaterial::HighestKeV / WavelengthKeV;

double TransferOf(int index)
{
  const double share = static_cast<double>(index) / (TransferCount - 1);
  return MostTransfer * share * share;
}

double ClampEnergy(double energyKeV)
{
  return std::clamp(energyKeV, PhotonMaterial::LowestKeV, PhotonMaterial::HighestKeV);
}

/// sin(angle / 2) / wavelength, 1/Angstrom.
double Transfer(double energyKeV, double cosine)
{
  return energyKeV / WavelengthKeV * std::sqrt(std::max(0.5 * (1 - cosine), 0.0));
}

/// Klein's and Nishina's law over its value straight on, where it is largest.
double ComptonLaw(double ratio, double cosine)
{
  return 0.5 * ratio * ratio * (ratio + 1 / ratio - 1 + cosine * cosine);
}

/// Returns xraylib's value; 0 if it has none, for example for a shell that a photon cannot ionise.
template <typename Function>
double OfElement(const Function& function, int element, double at)
{
  return function(element, at, nullptr);
}
}

double ComptonEnergy(double energyKeV, double cosine)
{
  return energyKeV / (1 + energyKeV / ElectronRestKeV * (1 - cosine));
}

Vector3 TurnDirection(const Vector3& direction, double cosine, RandomStream& random)
{
  const double azimuth = 2 * std::numbers::pi * random.Uniform();
  const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
  // Two directions across, from the axis with the smallest component.
  Vector3 axis{ 0, 0, 0 };
  const auto magnitude = [&](std::size_t a) { return std::abs(direction[a]); };
  std::size_t least = magnitude(0) <= magnitude(1) ? 0 : 1;
  least = magnitude(least) <= magnitude(2) ? least : 2;
  axis[least] = 1;
  Vector3 u = Cross(direction, axis);
  u = (1 / Norm(u)) * u;
  const Vector3 v = Cross(direction, u);
  const Vector3 turned =
    cosine * direction + (sine * std::cos(azimuth)) * u + (sine * std::sin(azimuth)) * v;
  return (1 / Norm(turned)) * turned;
}

PhotonMaterial::PhotonMaterial()
  : Table(2)
{
}

PhotonMaterial::PhotonMaterial(const std::string& composition, double densityGPerCm3)
  : Density(densityGPerCm3)
{
  if (!(densityGPerCm3 > 0) || !std::isfinite(densityGPerCm3))
  {
    throw InputError("composition '" + composition + "': expected a positive density, found " +
      std::to_string(densityGPerCm3));
  }
  const CompositionParts parts = ParseComposition(composition, "composition");
  this->Table.resize(EnergyCount);
  for (int index = 0; index < EnergyCount; ++index)
  {
    const double energy =
      LowestKeV * std::pow(HighestKeV / LowestKeV, static_cast<double>(index) / (EnergyCount - 1));
    PhotonInteractions& sum = this->Table[static_cast<std::size_t>(index)];
    for (const auto& [element, fraction] : parts.MassFractions)
    {
      const double factor = 0.1 * densityGPerCm3 * fraction; // cm^2/g to 1/mm
      sum.Photoelectric += factor * OfElement(CS_Photo, element, energy);
      sum.Rayleigh += factor * OfElement(CS_Rayl, element, energy);
      sum.Compton += factor * OfElement(CS_Compt, element, energy);
    }
  }
  this->FormFactorIntegral.resize(TransferCount);
  this->ScatteringFunction.resize(TransferCount);
  double before = 0;
  for (int index = 0; index < TransferCount; ++index)
  {
    const double transfer = TransferOf(index);
    double squared = 0;
    double scattering = 0;
    for (const auto& [element, fraction] : parts.MassFractions)
    {
      const double atoms = fraction / AtomicWeight(element, nullptr);
      const double form = transfer == 0 ? element : OfElement(FF_Rayl, element, transfer);
      squared += atoms * form * form;
      scattering += transfer == 0 ? 0 : atoms * OfElement(SF_Compt, element, transfer);
    }
    const auto at = static_cast<std::size_t>(index);
    this->ScatteringFunction[at] = scattering;
    if (index > 0)
    {
      const double previous = TransferOf(index - 1);
      this->FormFactorIntegral[at] = this->FormFactorIntegral[at - 1] +
        0.5 * (before + squared) * (transfer * transfer - previous * previous);
    }
    before = squared;
  }
}

PhotonInteractions PhotonMaterial::At(double energyKeV) const
{
  const double place = std::log(ClampEnergy(energyKeV) / LowestKeV) /
    std::log(HighestKeV / LowestKeV) * static_cast<double>(this->Table.size() - 1);
  const std::size_t index = std::min(static_cast<std::size_t>(place), this->Table.size() - 2);
  const double share = place - static_cast<double>(index);
  const PhotonInteractions& low = this->Table[index];
  const PhotonInteractions& high = this->Table[index + 1];
  const auto between = [share](double a, double b) { return a + share * (b - a); };
  return { between(low.Photoelectric, high.Photoelectric), between(low.Rayleigh, high.Rayleigh),
    between(low.Compton, high.Compton) };
}

double PhotonMaterial::TableAt(const std::vector<double>& table, double transfer) const
{
  const double place =
    std::sqrt(std::clamp(transfer / MostTransfer, 0.0, 1.0)) * (TransferCount - 1);
  const std::size_t index =
    std::min<std::size_t>(static_cast<std::size_t>(place), TransferCount - 2);
  const double share = place - static_cast<double>(index);
  return table[index] + share * (table[index + 1] - table[index]);
}

ScatteredPhoton PhotonMaterial::Rayleigh(double energyKeV, RandomStream& random) const
{
  const double energy = ClampEnergy(energyKeV);
  const double most = this->TableAt(this->FormFactorIntegral, energy / WavelengthKeV);
  for (;;)
  {
    const double wanted = random.Uniform() * most;
    const auto above = std::upper_bound(this->FormFactorIntegral.begin() + 1,
      this->FormFactorIntegral.end() - 1, wanted);
    const auto index = static_cast<int>(above - this->FormFactorIntegral.begin());
    const double low = *(above - 1);
    const double share = *above > low ? (wanted - low) / (*above - low) : 0;
    const double from = TransferOf(index - 1);
    const double to = TransferOf(index);
    const double squared = from * from + share * (to * to - from * from);
    const double cosine = 1 - 2 * squared * WavelengthKeV * WavelengthKeV / (energy * energy);
    if (cosine >= -1 && 2 * random.Uniform() <= 1 + cosine * cosine)
    {
      return { cosine, energyKeV };
    }
  }
}

ScatteredPhoton PhotonMaterial::Compton(double energyKeV, RandomStream& random) const
{
  const double energy = ClampEnergy(energyKeV);
  const double most = this->TableAt(this->ScatteringFunction, energy / WavelengthKeV);
  for (;;)
  {
    const double cosine = 2 * random.Uniform() - 1;
    const double ratio = ComptonEnergy(energy, cosine) / energy;
    const double law = ComptonLaw(ratio, cosine);
    const double scattering = this->TableAt(this->ScatteringFunction, Transfer(energy, cosine));
    if (random.Uniform() * most <= law * scattering)
    {
      return { cosine, energyKeV * ratio };
    }
  }
}

double PhotonMaterial::EnergyTransfer(double energyKeV) const
{
  constexpr int Points = 400;
  const double energy = ClampEnergy(energyKeV);
  double all = 0;
  double lost = 0;
  for (int point = 0; point < Points; ++point)
  {
    const double cosine = 2 * (point + 0.5) / Points - 1;
    const double ratio = ComptonEnergy(energy, cosine) / energy;
    const double law =
      ComptonLaw(ratio, cosine) * this->TableAt(this->ScatteringFunction, Transfer(energy, cosine));
    all += law;
    lost += law * (1 - ratio);
  }
  const PhotonInteractions here = this->At(energyKeV);
  return here.Photoelectric + (all > 0 ? here.Compton * lost / all : 0);
}

double AirKermaPerFluence(double energyKeV)
{
  static const PhotonMaterial air("Air, Dry (near sea level)", 0.001205);
  // 1/mm to mm^2/g.
  return MilligrayGramPerKeV * energyKeV * air.EnergyTransfer(energyKeV) /
    (1e-3 * air.DensityGPerCm3());
}

AntiscatterGridOptions AntiscatterGridOptions::OfLead(const std::array<double, 3>& numbers,
  const std::string& interspace)
{
  AntiscatterGridOptions options;
  options.Ratio = numbers[0];
  options.LinesPerMm = 0.1 * numbers[1];
  options.SeptumMm = 1e-3 * numbers[2];
  if (interspace == "air")
  {
    options.Interspace = "Air, Dry (near sea level)";
    options.InterspaceDensityGPerCm3 = 0.001205;
  }
  else if (interspace == "aluminium")
  {
    options.Interspace = "Al";
    options.InterspaceDensityGPerCm3 = 2.699;
  }
  else if (interspace != "fibre")
  {
    throw InputError(
      "grid: expected fibre, air or aluminium between its septa, found '" + interspace + "'");
  }
  return options;
}

AntiscatterGrid::AntiscatterGrid(const AntiscatterGridOptions& options)
  : Options(options)
  , Septa(options.Septa, options.SeptaDensityGPerCm3)
  , Interspace(options.Interspace, options.InterspaceDensityGPerCm3)
{
  RequireBetween("grid", "a ratio", options.Ratio, 1, 30);
  RequireBetween("grid", "lines per mm", options.LinesPerMm, 0.5, 20);
  RequireBetween("grid", "a septum (mm)", options.SeptumMm, 1e-3, 0.95 / options.LinesPerMm);
  this->Gap = 1 / options.LinesPerMm - options.SeptumMm;
  this->Height = options.Ratio * this->Gap;
}

double AntiscatterGrid::Transmission(double energyKeV, double columnSlope, double rowSlope) const
{
  const double septum = this->Options.SeptumMm;
  const double period = septum + this->Gap;
  const double inSeptum = this->Septa.At(energyKeV).Total();
  const double between = this->Interspace.At(energyKeV).Total();
  const double way = this->Height * std::sqrt(1 + columnSlope * columnSlope + rowSlope * rowSlope);
  const double across =
    this->Height * std::abs(this->Options.AlongChestWall ? columnSlope : rowSlope);
  if (across < 1e-9 * period)
  {
    return (this->Gap * std::exp(-between * way) + septum * std::exp(-inSeptum * way)) / period;
  }
  // `across` covers whole periods and a rest; of the rest, what lies over septa changes with the
  // place between `least` and `most`, by ramps of slope 1 with flat parts between.
  const double whole = std::floor(across / period);
  const double rest = across - whole * period;
  const double most = std::min(septum, rest);
  const double least = std::max(rest - this->Gap, 0.0);
  const double slant = way / across;
  const auto passed = [&](double overSeptum)
  {
    const double lead = whole * septum + overSeptum;
    return std::exp(-slant * (inSeptum * lead + between * (across - lead)));
  };
  const double rate = slant * (inSeptum - between);
  const double ramp = std::abs(rate) * (most - least) > 1e-8 ? (passed(least) - passed(most)) / rate
                                                             : (most - least) * passed(least);
  return (std::abs(septum - rest) * passed(most) + std::abs(this->Gap - rest) * passed(least) +
           2 * ramp) /
    period;
}

double AntiscatterGrid::PrimaryTransmission(double energyKeV) const
{
  return this->Transmission(energyKeV, 0, 0);
}

double AntiscatterGrid::TransmissionAt(double energyKeV, double angle) const
{
  constexpr int Sides = 64;
  const double slope = std::tan(angle);
  double sum = 0;
  // By symmetry, a quarter of the circle suffices.
  for (int side = 0; side < Sides; ++side)
  {
    const double azimuth = 0.5 * std::numbers::pi * (side + 0.5) / Sides;
    sum += this->Transmission(energyKeV, slope * std::cos(azimuth), slope * std::sin(azimuth));
  }
  return sum / Sides;
}
}
