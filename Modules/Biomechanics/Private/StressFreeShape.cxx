// SPDX-License-Identifier: Apache-2.0
#include "Private/StressFreeShape.h"

#include "Private/SingleThreaded.h"
#include "mammoray/Foundation/Error.h"

#include <Eigen/Core>
#include <Eigen/UmfPackSupport>

#include <algorithm>
#include <cmath>
#include <new>

namespace mammoray
{
namespace
{
/// Relative precision of the fraction of gravity that the tissue carries, and the smallest fraction
/// that is searched.
constexpr double PartPrecision = 0.025;
constexpr double SmallestPart = 1e-3;
/// Smallest J and smallest 1/J of the known shape: undeformed cells must neither vanish nor
/// explode.
constexpr double SmallestJ = 0.1;
/// If a shape exists, a few factors with some steps each lead to it.
constexpr int MostFactors = 8;
constexpr int MostNewtonSteps = 40;
constexpr double ShortestStep = 1.0 / 8;
/// A factor is kept if the next correction is smaller by this factor.
constexpr double FastContraction = 0.1;
/// Relative residual of linear solutions, and the largest number of refinements.
constexpr double LinearTolerance = 1e-11;
constexpr int MostLinearRefinements = 12;

double NormOf(const std::vector<double>& v)
{
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())).norm();
}
}

/// The L U factorisation of the inverse problem's Jacobian by UMFPACK's multifrontal method (Davis
/// 2004). The pattern is ordered and analysed once.
struct StressFreeShape::JacobianFactor
{
  using Matrix = Eigen::SparseMatrix<double>;

  const InverseEquilibrium& Inverse;
  Eigen::UmfPackLU<Matrix> Lu;
  bool Usable = false;

