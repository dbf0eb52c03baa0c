// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_InverseEquilibrium_h
#define mammoray_InverseEquilibrium_h

#include "Private/AttachmentEnergy.h"
#include "Private/ElasticBody.h"
#include "Private/EquilibriumEnergy.h"
#include "Private/EquilibriumSensitivities.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/**
 * Equilibrium under dead loads if the deformed shape is known and the undeformed one is unknown
 * (Govindjee & Mihalic 1996). The forces R(X, x) = d(energy)/dx are those of EquilibriumEnergy,
 * with the weight of the undeformed volume as load, but they are solved for X. The corners of the
 * cells are known in the deformed body and unknown in the undeformed one. The mid-side nodes of
 * quadratic cells lie midway between their corners in the undeformed body and are unknown in the
 * deformed one. So there are as many unknowns as forces:
 *
 *   y = (X of corners, x of middles),   dR/dy = (dR/dX, d2E/dx2), which is not symmetric.
 *
 * An evaluation moves the body and its wall to the undeformed shape of `y`.
 */
class MAMMORAYBIOMECHANICS_EXPORT InverseEquilibrium
{
public:
  /// `wall` is the attachment of this body, or null. `fixed` and `fixedCells` are as in
  /// EquilibriumEnergy. `corners` are the points of the linear mesh in the deformed body, 3 x
  /// pointCount, mm. Body and wall must outlive this object.
  InverseEquilibrium(ElasticBody& body, AttachmentEnergy* wall, const std::vector<bool>& fixed,
    const std::vector<bool>& fixedCells, std::vector<double> corners, const Vector3& gravityMPerS2);

  /// Sets the fraction of gravity that loads the body, [0, 1]; the default is 1.
  void SetLoadedPart(double part) { this->LoadedPart = part; }

  /// The unknowns `y` of the body without load, 3 x nodeCount.
  std::vector<double> Unloaded() const;
  /// Places mid-side nodes midway between their corners, in positions or velocities (3 x
  /// nodeCount).
  void PutMiddlesBetween(std::span<double> values) const;
  /// Deformed positions of all nodes in `y`.
  std::vector<double> Deformed(const std::vector<double>& y) const;

  /// Computes the residual at `y` and, with `derivatives`, its Jacobian. Returns false if a cell or
  /// a quadrature point is inverted; then only the undeformed shape has changed.
  bool Evaluate(const std::vector<double>& y, bool derivatives);
  /// -R at the unknowns, kPa mm^2, and |R| divided by the norm of the largest kind of force.
  const std::vector<double>& Forces() const { return this->Residual; }
  double RelativeResidual() const { return this->Current.RelativeResidual(); }
  /// Smallest and largest J of the quadrature points in the last evaluation.
  double SmallestJ() const { return this->Current.Measures.SmallestJ; }
  double LargestJ() const { return this->Current.Measures.LargestJ; }

  /// Coordinate of each unknown in `y`, ascending.
  const std::vector<std::int32_t>& Coordinates() const { return this->Energy.Coordinates(); }
  /// Pattern of the Jacobian by columns (as SparsePattern, but with both halves), and its values in
  /// the last Evaluate with derivatives.
  const SparsePattern& Pattern() const { return this->Entries; }
  const std::vector<double>& Jacobian() const { return this->Values; }

  /// -dR/dp at `y` for parameters of the materials, then of the wall, one column each. `y` must be
  /// that of the last Evaluate.
  std::vector<double> ParameterForces(const std::vector<double>& y,
    const std::vector<MaterialDerivative>& materials,
    const std::vector<WallStiffness>& walls) const;

private:
  bool IsCorner(std::int32_t coordinate) const
  {
    return static_cast<std::size_t>(coordinate) < this->Corners.size();
  }
  void MakePattern();
  bool MoveRest(const std::vector<double>& y);
  void AddHessian(const std::vector<double>& hessian);
  void AddElements(const std::vector<double>& x);
  void AddWall(const std::vector<double>& x);
  void AddWeight(std::size_t element, std::vector<double>& matrix) const;
  void AddEntry(std::int32_t rowCoordinate, std::int32_t columnCoordinate, double value);

  ElasticBody& Body;
  AttachmentEnergy* Wall;
  const std::vector<bool> FixedCells;
  const std::vector<double> Corners;
  const Vector3 Gravity;
  double LoadedPart = 1;
  EquilibriumEnergy Energy;
  Evaluation Current;
  SparsePattern Entries;
  /// The two ends of the side of each mid-side node, in the order of these nodes.
  std::vector<std::int32_t> Ends;
  std::vector<double> Values;
  std::vector<double> Residual;
};
}

#endif
