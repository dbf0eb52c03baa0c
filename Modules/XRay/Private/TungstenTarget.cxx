// SPDX-License-Identifier: Apache-2.0
#include "Private/TungstenTarget.h"

#include <xraylib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
constexpr double ElectronKeV = 510.99895;
constexpr double FineStructure = 1 / 137.035999;
constexpr double ElectronRadiusCm = 2.8179403e-13;
constexpr double AtomsPerMole = 6.02214076e23;
constexpr double AtomsPerGram = AtomsPerMole / TungstenMolarMassG;
/// Electrons per mAs, spread over a sphere of 1 m radius, per mm^2.
constexpr double PerMasAtOneMetre = 6.241509e15 / (4 * std::numbers::pi * 1e6);
constexpr double LeastKeV = 5;
constexpr int IntegrationSteps = 160;

/// Thomson-Whiddington constant of tungsten by Tucker, Barnes and Chakraborty (1991), keV^2 cm^2 /
/// g, linear between and beyond the voltages they give.
double ThomsonWhiddington(double kilovolts)
{
  constexpr std::array<double, 5> at{ 50, 75, 100, 150, 200 };
  constexpr std::array<double, 5> values{ 0.54e6, 0.625e6, 0.70e6, 0.84e6, 1.00e6 };
  std::size_t upper = 1;
  while (upper + 1 < at.size() && kilovolts > at[upper])
  {
    ++upper;
  }
  return std::lerp(values[upper - 1], values[upper],
    (kilovolts - at[upper - 1]) / (at[upper] - at[upper - 1]));
}

/// Bethe's mass stopping power by collisions, keV cm^2 / g.
double StoppingPower(double energyKeV)
{
  const double tau = energyKeV / ElectronKeV;
  const double gamma = tau + 1;
  const double beta2 = 1 - 1 / (gamma * gamma);
  const double rest =
    1 - beta2 + (tau * tau / 8 - (2 * tau + 1) * std::numbers::ln2) / (gamma * gamma);
  return 153.536 * TungstenNumber / (TungstenMolarMassG * beta2) *
    (2 * std::log(energyKeV / TungstenPotentialKeV) + std::log1p(tau / 2) + rest);
}

/// k dsigma/dk of an electron of this kinetic energy that emits a photon, cm^2 per atom: formula
/// 3BN times Elwert's factor. Energies E0, E and momenta p0, p in units of the electron's mass.
double PhotonCrossSection(double kineticKeV, double photonKeV)
{
  const double k = photonKeV / ElectronKeV;
  const double E0 = 1 + kineticKeV / ElectronKeV;
  const double E = std::max(E0 - k, 1 + 1e-9);
  const double p0 = std::sqrt(E0 * E0 - 1);
  const double p = std::sqrt(E * E - 1);
  const double e0 = 2 * std::log(E0 + p0);
  const double e = 2 * std::log(E + p);
  const double L = 2 * std::log((E0 * E + p0 * p - 1) / k);
  const double pp = p0 * p;
  const double p0Cubed = p0 * p0 * p0;
  const double pCubed = p * p * p;
  const double bracket = 4.0 / 3 - 2 * E0 * E * (p * p + p0 * p0) / (pp * pp) + e0 * E / p0Cubed +
    e * E0 / pCubed - e * e0 / pp +
    L *
      (8 * E0 * E / (3 * pp) + k * k * (E0 * E0 * E * E + pp * pp) / (pp * pp * pp) +
        k / (2 * pp) *
          ((E0 * E + p0 * p0) / p0Cubed * e0 - (E0 * E + p * p) / pCubed * e +
            2 * k * E0 * E / (pp * pp)));
  const double coulomb = 2 * std::numbers::pi * FineStructure * TungstenNumber;
  const double beta0 = p0 / E0;
  const double beta = p / E;
  const double elwert =
    beta0 * -std::expm1(-coulomb / beta0) / (beta * -std::expm1(-coulomb / beta));
  return FineStructure * ElectronRadiusCm * ElectronRadiusCm * TungstenNumber * TungstenNumber * p /
    p0 * bracket * elwert;
}

