// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticEnergy_h
#define mammoray_ElasticEnergy_h

#include "Private/ElasticBody.h"
#include "Private/Energy.h"
#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Biomechanics/SimulationCells.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/**
 * Elastic energy of a body; its pieces are the body's elements:
 *
 *   E = sum over elements of [ sum_q w_q (w(J_q^(-2/3) tr F_q^T F_q - 3; mu_q, b_q)
 *       + kappa_p / 2 (J_q - 1)^2) + (kappa - kappa_p) / 2 V (Jbar - 1)^2 ],
 *
 * w: ShapeEnergy, q: quadrature points, w_q their weights in the undeformed element, J_q = det F_q,
 * Jbar the mean of J_q, V the undeformed volume, kappa the mean of kappa_q, kappa_p = min(kappa, r
 * mu), mu the mean of mu_q. What acts on Jbar is one constraint for the element; acting at every
 * point it would be more constraints than the nodes can meet (locking).
 *
 * - Quadratic: P2/P0 (Boffi, Brezzi & Fortin 2013, section 8.6); r = 50: the mean alone would let
 *   the points of a cell swell and shrink against each other.
 * - PatchAveragedLinear: the patches of de Souza Neto, Andrade Pires & Owen (2005), put as an
 *   energy, so that forces have a potential and the stiffness is symmetric; r = 0: cells whose
 *   neighbours swell against them are sheared, which costs enough.
 *
 * Energies are in kPa mm^3 = 1e-6 J, forces in kPa mm^2 = 1e-3 N. The projected Hessian is
 * projected quadrature point by quadrature point.
 */
class MAMMORAYBIOMECHANICS_EXPORT ElasticEnergy : public Energy
{
public:
  /// Where the energy is defined: where J > 0 everywhere, or, with the power of J continued by a
  /// parabola below J = 0.1 and Fung's law without its exponential, at all positions, inverted
  /// cells at a finite price.
  enum class Domain
  {
    Admissible,
    Extended
  };

  /// The body must outlive the energy, which sees its changes.
  explicit ElasticEnergy(const ElasticBody& body)
    : Body(body)
  {
  }
  void SetDomain(Domain domain) { this->Where = domain; }
  Domain GetDomain() const { return this->Where; }

  std::size_t NumberOfPieces() const override { return this->Body.NumberOfElements(); }
  std::span<const std::int32_t> NodesOf(std::size_t element) const override
  {
    return this->Body.NodesOf(element);
  }
  /// Measures J and the volume.
  bool Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// Rate of change of an element's gradient with the materials, at positions where no quadrature
  /// point is inverted; `velocity`: one rate per material.
  std::vector<double> GradientRate(std::size_t element, const std::vector<double>& x,
    const MaterialVelocity& velocity) const;
  /**
   * Adds the derivative of an element's gradient by the undeformed positions of its cells' corners
   * (the middles of sides follow them), at fixed `x`, to (3 n)^2 numbers for its n nodes: by
   * columns, 3 * local node + axis, those of middles left alone. Answers false where a quadrature
   * point is inverted.
   */
  bool AddRestDerivative(std::size_t element, const std::vector<double>& x,
    std::span<double> matrix) const;
  /// Measures of one cell at node positions `x` where no quadrature point is inverted.
  CellMeasures MeasuresOf(std::size_t cell, const std::vector<double>& x) const;

private:
  const ElasticBody& Body;
  Domain Where = Domain::Admissible;
};
}

#endif
