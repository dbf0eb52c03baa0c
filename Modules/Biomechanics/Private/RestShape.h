// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RestShape_h
#define mammoray_RestShape_h

#include "Private/EquilibriumSolver.h"
#include "Private/InverseEquilibrium.h"
#include "Private/SparseLu.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayBiomechanicsModule.h"

#include <vector>

namespace mammoray
{
/**
 * The shape without load of a body whose shape under gravity is known: the root of an
 * InverseEquilibrium by Newton's method, damped by the natural monotonicity test (Deuflhard 2011,
 * section 3.3), a factor kept as long as its steps shrink fast. Only shapes count from which the
 * known one is a stable equilibrium with J > 0. The body and its wall are left in the shape found.
 */
class MAMMORAYBIOMECHANICS_EXPORT RestShape
{
public:
  /// `inverse` is referred to, as is `solver`, of the same body, which tells whether an equilibrium
  /// is stable; both must outlive this. `tolerance`: relative residual.
  RestShape(InverseEquilibrium& inverse, EquilibriumSolver& solver, double tolerance);

  /**
   * Brings gravity on in steps from the body without load, smaller ones where they fail. Answers
   * the part of it that is borne: 1, or the largest to a fiftieth of itself; 0 where that is below
   * a thousandth.
   */
  double Find(const ProgressCallback& progress = {});
  /// From the last shape to that under this part of the gravity; answers false and keeps the last
  /// shape where there is none near.
  bool MoveTo(double part, const ProgressCallback& progress = {});
  /// All stiffness was changed to fit: the last shape is now that under the whole gravity.
  void TakeForWhole();

  /// What was found: see InverseEquilibrium. Set puts the body into another shape of the same body.
  const std::vector<double>& Shape() const { return this->Y; }
  void Set(const std::vector<double>& y);
  /// The known shape, with middles: 3 x nodeCount.
  std::vector<double> Deformed() const { return this->Inverse.Deformed(this->Y); }

  /**
   * Rates of the undeformed positions, 3 x nodeCount, with parameters that change the materials,
   * then with those of the wall's stiffness, at the shape found for the whole gravity: by the
   * implicit function theorem. Throws ConvergenceError where they are not defined.
   */
  std::vector<std::vector<double>> Rates(const std::vector<MaterialVelocity>& materials,
    const std::vector<WallStiffness>& walls);

private:
  bool Newton(std::vector<double>& y, const ProgressCallback& progress);
  bool TakeStep(std::vector<double>& y);
  bool FactorizeAt(const std::vector<double>& y);
  std::vector<double> SolveExactly(const std::vector<double>& right);

  InverseEquilibrium& Inverse;
  EquilibriumSolver& Solver;
  SparseLu Factor;
  double Tolerance;
  std::vector<double> Y;
};
}

#endif