/**
 * Electrons of one voltage that slow down in a target of one angle. The share that turns back is
 * U^m C with m = 0.1382 - 0.9211 / sqrt(Z) and C = 0.1904 - 0.2236 ln Z + 0.1292 ln^2 Z - 0.01491
 * ln^3 Z, 0.4325 for tungsten (Hunger and Kuechler 1979; the same in Ebel, X-Ray Spectrom. 28,
 * 1999, 255).
 */
class SlowingElectrons
{
public:
  SlowingElectrons(double kilovolts, double targetAngleDeg)
    : Kilovolts(kilovolts)
    , Cotangent(1 / std::tan(targetAngleDeg * std::numbers::pi / 180))
    , Depth(ThomsonWhiddington(kilovolts))
    , Returning(0.4325 * std::pow(kilovolts, 0.1382 - 0.9211 / std::sqrt(TungstenNumber)))
  {
  }

  /// Photons per electron that leave the target: the integral over the electron's energy from
  /// `lowestKeV` to its first of a cross section (cm^2 per atom) by the stopping power.
  template <typename CrossSection>
  double Photons(double lowestKeV, double photonKeV, const CrossSection& crossSection) const
  {
    const double range = this->Kilovolts - lowestKeV;
    if (!(range > 0))
    {
      return 0;
    }
    const double mu = CS_Total(TungstenNumber, photonKeV, nullptr);
    double sum = 0;
    for (int step = 0; step < IntegrationSteps; ++step)
    {
      const double energy = lowestKeV + range * (step + 0.5) / IntegrationSteps;
      const double u = energy / this->Kilovolts;
      const double depth =
        1.5 * (this->Kilovolts * this->Kilovolts - energy * energy) / this->Depth;
      const double exponent = mu * depth * this->Cotangent;
      const double escape = exponent > 1e-9 ? -std::expm1(-exponent) / exponent : 1;
      const double inside = 1 - this->Returning * (1 - u * u * u);
      sum += crossSection(energy) / StoppingPower(energy) * escape * inside;
    }
    return AtomsPerGram * sum * range / IntegrationSteps;
  }

  /// K lines per electron, of all energies, of which a line has `share`.
  double KPhotons(double edgeKeV, double photonKeV, double share) const
  {
    const double excess = this->Kilovolts / edgeKeV - 1;
    const double range =
      (this->Kilovolts * this->Kilovolts - edgeKeV * edgeKeV) / this->Depth; // g/cm^2
    const double mu = CS_Total(TungstenNumber, photonKeV, nullptr);
    double escape = 0;
    for (int step = 0; step < IntegrationSteps; ++step)
    {
      const double x = (step + 0.5) / IntegrationSteps;
      escape += 1.5 * (1 - x * x) * std::exp(-mu * range * x * this->Cotangent) / IntegrationSteps;
    }
    // Photons per electron and exponent, and the parabola of depths, are fits to measured spectra
    // by Tucker, Barnes and Chakraborty (1991).
    return excess > 0 ? 1.349e-3 * std::pow(excess, 1.648) * share * escape : 0;
  }

private:
  double Kilovolts;
  double Cotangent;
  /// Thomson-Whiddington constant, keV^2 cm^2 / g.
  double Depth;
  /// Share of the electrons that turn back.
  double Returning;
};

/// Adds photons to the bin that is nearest.
void AddLine(Spectrum& spectrum, double energyKeV, double photons)
{
  const auto above =
    std::lower_bound(spectrum.EnergiesKeV.begin(), spectrum.EnergiesKeV.end(), energyKeV);
  auto bin = static_cast<std::size_t>(above - spectrum.EnergiesKeV.begin());
  if (bin == spectrum.EnergiesKeV.size() ||
    (bin > 0 && energyKeV - spectrum.EnergiesKeV[bin - 1] < spectrum.EnergiesKeV[bin] - energyKeV))
  {
    --bin;
  }
  spectrum.Weights[bin] += photons;
}

