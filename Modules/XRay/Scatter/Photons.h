// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Photons_h
#define mammoray_Photons_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * Random numbers that depend only on a seed and on the number of a pixel or photon, so that any
 * number of threads may share the work: splitmix64 (Steele, Lea and Flood 2014).
 */
class RandomStream
{
public:
  RandomStream(std::uint64_t seed, std::uint64_t number)
    : State(Mix(seed + 0x9e3779b97f4a7c15) ^ Mix(number * 0x9e3779b97f4a7c15 + 1))
  {
  }
  /// Uniformly distributed in (0, 1), with 53 random bits.
  double Uniform()
  {
    this->State += 0x9e3779b97f4a7c15;
    return (static_cast<double>(Mix(this->State) >> 11) + 0.5) * 0x1p-53;
  }

private:
  static std::uint64_t Mix(std::uint64_t value)
  {
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
    value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
    return value ^ (value >> 31);
  }
  std::uint64_t State;
};

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
 * How photons of 1 to 500 keV interact with a composition. Cross sections, form factors and
 * incoherent scattering functions of the elements are xraylib's (Schoonjans et al., Spectrochimica
 * Acta B 66, 2011; form factors of Hubbell et al. 1975) for independent atoms: interference between
 * molecules and Doppler broadening are neglected. Absorbed energy stays in place: there is no
 * fluorescence and no electron transport. Electrons reach 0.3 mm in tissue at 150 keV, 2 mm in
 * tissue and 0.3 mm in steel at 500 keV; fluorescence matters in lead and tungsten.
 */
class MAMMORAYXRAY_EXPORT PhotonMaterial
{
public:
  static constexpr double LowestKeV = 1;
  static constexpr double HighestKeV = 500;

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

/// The unit vector `direction`, deflected by an angle of this cosine at a random azimuth.
MAMMORAYXRAY_EXPORT Vector3 TurnDirection(const Vector3& direction, double cosine,
  RandomStream& random);

/// Dose of 1 keV in 1 g, mGy.
inline constexpr double MilligrayGramPerKeV = 1.602176634e-10;

/// Kerma of a photon fluence of 1 per mm^2 in air near sea level, mGy (EnergyTransfer). 1 to 500
/// keV.
MAMMORAYXRAY_EXPORT double AirKermaPerFluence(double energyKeV);

/// A linear anti-scatter grid focused on the source: septa, and the material between them.
struct MAMMORAYXRAY_EXPORT AntiscatterGridOptions
{
  /// Height of the septa divided by their distance; 1 to 30. Mammography has 4 to 6.
  double Ratio = 5;
  /// 0.5 to 20.
  double LinesPerMm = 3.1;
  /// Thickness of a septum, mm; more than 0 and less than the period.
  double SeptumMm = 0.065;
  /// Compositions (see FindComposition), with densities, g/cm^3. Defaults: lead, fibre.
  std::string Septa = "Pb";
  double SeptaDensityGPerCm3 = 11.35;
  std::string Interspace = "Polystyrene";
  double InterspaceDensityGPerCm3 = 1.06;
  /// True: septa run along the detector's row direction, in a mammography unit along the chest
  /// wall. False: along the column direction.
  bool AlongChestWall = true;

  /// A lead grid from its usual numbers: ratio, lines per cm, thickness of a septum in micrometres.
  /// `interspace` is "fibre", "air" or "aluminium"; throws InputError on another word.
  static AntiscatterGridOptions OfLead(const std::array<double, 3>& numbers,
    const std::string& interspace = "fibre");
  bool operator==(const AntiscatterGridOptions&) const = default;
};

/**
 * Transmission of a grid, averaged over the points where photons meet it: the mean over one period
 * of exp(-mu_s l_s - mu_i l_i), with the path lengths l_s in septa and l_i between them. In closed
 * form: the path across septa is a sum of whole periods and a trapezoid (as in Day and Dance, Phys.
 * Med. Biol. 28, 1983). Photons that interact in the grid are lost. There are no covers.
 */
class MAMMORAYXRAY_EXPORT AntiscatterGrid
{
public:
  /// Throws InputError on options out of range.
  explicit AntiscatterGrid(const AntiscatterGridOptions& options);

  /// Transmission of a photon that deviates from the direction of the focus by these slopes
  /// (tangents) along the detector's columns and rows.
  double Transmission(double energyKeV, double columnSlope, double rowSlope) const;
  /// Transmission of a photon from the focus.
  double PrimaryTransmission(double energyKeV) const;
  /// Mean of Transmission over the azimuth, for a deviation by this angle, radians below pi/2.
  double TransmissionAt(double energyKeV, double angle) const;

private:
  AntiscatterGridOptions Options;
  PhotonMaterial Septa;
  PhotonMaterial Interspace;
  /// mm.
  double Gap = 0;
  double Height = 0;
};
}

#endif
