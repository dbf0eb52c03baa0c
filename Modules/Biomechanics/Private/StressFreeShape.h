// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_StressFreeShape_h
#define mammoray_StressFreeShape_h

#include "Private/EquilibriumSolver.h"
#include "Private/InverseEquilibrium.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayBiomechanicsModule.h"

#include <memory>
#include <vector>

namespace mammoray
{
/**
 * Finds the stress-free shape of a body whose shape under gravity is known: the root of an
 * InverseEquilibrium by Newton's method, damped by the natural monotonicity test (Deuflhard 2011,
 * section 3.3). A factor is kept as long as its steps converge fast. A shape is accepted only if
 * the known shape is a stable equilibrium of it with J > 0. Body and wall are left in the shape
 * found.
 */
class MAMMORAYBIOMECHANICS_EXPORT StressFreeShape
{
public:
  /// `solver`, of the same body, decides whether an equilibrium is stable. `tolerance` is the
  /// relative residual. `inverse` and `solver` must outlive this object.
  StressFreeShape(InverseEquilibrium& inverse, EquilibriumSolver& solver, double tolerance);
  ~StressFreeShape();

  /// Increases gravity in steps from the body without load, smaller ones where a step fails.
  /// Returns the fraction of gravity that the tissue can carry: 1, or the largest fraction to 2.5 %
  /// of itself, or 0 if it is below 1e-3.
  double Find(const ProgressCallback& progress = {});
  /// Moves from the last shape to the one under this fraction of gravity. Returns false, and keeps
  /// the last shape, if there is none nearby.
  bool MoveTo(double part, const ProgressCallback& progress = {});
  /// Declares the last shape to be that under the whole gravity, after all stiffness was changed
  /// accordingly.
  void TakeForWhole();

  /// The unknowns found (see InverseEquilibrium). Set moves the body to another shape of itself.
  const std::vector<double>& Shape() const { return this->Y; }
  void Set(const std::vector<double>& y);
  /// The known deformed shape with mid-side nodes, 3 x nodeCount, mm.
  std::vector<double> Deformed() const { return this->Inverse.Deformed(this->Y); }

  /// Velocities of the undeformed positions for parameters of the materials, then of the wall's
  /// stiffness, by the implicit function theorem at the shape found for the whole gravity. Throws
  /// ConvergenceError if they are not defined.
  VectorFields Velocities(const std::vector<MaterialDerivative>& materials,
    const std::vector<WallStiffness>& walls);

private:
  bool Newton(std::vector<double>& y, const ProgressCallback& progress);
  bool TakeStep(std::vector<double>& y);
  std::vector<double> SolveExactly(const std::vector<double>& right);

  InverseEquilibrium& Inverse;
  EquilibriumSolver& Solver;
  struct JacobianFactor;
  std::unique_ptr<JacobianFactor> Factor;
  double Tolerance;
  std::vector<double> Y;
};
}

#endif
