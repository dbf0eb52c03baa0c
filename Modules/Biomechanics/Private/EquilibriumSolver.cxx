// SPDX-License-Identifier: Apache-2.0
#include "Private/EquilibriumSolver.h"

#include "mammoray/Foundation/Error.h"

namespace mammoray
{
namespace
{
/// A factor of positions within this distance, mm, yields a step to first order.
constexpr double NearForAStepMm = 2.0;

/// Continues the energy beyond J = 0 during its lifetime.
class ExtendedDomain
{
public:
  explicit ExtendedDomain(EquilibriumEnergy& energy)
    : Energy(energy)
  {
    energy.SetDomain(ElasticEnergy::Domain::Extended);
  }
  ~ExtendedDomain() { this->Energy.SetDomain(ElasticEnergy::Domain::Admissible); }
  ExtendedDomain(const ExtendedDomain&) = delete;
  ExtendedDomain& operator=(const ExtendedDomain&) = delete;

private:
  EquilibriumEnergy& Energy;
};
}

EquilibriumSolver::EquilibriumSolver(const ElasticBody& body, const std::vector<bool>& fixed,
  double contactStiffness, const std::vector<bool>& leftOut)
  : Objective(body, fixed, contactStiffness, leftOut)
  , Newton(Objective)
{
}

void EquilibriumSolver::BodyChanged()
{
  this->Objective.BodyChanged();
  this->Newton.Factor().Forget();
}

void EquilibriumSolver::SetAttachment(const AttachmentEnergy* attachment)
{
  this->Objective.SetAttachment(attachment);
  this->Newton.Factor().Forget();
}

FrictionPoints EquilibriumSolver::FrictionAt(const std::vector<double>& x, const PlatePair& plates,
  double coefficient, const FrictionStart& before) const
{
  return FrictionOfContact(this->Objective.Part(), this->Objective.Contact(), x, plates,
    coefficient, before);
}

EquilibriumReport EquilibriumSolver::Report(const Evaluation& evaluation) const
{
  const PositionMeasures& measures = evaluation.Measures;
  EquilibriumReport report;
  report.Energy = evaluation.Energy;
  report.RelativeResidual = evaluation.RelativeResidual();
  report.SupportForceN = 1e-3 * measures.NormalForce[0];
  report.PaddleForceN = 1e-3 * measures.NormalForce[1];
  for (int side = 0; side < 2; ++side)
  {
    report.FrictionN[side] = 1e-3 * measures.Friction[side];
  }
  report.LargestPenetrationMm = measures.Penetration;
  report.LargestWallLiftMm = measures.WallLift;
  report.LargestWallGlideMm = measures.WallGlide;
  report.SmallestJ = measures.SmallestJ;
  report.LargestJ = measures.LargestJ;
  report.VolumeRatio = measures.Volume / this->Objective.RestVolume();
  return report;
}

EquilibriumReport EquilibriumSolver::Solve(std::vector<double>& x, const PlatePair* plates,
  double tolerance, int maximumSteps, const ProgressCallback& progress)
{
  this->Objective.SetPlates(plates);
  const NewtonResult result = this->Newton.Minimize(x, tolerance, maximumSteps, progress);
  const Evaluation& last = this->Newton.EvaluateAt(x);
  EquilibriumReport report = last.Valid ? this->Report(last) : EquilibriumReport();
  report.Converged = result.Converged;
  report.NewtonSteps = result.Steps;
  report.Reason = result.Reason;
  return report;
}

bool EquilibriumSolver::IsStable(const std::vector<double>& x)
{
  this->Objective.SetPlates(nullptr);
  const Evaluation& evaluation = this->Newton.EvaluateAt(x);
  return evaluation.Valid && this->Newton.Factor().Factorize(evaluation.Hessian, x);
}

bool EquilibriumSolver::Admissible(const std::vector<double>& x)
{
  Evaluation probe;
  this->Objective.Evaluate(x, EnergyOrder::Value, probe);
  return probe.Valid;
}

EquilibriumReport EquilibriumSolver::Untangle(std::vector<double>& x, const PlatePair* plates,
  double tolerance, int maximumSteps, const ProgressCallback& progress)
{
  const ExtendedDomain extended(this->Objective);
  return this->Solve(x, plates, tolerance, maximumSteps, progress);
}

EquilibriumReport EquilibriumSolver::Evaluate(const std::vector<double>& x, const PlatePair* plates)
{
  this->Objective.SetPlates(plates);
  Evaluation evaluation;
  this->Objective.Evaluate(x, EnergyOrder::Gradient, evaluation);
  if (!evaluation.Valid)
  {
    throw ConvergenceError("equilibrium: expected no inverted cell, found one");
  }
  return this->Report(evaluation);
}

std::vector<double> EquilibriumSolver::TangentStep(const std::vector<double>& x,
  const PlatePair& plates, const PlatePairVelocity& motion)
{
  this->Objective.SetPlates(&plates);
  std::vector<double> result(x.size(), 0.0);
  FactorCache& factor = this->Newton.Factor();
  if (factor.DistanceMm(x) > NearForAStepMm && !this->Newton.FactorizeAt(x))
  {
    return result;
  }
  std::vector<double> solution = PlateForces(this->Objective, x, { motion });
  factor.Solve(solution);
  for (std::size_t u = 0; u < solution.size(); ++u)
  {
    result[this->Objective.Coordinates()[u]] = solution[u];
  }
  return result;
}
}
