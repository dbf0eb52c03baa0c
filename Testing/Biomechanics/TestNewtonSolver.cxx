// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Private/NewtonSolver.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace
{
using namespace mammoray;

/**
 * A chain of unknowns in double wells, f = sum of [(u_i^2 - 1)^2 / 4 + (u_i - u_(i - 1))^2 / 2]
 * with coordinate 0 fixed: indefinite between the wells. Not defined beyond |u| = 3.
 */
class Chain : public Objective
{
public:
  explicit Chain(std::size_t unknowns)
  {
    for (std::size_t u = 0; u < unknowns; ++u)
    {
      this->Places.push_back(static_cast<std::int32_t>(u + 1));
      this->Entries.Rows.push_back(static_cast<int>(u));
      if (u + 1 < unknowns)
      {
        this->Entries.Rows.push_back(static_cast<int>(u + 1));
      }
      this->Entries.Starts.push_back(static_cast<int>(this->Entries.Rows.size()));
    }
  }
  const std::vector<std::int32_t>& Coordinates() const override { return this->Places; }
  const SparsePattern& Pattern() const override { return this->Entries; }
  void Evaluate(const std::vector<double>& x, EnergyOrder order, Evaluation& result) override
  {
    ++this->Evaluations[static_cast<int>(order)];
    result.Valid = true;
    result.Energy = 0;
    result.Gradient.assign(x.size(), 0.0);
    result.Hessian.assign(this->Entries.Rows.size(), 0.0);
    double square = 0;
    for (std::size_t i = 1; i < x.size(); ++i)
    {
      const double u = x[i], stretch = u - x[i - 1];
      result.Valid = result.Valid && std::abs(u) < 3;
      result.Energy += 0.25 * (u * u - 1) * (u * u - 1) + 0.5 * stretch * stretch;
      result.Gradient[i] += u * (u * u - 1) + stretch;
      result.Gradient[i - 1] -= stretch;
      const double well = 3 * u * u - 1;
      const double projected = order == EnergyOrder::ProjectedHessian ? std::max(well, 0.0) : well;
      const auto column = static_cast<std::int32_t>(i - 1);
      result.Hessian[this->Entries.PlaceOf(column, column)] +=
        projected + (i + 1 < x.size() ? 2 : 1);
      if (i + 1 < x.size())
      {
        result.Hessian[this->Entries.PlaceOf(column, column + 1)] = -1;
      }
    }
    for (std::size_t i = 1; i < x.size(); ++i)
    {
      square += result.Gradient[i] * result.Gradient[i];
    }
    result.ResidualNorm = std::sqrt(square);
  }
  double Noise() const override { return 1e-15; }
  std::uint64_t Version() const override { return this->Changes; }
  std::unique_ptr<Objective> WorstPart(const std::vector<double>&) const override
  {
    return nullptr;
  }

  /// By order.
  int Evaluations[4] = { 0, 0, 0, 0 };
  std::uint64_t Changes = 0;

private:
  std::vector<std::int32_t> Places;
  SparsePattern Entries;
};

TEST(NewtonSolver, FindsAMinimumWhereTheHessianIsIndefinite)
{
  Chain chain(6);
  NewtonSolver newton(chain);
  std::vector<double> x{ 1, 0.1, 0.05, 0.1, 0.02, 0.1, 0.05 };
  const NewtonResult result = newton.Minimize(x, 1e-12, 50);
  EXPECT_TRUE(result.Converged) << result.Reason;
  // The fixed end lies in the right well.
  for (const double u : x)
  {
    EXPECT_NEAR(u, 1, 1e-11);
  }
  EXPECT_GT(chain.Evaluations[static_cast<int>(EnergyOrder::ProjectedHessian)], 0);
}

TEST(NewtonSolver, ConvergesQuadraticallyNearTheMinimum)
{
  Chain chain(6);
  NewtonSolver newton(chain);
  std::vector<double> x{ 1, 0.9, 1.1, 0.95, 1.05, 0.9, 1.1 };
  const NewtonResult result = newton.Minimize(x, 1e-12, 50);
  EXPECT_TRUE(result.Converged) << result.Reason;
  EXPECT_LE(result.Steps, 5);
}

TEST(NewtonSolver, KeepsAnEvaluationUntilTheObjectiveChanges)
{
  Chain chain(6);
  NewtonSolver newton(chain);
  const std::vector<double> x(7, 0.9);
  newton.EvaluateAt(x);
  newton.EvaluateAt(x);
  EXPECT_EQ(chain.Evaluations[static_cast<int>(EnergyOrder::Hessian)], 1);
  chain.Changes = 1;
  newton.EvaluateAt(x);
  EXPECT_EQ(chain.Evaluations[static_cast<int>(EnergyOrder::Hessian)], 2);
}

TEST(NewtonSolver, SaysWhyItEnded)
{
  Chain chain(6);
  NewtonSolver newton(chain);
  std::vector<double> outside(7, 4.0);
  EXPECT_EQ(newton.Minimize(outside, 1e-12, 50).Reason, "a cell is inverted at the start");
  std::vector<double> x{ 1, 0.1, 0.05, 0.1, 0.02, 0.1, 0.05 };
  const NewtonResult result = newton.Minimize(x, 1e-12, 2);
  EXPECT_FALSE(result.Converged);
  EXPECT_EQ(result.Steps, 2);
  EXPECT_NE(result.Reason.find("after 2 Newton steps"), std::string::npos) << result.Reason;
  EXPECT_THROW(newton.Minimize(x, 1e-12, 50, [](double, const char*) { return false; }),
    Interrupted);
}
}
