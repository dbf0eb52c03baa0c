// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticMaterial_h
#define mammoray_ElasticMaterial_h

#include <cmath>
#include <vector>

namespace mammoray
{
/**
 * Isotropic, nearly incompressible material: its constants at small strain, and how it stiffens
 * (ShapeEnergy).
 */
struct ElasticMaterial
{
  /// kPa, positive.
  double YoungsModulusKPa = 5.0;
  /// [0, 0.5)
  double PoissonRatio = 0.49;
  /**
   * 0: neo-Hookean. Above, up to LargestFungExponent: stiffens as Fung's exponential. Breast by
   * Wellman (1999; E = 4.46 kPa exp(7.4 strain) for fat, 15.1 kPa exp(10 strain) for gland): at 30
   * % compression of a bar 2.6 for fat and 4.2 for gland give the same stress, at 20 % 4.2 and 6.6.
   */
  double FungExponent = 0.0;
  /// g/cm^3, positive; what gravity acts on.
  double DensityGPerCm3 = 1.0;

  static constexpr double LargestFungExponent = 50.0;

  /// Shear modulus mu = E / (2 (1 + nu)), kPa.
  double ShearModulusKPa() const { return this->YoungsModulusKPa / (2 * (1 + this->PoissonRatio)); }
  /// Bulk modulus kappa = E / (3 (1 - 2 nu)), kPa.
  double BulkModulusKPa() const
  {
    return this->YoungsModulusKPa / (3 * (1 - 2 * this->PoissonRatio));
  }

  bool operator==(const ElasticMaterial&) const = default;
};

/// Rate of change of a material with a parameter, per unit of it.
struct ElasticMaterialRate
{
  double YoungsModulusKPa = 0.0;
  double PoissonRatio = 0.0;
  double FungExponent = 0.0;
};
/// One rate for each material of a table.
using MaterialVelocity = std::vector<ElasticMaterialRate>;

/**
 * The part w of the energy density that a change of shape costs, kPa, as a function of
 * I = J^(-2/3) tr F^T F - 3:
 *
 *   w = mu / (2 b) (exp(b I) - 1)    (Fung's law for isotropic tissue, Demiray 1972)
 *
 * and its limit for b = 0, w = mu / 2 I (neo-Hookean). Everything that the elements need of a law
 * is here; another function of I would replace this struct alone.
 */
struct ShapeEnergy
{
  /// Shear modulus at small strain, kPa.
  double Mu = 1.0;
  /// b, not negative.
  double Exponent = 0.0;

  double Value(double i) const
  {
    return this->Exponent > 0 ? this->Mu / (2 * this->Exponent) * std::expm1(this->Exponent * i)
                              : 0.5 * this->Mu * i;
  }
  /// dw/dI, from its value at no strain on.
  double Slope(double i) const { return 0.5 * this->Mu * this->Growth(i); }
  /// d2w/dI2
  double Curvature(double i) const { return this->Exponent * this->Slope(i); }
  /// Rate of Slope with those of the constants.
  double SlopeRate(double i, double muRate, double exponentRate) const
  {
    return 0.5 * this->Growth(i) * (muRate + this->Mu * i * exponentRate);
  }

private:
  double Growth(double i) const { return this->Exponent > 0 ? std::exp(this->Exponent * i) : 1; }
};
}

#endif