  explicit JacobianFactor(const InverseEquilibrium& inverse)
    : Inverse(inverse)
  {
    this->Lu.umfpackControl()[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    this->Lu.umfpackControl()[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
    // SolveExactly refines by itself, with the Jacobian it needs.
    this->Lu.umfpackControl()[UMFPACK_IRSTEP] = 0;
    const std::vector<double> zeros(inverse.Pattern().Rows.size(), 0.0);
    this->Lu.analyzePattern(this->View(zeros));
    if (this->Lu.info() != Eigen::Success)
    {
      throw ConvergenceError("unloading: UMFPACK could not order the Jacobian");
    }
  }
  Eigen::Map<const Matrix> View(const std::vector<double>& values) const
  {
    const SparsePattern& pattern = this->Inverse.Pattern();
    const auto size = static_cast<Eigen::Index>(pattern.Starts.size()) - 1;
    return { size, size, static_cast<Eigen::Index>(values.size()), pattern.Starts.data(),
      pattern.Rows.data(), values.data() };
  }
  /// Returns false if the Jacobian of the last evaluation is singular.
  bool Factorize()
  {
    const SingleThreaded single;
    this->Lu.factorize(this->View(this->Inverse.Jacobian()));
    if (this->Lu.umfpackFactorizeReturncode() == UMFPACK_ERROR_out_of_memory)
    {
      throw std::bad_alloc();
    }
    this->Usable = this->Lu.info() == Eigen::Success;
    return this->Usable;
  }
  /// Solves in place for the right-hand sides stored one after the other in `columns`.
  void Solve(std::vector<double>& columns) const
  {
    const std::size_t size = this->Inverse.Coordinates().size();
    for (std::size_t begin = 0; begin < columns.size(); begin += size)
    {
      Eigen::Map<Eigen::VectorXd> column(&columns[begin], static_cast<Eigen::Index>(size));
      const Eigen::VectorXd solution = this->Lu.solve(column);
      column = solution;
    }
  }
  /// y = A x for the Jacobian of the last evaluation.
  void Multiply(const double* x, double* y) const
  {
    const auto size = static_cast<Eigen::Index>(this->Inverse.Coordinates().size());
    Eigen::Map<Eigen::VectorXd>(y, size).noalias() =
      this->View(this->Inverse.Jacobian()) * Eigen::Map<const Eigen::VectorXd>(x, size);
  }
};

StressFreeShape::StressFreeShape(InverseEquilibrium& inverse, EquilibriumSolver& solver,
  double tolerance)
  : Inverse(inverse)
  , Solver(solver)
  , Factor(std::make_unique<JacobianFactor>(inverse))
  , Tolerance(tolerance)
  , Y(Inverse.Unloaded())
{
}

StressFreeShape::~StressFreeShape() = default;

double StressFreeShape::Find(const ProgressCallback& progress)
{
  this->Factor->Usable = false;
  this->Set(this->Inverse.Unloaded());
  double done = 0;
  for (double step = 1; done < 1;)
  {
    ReportProgress(progress, done, "unloading");
    const double next = std::min(1.0, done + step);
    if (this->MoveTo(next, progress))
    {
      done = next;
      continue;
    }
    step *= 0.5;
    if (step < std::max(SmallestPart, PartPrecision * done))
    {
      break;
    }
  }
  return done;
}

bool StressFreeShape::MoveTo(double part, const ProgressCallback& progress)
{
  this->Inverse.SetLoadedPart(part);
  std::vector<double> y = this->Y;
  try
  {
    if (this->Newton(y, progress))
    {
      this->Y.swap(y);
      return true;
    }
  }
  catch (const Interrupted&)
  {
    this->Set(this->Y);
    throw;
  }
  this->Factor->Usable = false;
  this->Set(this->Y);
  return false;
}

void StressFreeShape::TakeForWhole()
{
  this->Factor->Usable = false;
  this->Set(this->Y);
}

void StressFreeShape::Set(const std::vector<double>& y)
{
  this->Y = y;
  this->Inverse.SetLoadedPart(1);
  this->Inverse.Evaluate(this->Y, false);
  this->Solver.BodyChanged();
}

bool StressFreeShape::Newton(std::vector<double>& y, const ProgressCallback& progress)
{
  if (!this->Inverse.Evaluate(y, false))
  {
    return false;
  }
  int factors = 0;
  for (int taken = 0; this->Inverse.RelativeResidual() > this->Tolerance; ++taken)
  {
    ReportProgress(progress, 0, "unloading");
    const bool kept = this->Factor->Usable;
    factors += kept ? 0 : 1;
    if (taken == MostNewtonSteps || factors > MostFactors ||
      (!kept && !(this->Inverse.Evaluate(y, true) && this->Factor->Factorize())))
    {
      return false;
    }
    if (!this->TakeStep(y))
    {
      this->Factor->Usable = false;
      if (!kept)
      {
        return false;
      }
      this->Inverse.Evaluate(y, false);
    }
  }
  this->Solver.BodyChanged();
  return this->Inverse.SmallestJ() >= SmallestJ && this->Inverse.LargestJ() <= 1 / SmallestJ &&
    this->Solver.IsStable(this->Inverse.Deformed(y));
}

/// Takes the longest acceptable fraction (1, 1/2, ...) of the step by the present factor: one that
/// makes the next step by the same factor smaller. Keeps the factor if that is much smaller.
/// Returns false if no fraction is acceptable.
bool StressFreeShape::TakeStep(std::vector<double>& y)
{
  const std::vector<std::int32_t>& coordinates = this->Inverse.Coordinates();
  std::vector<double> step = this->Inverse.Forces();
  this->Factor->Solve(step);
  const double before = NormOf(step);
  std::vector<double> trial;
  for (double length = 1; length >= ShortestStep; length *= 0.5)
  {
    trial = y;
    for (std::size_t u = 0; u < step.size(); ++u)
    {
      trial[coordinates[u]] += length * step[u];
    }
    if (!this->Inverse.Evaluate(trial, false))
    {
      continue;
    }
    std::vector<double> next = this->Inverse.Forces();
    this->Factor->Solve(next);
    const double after = NormOf(next);
    if (after <= (1 - 0.25 * length) * before ||
      this->Inverse.RelativeResidual() <= this->Tolerance)
    {
      y.swap(trial);
      if (after > FastContraction * before)
      {
        this->Factor->Usable = false;
      }
      return true;
    }
  }
  return false;
}

/// Solves with the exact Jacobian at the shape found, by refinement with the present factor or with
/// a new one.
std::vector<double> StressFreeShape::SolveExactly(const std::vector<double>& right)
{
  this->Inverse.Evaluate(this->Y, true);
  const std::size_t n = this->Inverse.Coordinates().size();
  const double size = NormOf(right);
  for (bool kept = this->Factor->Usable;; kept = false)
  {
    if (!kept && !this->Factor->Factorize())
    {
      throw ConvergenceError("sensitivities: expected a stress-free shape that changes smoothly, "
                             "found a singular one");
    }
    std::vector<double> solution(right.size(), 0.0);
    std::vector<double> residual = right;
    double last = size;
    for (int pass = 0; pass < MostLinearRefinements; ++pass)
    {
      this->Factor->Solve(residual);
      std::transform(solution.begin(), solution.end(), residual.begin(), solution.begin(),
        [](double a, double b) { return a + b; });
      for (std::size_t begin = 0; begin < right.size(); begin += n)
      {
        this->Factor->Multiply(&solution[begin], &residual[begin]);
      }
      std::transform(right.begin(), right.end(), residual.begin(), residual.begin(),
        [](double a, double b) { return a - b; });
      const double left = NormOf(residual);
      // With a factor of the matrix itself, refinement ends at roundoff.
      if (left <= LinearTolerance * size || (!kept && pass > 0 && left > 0.5 * last))
      {
        return solution;
      }
      if (left > last)
      {
        break;
      }
      last = left;
    }
    if (!kept)
    {
      return solution;
    }
  }
}

VectorFields StressFreeShape::Velocities(const std::vector<MaterialDerivative>& materials,
  const std::vector<WallStiffness>& walls)
{
  const std::size_t count = materials.size() + walls.size();
  if (count == 0)
  {
    return {};
  }
  const std::vector<double> right = this->Inverse.ParameterForces(this->Y, materials, walls);
  const std::vector<double> solution = this->SolveExactly(right);
  const std::vector<std::int32_t>& coordinates = this->Inverse.Coordinates();
  VectorFields velocities(count, this->Y.size());
  for (std::size_t p = 0; p < count; ++p)
  {
    for (std::size_t u = 0; u < coordinates.size(); ++u)
    {
      velocities[p][coordinates[u]] = solution[coordinates.size() * p + u];
    }
    this->Inverse.PutMiddlesBetween(velocities[p]);
  }
  return velocities;
}
}
