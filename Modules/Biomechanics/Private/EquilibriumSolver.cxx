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
  : Energy(body, fixed, contactStiffness, leftOut)
  , Newton(Energy)
{
}

void EquilibriumSolver::BodyChanged()
{
  this->Energy.BodyChanged();
  this->Newton.Factor().Forget();
}

void EquilibriumSolver::SetAttachment(const AttachmentEnergy* attachment)
{
  this->Energy.SetAttachment(attachment);
  this->Newton.Factor().Forget();
}

FrictionPoints EquilibriumSolver::FrictionAt(const std::vector<double>& x, const PlatePair& plates,
  double coefficient, const FrictionStart& before) const
{
  return FrictionOfContact(this->Energy.Part(), this->Energy.Contact(), x, plates, coefficient,
    before);
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
  report.VolumeRatio = measures.Volume / this->Energy.RestVolume();
  return report;
}

EquilibriumReport EquilibriumSolver::Minimize(std::vector<double>& x, double tolerance,
  int maximumSteps, const ProgressCallback& progress)
{
  const NewtonResult result = this->Newton.Minimize(x, tolerance, maximumSteps, progress);
  const Evaluation& last = this->Newton.EvaluateAt(x);
  EquilibriumReport report = last.Valid ? this->Report(last) : EquilibriumReport();
  report.Converged = result.Converged;
  report.NewtonSteps = result.Steps;
  report.Reason = result.Reason;
  return report;
}

EquilibriumReport EquilibriumSolver::Solve(std::vector<double>& x, const PlatePair* plates,
  double tolerance, int maximumSteps, const ProgressCallback& progress)
{
  this->Energy.SetPlates(plates);
  return this->Minimize(x, tolerance, maximumSteps, progress);
}

bool EquilibriumSolver::IsStable(const std::vector<double>& x)
{
  this->Energy.SetPlates(nullptr);
  const Evaluation& evaluation = this->Newton.EvaluateAt(x);
  return evaluation.Valid && this->Newton.Factor().Factorize(evaluation.Hessian, x);
}

bool EquilibriumSolver::Admissible(const std::vector<double>& x)
{
  Evaluation probe;
  this->Energy.Evaluate(x, EnergyOrder::Value, probe);
  return probe.Valid;
}

EquilibriumReport EquilibriumSolver::Untangle(std::vector<double>& x, const PlatePair* plates,
  double tolerance, int maximumSteps, const ProgressCallback& progress)
{
  const ExtendedDomain extended(this->Energy);
  return this->Solve(x, plates, tolerance, maximumSteps, progress);
}

Evaluation EquilibriumSolver::EvaluateAt(const std::vector<double>& x, const PlatePair* plates,
  EnergyOrder order)
{
  this->Energy.SetPlates(plates);
  Evaluation evaluation;
  this->Energy.Evaluate(x, order, evaluation);
  if (!evaluation.Valid)
  {
    throw ConvergenceError("equilibrium: expected no inverted cell, found one");
  }
  return evaluation;
}

EquilibriumReport EquilibriumSolver::Evaluate(const std::vector<double>& x, const PlatePair* plates)
{
  return this->Report(this->EvaluateAt(x, plates, EnergyOrder::Gradient));
}

std::vector<double> EquilibriumSolver::Gradient(const std::vector<double>& x,
  const PlatePair* plates)
{
  return this->EvaluateAt(x, plates, EnergyOrder::Gradient).Gradient;
}

std::vector<double> EquilibriumSolver::HessianProduct(const std::vector<double>& x,
  const PlatePair* plates, const std::vector<double>& direction)
{
  const Evaluation evaluation = this->EvaluateAt(x, plates, EnergyOrder::Hessian);
  const std::vector<std::int32_t>& coordinates = this->Energy.Coordinates();
  std::vector<double> in(coordinates.size());
  std::vector<double> out(coordinates.size());
  for (std::size_t u = 0; u < in.size(); ++u)
  {
    in[u] = direction[coordinates[u]];
  }
  this->Newton.Factor().Multiply(evaluation.Hessian, in.data(), out.data());
  std::vector<double> result(x.size(), 0.0);
  for (std::size_t u = 0; u < out.size(); ++u)
  {
    result[coordinates[u]] = out[u];
  }
  return result;
}

std::vector<double> EquilibriumSolver::ContactPressures(const std::vector<double>& x,
  const PlatePair& plates)
{
  this->Energy.SetPlates(&plates);
  return this->Energy.Contact().NodePressures(x);
}

VectorFields EquilibriumSolver::Sensitivities(const std::vector<double>& x, const PlatePair& plates,
  const EquilibriumDerivatives& velocities)
{
  this->Energy.SetPlates(&plates);
  return EquilibriumSensitivities(this->Energy, this->Newton, x, velocities);
}

double EquilibriumSolver::PaddleForceDerivative(const std::vector<double>& x,
  const PlatePair& plates, const PlatePairVelocity& velocity,
  const std::vector<double>& nodeVelocities)
{
  this->Energy.SetPlates(&plates);
  return PaddleForceDerivativeOf(this->Energy, x, velocity, nodeVelocities);
}

std::vector<double> EquilibriumSolver::TangentStep(const std::vector<double>& x,
  const PlatePair& plates, const PlatePairVelocity& motion)
{
  this->Energy.SetPlates(&plates);
  std::vector<double> result(x.size(), 0.0);
  FactorCache& factor = this->Newton.Factor();
  if (factor.DistanceMm(x) > NearForAStepMm && !this->Newton.FactorizeAt(x))
  {
    return result;
  }
  std::vector<double> solution = PlateForces(this->Energy, x, { motion });
  factor.Solve(solution);
  for (std::size_t u = 0; u < solution.size(); ++u)
  {
    result[this->Energy.Coordinates()[u]] = solution[u];
  }
  return result;
}
}
