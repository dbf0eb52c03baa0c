// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LaggedFriction_h
#define mammoray_LaggedFriction_h

#include "Private/EquilibriumSolver.h"
#include "Private/FrictionEnergy.h"
#include "Private/LoadPath.h"
#include "mammorayBiomechanicsModule.h"

#include <vector>

namespace mammoray
{
/// Solves load steps with Coulomb friction: the solver runs with frozen normal forces, which are
/// updated until they agree with the solution (fixed-point iteration). Without friction it solves
/// once.
class MAMMORAYBIOMECHANICS_EXPORT LaggedFriction : public LoadStepSolver
{
public:
  /// `coefficient` is not negative. Friction starts from the state `x` between `plates` with the
  /// contact `points` of that state (null for none). The solver and its body must outlive this
  /// object.
  LaggedFriction(EquilibriumSolver& solver, const ElasticBody& body, double coefficient,
    const std::vector<double>& x, const PlatePair& plates, const FrictionPoints* points = nullptr);

  /// Returns a guess to first order, or `x` if that guess inverts a cell.
  std::vector<double> Begin(const std::vector<double>& x, const PlatePair& plates,
    const LoadStep& step) override;
  EquilibriumReport Solve(std::vector<double>& x, const std::vector<double>& last,
    const PlatePair& lastPlates, const LoadStep& step, const ProgressCallback& progress) override;
  void Arrived(const std::vector<double>& x, const PlatePair& plates) override;
  int Untangle(std::vector<double>& x, const LoadStep& step,
    const ProgressCallback& progress) override;

private:
  EquilibriumSolver& Solver;
  const ElasticBody& Body;
  const double Coefficient;
  /// The state at which the load step began; it defines the anchors.
  FrictionStart Previous;
};
}

#endif