void AddKLines(const SlowingElectrons& electrons, Spectrum& spectrum)
{
  struct Line
  {
    int Name;
    double Share;
  };
  // The shares of Tucker, Barnes and Chakraborty.
  constexpr std::array<Line, 4> lines{ { { KL3_LINE, 0.45 }, { KL2_LINE, 0.2592 },
    { KM3_LINE, 0.1521 }, { KN3_LINE, 0.0387 } } };
  const double edge = EdgeEnergy(TungstenNumber, K_SHELL, nullptr);
  for (const auto& [name, share] : lines)
  {
    const double energy = LineEnergy(TungstenNumber, name, nullptr);
    AddLine(spectrum, energy, electrons.KPhotons(edge, energy, share));
  }
}

void AddLLines(const SlowingElectrons& electrons, Spectrum& spectrum)
{
  constexpr std::array<int, 3> shells{ L1_SHELL, L2_SHELL, L3_SHELL };
  constexpr std::array<int, 3> occupied{ 2, 2, 4 };
  constexpr double powell = 6.51e-20 * 0.25; // cm^2 keV^2 per electron
  const auto kronig = [](int transition)
  { return CosKronTransProb(TungstenNumber, transition, nullptr); };
  const double to12 = kronig(FL12_TRANS);
  const double to23 = kronig(FL23_TRANS);
  const double to13 = kronig(FL13_TRANS) + to12 * to23;
  struct Line
  {
    int Name;
    std::size_t Shell;
  };
  for (const auto& [name, shell] : { Line{ L3M5_LINE, 2 }, { L3M4_LINE, 2 }, { L3N5_LINE, 2 },
         { L3N4_LINE, 2 }, { L3M1_LINE, 2 }, { L2M4_LINE, 1 }, { L2N4_LINE, 1 }, { L2M1_LINE, 1 },
         { L1M3_LINE, 0 }, { L1M2_LINE, 0 }, { L1N3_LINE, 0 }, { L1N2_LINE, 0 } })
  {
    const double energy = LineEnergy(TungstenNumber, name, nullptr);
    std::array<double, 3> holes{};
    for (std::size_t index = 0; index < holes.size(); ++index)
    {
      const double edge = EdgeEnergy(TungstenNumber, shells[index], nullptr);
      holes[index] = electrons.Photons(edge, energy,
        [&](double kinetic)
        { return powell * occupied[index] * std::log(kinetic / edge) / (edge * kinetic); });
    }
    // Holes move to subshells of less energy before photons fill them.
    const double filled = shell == 0 ? holes[0]
      : shell == 1                   ? holes[1] + to12 * holes[0]
                                     : holes[2] + to23 * holes[1] + to13 * holes[0];
    AddLine(spectrum, energy,
      filled * FluorYield(TungstenNumber, shells[shell], nullptr) *
        RadRate(TungstenNumber, name, nullptr));
  }
}
}

Spectrum TungstenSpectrum(double kilovolts, double targetAngleDeg)
{
  const SlowingElectrons electrons(kilovolts, targetAngleDeg);
  const double step = kilovolts > 60 ? 1 : 0.5;
  Spectrum spectrum;
  for (int bin = static_cast<int>((kilovolts - LeastKeV) / step); bin >= 1; --bin)
  {
    const double energy = kilovolts - step * bin;
    spectrum.EnergiesKeV.push_back(energy);
    spectrum.Weights.push_back(step / energy *
      electrons.Photons(energy, energy,
        [&](double kinetic) { return PhotonCrossSection(kinetic, energy); }));
  }
  AddKLines(electrons, spectrum);
  AddLLines(electrons, spectrum);
  for (double& weight : spectrum.Weights)
  {
    weight *= PerMasAtOneMetre;
  }
  return spectrum;
}
}
