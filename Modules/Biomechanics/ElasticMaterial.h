// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticMaterial_h
#define mammoray_ElasticMaterial_h

#include "mammoray/Foundation/MaterialTable.h"

#include <cmath>
#include <vector>

namespace mammoray
{
/// Constants of an isotropic, nearly incompressible material at small strain, and the exponent of
/// its stiffening (see ShapeEnergy).
struct ElasticMaterial
{
  /// Young's modulus E at small strain, kPa; positive.
  double YoungsModulusKPa = 5.0;
  /// Poisson's ratio nu, [0, 0.5).
  double PoissonRatio = 0.49;
  /**
   * Exponent b of Fung's law, [0, LargestFungExponent]; 0 is neo-Hookean. For the breast, Wellman
   * (1999) measured E = 4.46 kPa exp(7.4 strain) for fat and 15.1 kPa exp(10 strain) for gland.
   * Exponents of 2.6 (fat) and 4.2 (gland) give the same stress in a bar compressed by 30 %; 4.2
   * and 6.6 do so at 20 %.
   */
  double FungExponent = 0.0;
  /// Mass density, g/cm^3, which gravity needs; 0: not known.
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

/// The mechanical part of a table of materials, one entry per material.
struct ElasticTable
{
  std::vector<ElasticMaterial> Elastic;
  /// True for materials that are fixed to the body and do not move.
  std::vector<bool> Fixed;

  ElasticTable() = default;
  explicit ElasticTable(const MaterialTable& table)
    : Fixed(table.Fixed())
  {
    for (const Material& material : table.Materials)
    {
      this->Elastic.push_back({ .YoungsModulusKPa = material.YoungsModulusKPa,
        .PoissonRatio = material.PoissonRatio,
        .FungExponent = material.FungExponent,
        .DensityGPerCm3 = material.DensityGPerCm3 });
    }
  }
};

/// Derivative of a material's constants with respect to a parameter, per unit of it.
struct ElasticMaterialDerivative
{
  double YoungsModulusKPa = 0.0;
  double PoissonRatio = 0.0;
  double FungExponent = 0.0;
};
/// One derivative for each material of a table.
using MaterialDerivative = std::vector<ElasticMaterialDerivative>;

/**
 * Energy density w of a change of shape, kPa, as a function of I = J^(-2/3) tr F^T F - 3:
 *
 *   w = mu / (2 b) (exp(b I) - 1)    (Fung's law for isotropic tissue, Demiray 1972)
 *
 * and its limit for b = 0, w = mu / 2 I (neo-Hookean). Elements know the function of I only
 * through this struct. Its constants are means over the materials at a quadrature point
 * (ElasticBody::SetMaterials): a law with a further constant changes that mean and its derivative
 * (ElasticEnergy::GradientDerivative), too.
 */
struct ShapeEnergy
{
  /// Shear modulus at small strain, kPa.
  double Mu = 1.0;
  /// Exponent b; not negative.
  double Exponent = 0.0;

  /// The law of inverted cells, whose invariant is so large that an exponential of it overflows.
  ShapeEnergy NeoHookean() const { return { this->Mu, 0.0 }; }

  double Value(double i) const
  {
    return this->Exponent > 0 ? this->Mu / (2 * this->Exponent) * std::expm1(this->Exponent * i)
                              : 0.5 * this->Mu * i;
  }
  /// First derivative dw/dI, kPa.
  double Slope(double i) const { return 0.5 * this->Mu * this->Growth(i); }
  /// Second derivative d2w/dI2, kPa.
  double Curvature(double i) const { return this->Exponent * this->Slope(i); }
  /// Derivative of Slope for these derivatives of mu and b.
  double SlopeDerivative(double i, double muRate, double exponentRate) const
  {
    return 0.5 * this->Growth(i) * (muRate + this->Mu * i * exponentRate);
  }

private:
  double Growth(double i) const { return this->Exponent > 0 ? std::exp(this->Exponent * i) : 1; }
};
}

#endif
