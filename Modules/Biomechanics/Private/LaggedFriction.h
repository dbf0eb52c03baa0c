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
/**
 * The equilibria of a solver with Coulomb friction, whose normal forces are frozen while it solves:
 * it solves again until they fit. Without friction it solves once.
 */
class MAMMORAYBIOMECHANICS_EXPORT LaggedFriction : public LoadStepSolver
{
public:
  /// `coefficient`: not negative. Friction comes from the state `x` between `plates`, where
  /// `points` (null: none) touched. The solver, and the body it was made of, must outlive this.
  LaggedFriction(EquilibriumSolver& solver, const ElasticBody& body, double coefficient,
    const std::vector<double>& x, const PlatePair& plates, const FrictionPoints* points = nullptr);

  /// The guess is to first order; `x` where that would turn a cell inside out.
  std::vector<double> Begin(const std::vector<double>& x, const PlatePair& plates,
    const LoadStep& step) override;
  EquilibriumReport Solve(std::vector<double>& x, const std::vector<double>& last,
    const PlatePair& lastPlates, const LoadStep& step, const ProgressCallback& progress) override;
  void Arrived(const std::vector<double>& x, const PlatePair& plates) override;
  int Untangle(std::vector<double>& x, const LoadStep& step,
    const ProgressCallback& progress) override;

private:
  EquilibriumReport SolveFrozen(std::vector<double>& x, const LoadStep& step,
    const ProgressCallback& progress);

  EquilibriumSolver& Solver;
  const ElasticBody& Body;
  const double Coefficient;
  /// Anchors are those of the state at which the load step began.
  FrictionStart Before;
};
}

#endif
