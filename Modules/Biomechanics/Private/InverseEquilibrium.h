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
#include <vector>

namespace mammoray
{
/**
 * Equilibrium under dead loads where the deformed shape is known and the undeformed one is not
 * (Govindjee & Mihalic 1996): the same forces R(X, x) = d(energy)/dx as in EquilibriumEnergy, with
 * the loads as weights of the undeformed volume, but as a function of X. The corners of the cells
 * are known in the deformed body and sought at rest; the middles of quadratic sides, which at rest
 * lie between their ends, are sought in the deformed body. So there are as many unknowns as forces:
 *
 *   y = (X of corners, x of middles),   dR/dy = (dR/dX, d2E/dx2), not symmetric.
 *
 * Evaluating moves the body and its wall to the undeformed shape of `y`.
 */
class MAMMORAYBIOMECHANICS_EXPORT InverseEquilibrium
{
public:
  /**
   * `wall`: null or the attachment of this body; `fixed`, `heldCells`: as of EquilibriumEnergy;
   * `corners`: of the deformed body, 3 x the number of points of the linear mesh. Body and wall
   * must outlive this.
   */
  InverseEquilibrium(ElasticBody& body, AttachmentEnergy* wall, const std::vector<bool>& fixed,
    const std::vector<bool>& heldCells, std::vector<double> corners, const Vector3& gravityMPerS2);

  /// The part of the gravity that loads the body, from 0 to 1; 1 until set.
  void SetLoadedPart(double part) { this->LoadedPart = part; }

  /// Every coordinate of `y` where the body has no load: 3 x nodeCount.
  std::vector<double> Unloaded() const;
  /// Puts middles between the ends of their sides, as at rest: positions or velocities, 3 x
  /// nodeCount.
  void PutMiddlesBetween(std::vector<double>& values) const;
  /// Deformed positions of all nodes and undeformed ones of the corners in `y`.
  std::vector<double> Deformed(const std::vector<double>& y) const;
  std::vector<double> RestCorners(const std::vector<double>& y) const;

  /// Residual at `y`, and with `derivatives` its Jacobian. Answers false, with nothing else
  /// changed but the shape at rest, where a cell or a quadrature point is inverted.
  bool Evaluate(const std::vector<double>& y, bool derivatives);
  /// - R by the unknowns, kPa mm^2, and |R| over the largest kind of force.
  const std::vector<double>& Forces() const { return this->Residual; }
  double RelativeResidual() const { return this->Current.RelativeResidual(); }
  /// Of the quadrature points of the last evaluation.
  double SmallestJ() const { return this->Current.Measures.SmallestJ; }
  double LargestJ() const { return this->Current.Measures.LargestJ; }

  /// The coordinate of each unknown in `y`, ascending.
  const std::vector<std::int32_t>& Coordinates() const { return this->Energy.Coordinates(); }
  /// The Jacobian by columns (SparsePattern, but both halves) and its values of the last Evaluate
  /// with derivatives.
  const SparsePattern& Pattern() const { return this->Entries; }
  const std::vector<double>& Jacobian() const { return this->Values; }

  /// - dR/dp at `y` for parameters of the materials and of the wall, one column for each; where
  /// Evaluate was last called.
  std::vector<double> ParameterForces(const std::vector<double>& y,
    const std::vector<MaterialVelocity>& materials, const std::vector<WallStiffness>& walls) const;

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
  const std::vector<bool> HeldCells;
  const std::vector<double> Corners;
  const Vector3 Gravity;
  double LoadedPart = 1;
  EquilibriumEnergy Energy;
  Evaluation Current;
  SparsePattern Entries;
  /// The ends of the side of each middle, 2 for each node from the first middle on.
  std::vector<std::int32_t> Ends;
  std::vector<double> Values;
  std::vector<double> Residual;
};
}

#endif
