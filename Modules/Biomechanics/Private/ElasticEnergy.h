// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticEnergy_h
#define mammoray_ElasticEnergy_h

#include "Private/ElasticBody.h"
#include "Private/Energy.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/ElasticMaterial.h"
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
 *       + kappa_p / 2 (J_q - 1)^2) + (kappa - kappa_p) / 2 V (Jbar - 1)^2 ]
 *
 * w is ShapeEnergy, q are quadrature points with weights w_q in the undeformed element, J_q = det
 * F_q, Jbar is the mean of J_q, V the undeformed volume, kappa the mean of kappa_q, mu the mean of
 * mu_q, and kappa_p = min(kappa, r mu). The term in Jbar is one volume constraint per element. The
 * same stiffness at every point would be more constraints than the nodes can satisfy (locking).
 *
 * - Quadratic: P2/P0 (Boffi, Brezzi & Fortin 2013, section 8.6) with r = 50. With the mean alone,
 *   the points of a cell could expand and shrink against each other.
 * - PatchAveragedLinear: the patches of de Souza Neto, Andrade Pires & Owen (2005), written as an
 *   energy so that forces have a potential and the stiffness is symmetric; r = 0, because cells
 *   whose neighbours expand against them are sheared, which costs enough energy.
 *
 * Energies are in kPa mm^3 = 1e-6 J, forces in kPa mm^2 = 1e-3 N. The projected Hessian is
 * projected at each quadrature point.
 */
class MAMMORAYBIOMECHANICS_EXPORT ElasticEnergy : public Energy
{
public:
  /// Domain of the energy. Admissible: positions with J > 0 at every quadrature point. Extended:
  /// all positions; below J = 0.1 a parabola continues the power of J, and Fung's law is used
  /// without its exponential, so that inverted cells have a finite energy.
  enum class Domain
  {
    Admissible,
    Extended
  };

  /// The body must outlive the energy, which follows the body's changes.
  explicit ElasticEnergy(const ElasticBody& body)
    : Body(body)
  {
  }
  void SetDomain(Domain domain) { this->CurrentDomain = domain; }
  Domain GetDomain() const { return this->CurrentDomain; }

  std::size_t NumberOfPieces() const override { return this->Body.NumberOfElements(); }
  std::span<const std::int32_t> NodesOf(std::size_t element) const override
  {
    return this->Body.NodesOf(element);
  }
  /// Measures J and the deformed volume.
  bool Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// Derivative of an element's gradient with respect to a parameter of the materials, at positions
  /// without inverted quadrature points.
  std::vector<double> GradientDerivative(std::size_t element, const std::vector<double>& x,
    const MaterialDerivative& velocity) const;
  /// The same with respect to a relative change of the stiffness of one cell of the element.
  std::vector<double> StiffnessDerivative(std::size_t cell, std::size_t element,
    const std::vector<double>& x) const;
  /**
   * Adds the derivative of an element's gradient with respect to the undeformed corners of its
   * cells, at fixed `x`. Mid-side nodes follow the corners. `matrix` holds (3 n)^2 numbers by
   * columns for the n nodes, with index 3 * local node + axis; columns of mid-side nodes are left
   * alone. Returns false if a quadrature point is inverted.
   */
  bool AddRestDerivative(std::size_t element, const std::vector<double>& x,
    std::span<double> matrix) const;
  /// Measures of one cell at node positions `x` without inverted quadrature points.
  CellMeasures MeasuresOf(std::size_t cell, const std::vector<double>& x) const;

private:
  const ElasticBody& Body;
  Domain CurrentDomain = Domain::Admissible;
};
}

#endif
