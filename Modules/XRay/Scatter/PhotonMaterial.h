// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PhotonMaterial_h
#define mammoray_PhotonMaterial_h

#include "mammoray/XRay/RandomStream.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Linear interaction coefficients, 1/mm.
struct PhotonInteractions
{
  double Photoelectric = 0;
  double Rayleigh = 0;
  double Compton = 0;

  double Total() const { return this->Photoelectric + this->Rayleigh + this->Compton; }
};

/// A photon after a collision: cosine of the scattering angle, and energy, keV.
struct ScatteredPhoton
{
  double Cosine = 1;
  double EnergyKeV = 0;
};

/**
 * How photons of 1 to 150 keV interact with a composition. Cross sections, form factors and
 * incoherent scattering functions of the elements are xraylib's (Schoonjans et al., Spectrochimica
 * Acta B 66, 2011; form factors of Hubbell et al. 1975) for independent atoms: interference between
 * molecules and Doppler broadening are neglected. Absorbed energy stays in place: there is no
 * fluorescence and no electron transport, whose range in tissue below 150 keV is less than 0.3 mm.
 */
class MAMMORAYXRAY_EXPORT PhotonMaterial
{
public:
  static constexpr double LowestKeV = 1;
  static constexpr double HighestKeV = 150;

  /// See ParseComposition for the text; throws InputError as it does, and unless the density
  /// (g/cm^3) is positive and finite.
  PhotonMaterial(const std::string& composition, double densityGPerCm3);
  /// A vacuum.
  PhotonMaterial();

  /// Coefficients at an energy, which is clamped to this range.
  PhotonInteractions At(double energyKeV) const;
  /// Samples coherent scattering: (1 + c^2) F(x)^2, x = sin(angle / 2) / wavelength.
  ScatteredPhoton Rayleigh(double energyKeV, RandomStream& random) const;
  /// Samples incoherent scattering: the Klein-Nishina formula times S(x).
  ScatteredPhoton Compton(double energyKeV, RandomStream& random) const;
  /// Energy-transfer coefficient, 1/mm: the whole energy in photoelectric and the loss in Compton
  /// collisions. Energy re-emitted by fluorescence and bremsstrahlung is included.
  double EnergyTransfer(double energyKeV) const;
  double DensityGPerCm3() const { return this->Density; }

private:
  double Density = 0;
  /// At logarithmically spaced energies.
  std::vector<PhotonInteractions> Table;
  /// Over x = MostTransfer (i / n)^2: the integral of F^2 over x^2, and S.
  std::vector<double> FormFactorIntegral;
  std::vector<double> ScatteringFunction;

  double TableAt(const std::vector<double>& table, double transfer) const;
};

/// A photon's energy after a Compton collision with an electron at rest, keV.
MAMMORAYXRAY_EXPORT double ComptonEnergy(double energyKeV, double cosine);

/// Dose of 1 keV in 1 g, mGy.
inline constexpr double MilligrayGramPerKeV = 1.602176634e-10;

/// Kerma of a photon fluence of 1 per mm^2 in air near sea level, mGy (EnergyTransfer). 1 to 150
/// keV.
MAMMORAYXRAY_EXPORT double AirKermaPerFluence(double energyKeV);
}

#endif
