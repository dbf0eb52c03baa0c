// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Beam_h
#define mammoray_Beam_h

#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Numbers of photons by energy.
struct MAMMORAYXRAY_EXPORT Spectrum
{
  std::string Name;
  /// Ascending, keV.
  std::vector<double> EnergiesKeV;
  /// Photons per bin, any common factor; not negative, 1e-100 to 1e100 in all.
  std::vector<double> Weights;

  static Spectrum Monochromatic(double energyKeV);
  /// Mean photon energy, keV.
  double MeanEnergyKeV() const;
  /// The largest photon energy, keV, which equals the tube's kV: one bin beyond the last with
  /// photons.
  double PeakEnergyKeV() const;
  void Validate() const;
  bool operator==(const Spectrum&) const = default;
};

/// Linear attenuation of a material by energy.
struct MAMMORAYXRAY_EXPORT AttenuationTable
{
  std::string Name;
  /// The density of MuPerMm.
  double NominalDensityGPerCm3 = 1.0;
  /// Ascending, keV.
  std::vector<double> EnergiesKeV;
  /// Linear attenuation coefficient at each energy and the nominal density, 1/mm.
  std::vector<double> MuPerMm;
  /// False where each use must state its density: nobody knows that of a formula.
  bool HasDensity = true;

  /// The density that is stated or, where it is 0, the nominal one, g/cm^3. Throws InputError where
  /// there is neither, and outside ValidRanges::PartDensity.
  double DensityOf(double statedGPerCm3) const;
  /// Log-log interpolation, scaled by density / nominal density, 1/mm. Throws InputError outside
  /// the table's energies.
  double MuAt(double energyKeV, double densityGPerCm3) const;
  void Validate() const;
};

/// The signal D(E) of a photon that meets the detector.
struct MAMMORAYXRAY_EXPORT DetectorResponse
{
  /// True: D(E) is the photon's energy, keV. False: 1.
  bool ByEnergy = true;
  /// A factor on that, 0 to 1e12, at ascending energies, keV. It is interpolated linearly, and
  /// constant beyond the first and last energy. Empty: 1.
  std::vector<double> EnergiesKeV;
  std::vector<double> Efficiency;

  double Signal(double energyKeV) const;
  /// Throws InputError unless the factor fulfils these conditions.
  void Validate() const;
  bool operator==(const DetectorResponse&) const = default;

  static const DetectorResponse EnergyIntegrating; ///< D(E) = E
  static const DetectorResponse PhotonCounting;    ///< D(E) = 1
};
inline const DetectorResponse DetectorResponse::EnergyIntegrating{ true, {}, {} };
inline const DetectorResponse DetectorResponse::PhotonCounting{ false, {}, {} };

/**
 * The polychromatic Beer-Lambert law of a beam and a set of materials:
 * I / I0 = sum_E w_E D(E) exp(-sum_m mu_m(E) L_m) / sum_E w_E D(E).
 */
class MAMMORAYXRAY_EXPORT Beam
{
public:
  /**
   * `tables[m]` is the attenuation of material m (null for material 0, air, whose attenuation is
   * neglected) and `densities[m]` its density (see DensityOf). Throws InputError on any of them,
   * and where the detector does not respond to any photon of the spectrum.
   */
  Beam(const Spectrum& spectrum, const DetectorResponse& response,
    const std::vector<const AttenuationTable*>& tables, const std::vector<double>& densities);

  /**
   * Transmission I / I0 in [0, 1] of each pixel; Rows * Columns values, row by row. Relative error
   * at most 1e-7 besides that of the path lengths; 0 below the smallest float.
   */
  std::vector<float> Transmission(const PathLengthImage& image) const;
  /// -ln(I / I0) of each pixel, accurate also where little is absorbed.
  std::vector<float> LogAttenuation(const PathLengthImage& image) const;
  /**
   * The derivative of LogAttenuation with respect to each path length, 1/mm. It is the attenuation
   * averaged over the photons that the pixel detects; value[(material * Rows + row) * Columns +
   * column], 0 for air.
   */
  std::vector<float> MeanAttenuation(const PathLengthImage& image) const;
  /**
   * The reverse of Transmission. From dLoss / dTransmission of each pixel it gives dLoss / dLength,
   * 1/mm, in the order of PathLengthImage::Lengths. It adds the loss's derivatives with respect to
   * a relative change of each material's attenuation at all energies, and of the number of photons
   * at each energy of EnergyWeights. Sizes must fit.
   */
  std::vector<float> Backward(const PathLengthImage& image,
    const std::vector<double>& lossByTransmission, std::vector<double>& lossByAttenuation,
    std::vector<double>& lossByWeight) const;
  /// Transmission of one ray; `lengthsMm[m]` for each material.
  double Transmission(const double* lengthsMm) const;
  /// -ln(I / I0) of one ray.
  double LogAttenuation(const double* lengthsMm) const;
  /**
   * Adds weight * I / I0 of every pixel to `transmission`, and, where `variance` is given, weight
   * times its variance per incident photon: of N photons that meet a pixel without the object, on
   * average, the signal's variance is N times it, in units of one photon's mean signal,
   * sum_E w_E D(E)^2 exp(..) sum_E w_E / (sum_E w_E D(E))^2. Rows * Columns values each.
   */
  void AddTransmission(const PathLengthImage& image, double weight,
    std::vector<double>& transmission, std::vector<double>* variance = nullptr) const;
  int NumberOfMaterials() const { return this->MaterialCount; }
  /// Throws InputError if the beam has fewer than `count` materials, air included.
  void CheckMaterials(int count) const;
  /// w_E D(E) of each energy with photons, divided by their sum.
  const std::vector<double>& EnergyWeights() const { return this->Weights; }
  /// Attenuation of a material at the energy of EnergyWeights()[energy], 1/mm; 0 for air.
  double MuPerMm(std::size_t energy, int material) const
  {
    return this->Mu[energy * static_cast<std::size_t>(this->MaterialCount) +
      static_cast<std::size_t>(material)];
  }

private:
  /// Calls visit(weight, exponent) for each energy along a ray: I / I0 is the sum of
  /// weight exp(exponent).
  template <typename Visit>
  void ForEachEnergy(const double* lengthsMm, const Visit& visit) const;
  /**
   * store(pixel, transmission, variance) for every pixel that sees material, on several
   * threads; the variance is 0 unless wanted.
   */
  template <typename Store>
  void ForEachPixel(const PathLengthImage& image, bool wantVariance, const Store& store) const;

  int MaterialCount = 0;
  /// Normalised w_E D(E) per energy.
  std::vector<double> Weights;
  /// What each energy adds to the variance per incident photon.
  std::vector<double> VarianceWeights;
  /// mu of material m at energy e, 1/mm: Mu[e * MaterialCount + m].
  std::vector<double> Mu;
};
}

#endif
