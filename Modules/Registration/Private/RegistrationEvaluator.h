// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationEvaluator_h
#define mammoray_RegistrationEvaluator_h

#include "Private/ViewEvaluator.h"
#include "mammoray/Registration/RegistrationResult.h"

#include <Eigen/Core>
#include <ceres/evaluation_callback.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace mammoray
{
/// The residuals of all views for Ceres, one parameter block for all free parameters.
class MAMMORAYREGISTRATION_EXPORT RegistrationEvaluator : public ceres::EvaluationCallback
{
public:
  /// Poses without an equilibrium, of one resolution, after which a search ends: each costs many
  /// times what a good one does, and the best match lies where the breast cannot be compressed to.
  static constexpr int LargestNumberOfFailures = 5;

  RegistrationEvaluator(std::vector<std::unique_ptr<ViewEvaluator>> views,
    std::vector<FreeParameter> free, const RegistrationOptions& options,
    const ProgressCallback& progress);

  void PrepareForEvaluation(bool evaluateJacobians, bool newPoint) override;

  /// Back to equilibria, those of the unknowns as they are now.
  void ReturnTo(const std::vector<std::shared_ptr<PosedBreast>>& states);

  /// Of each view what RegistrationResiduals::Weigh takes, at the evaluated point, which has its
  /// Jacobian; there and from there on.
  void Weigh(const std::vector<std::vector<double>>& factors);

  /// The bottom of the cost's Gauss-Newton model, residuals weighted as by the robust loss, seen
  /// from the evaluated point: the way there, -H^-1 g, in the block's units, and how far the cost
  /// falls, g^T H^-1 g / 2. Parameters that are at a bound and would go beyond it stay.
  struct Bottom
  {
    Eigen::VectorXd Step;
    double Fall = 0;
  };
  Bottom PredictedBottom() const;
  /// By which the robust loss multiplies the square of a residual.
  double Weight(std::size_t residual) const;

  /// Residuals beside the evaluated point for Ceres' differences, which are relative to their
  /// argument: offsets[0][u] is 1 at the point, and 1 more one scale of free parameter u beside it.
  bool operator()(const double* const* offsets, double* residuals) const;

  /// The residuals of one view, and their number.
  std::span<const double> ResidualsOf(std::size_t view) const;
  std::size_t NumberOfResiduals(std::size_t view) const
  {
    return this->First[view + 1] - this->First[view];
  }
  RegistrationCosts CostsOf(std::size_t view) const
  {
    return this->Views[view]->Compared.Costs(this->ResidualsOf(view));
  }

  const std::vector<FreeParameter> FreeParameters;
  std::vector<std::unique_ptr<ViewEvaluator>> Views;
  /// Ceres' parameter block: the free parameters over their scales.
  std::vector<double> Block;
  /// Those of all views follow one after the other.
  std::vector<double> Residuals;
  /// Where those of each view begin, and at last their number.
  std::vector<std::size_t> First;
  /// Beyond which size the robust loss counts each linearly; infinite of priors.
  std::vector<double> RobustWidths;
  /// Column u is d residuals / d Block[u].
  std::vector<std::vector<double>> Jacobian;
  bool Valid = false;
  bool Stopped = false;
  /// Poses without an equilibrium that were tried.
  int Failures = 0;

private:
  /// Equilibria and residuals at the block, with the Jacobian where it is wanted at once.
  bool Evaluate(bool withJacobian);
  void EvaluateJacobian();
  bool DifferentiateByDifferences();
  bool IsStoppedByBound(std::size_t unknown, double slope) const;
  bool Stop();
  std::vector<double> ValuesAt(std::size_t view) const;
  /// The free parameters that a view has: their numbers, and which of its parameters they are.
  struct Selection
  {
    std::vector<std::size_t> Numbers;
    std::vector<int> Parameters;
  };

  std::vector<Selection> Selected;
  const RegistrationDerivatives Derivatives;
  const double DifferenceStep;
  const ProgressCallback& Progress;
  std::vector<double> EvaluatedAt;
  bool IsEvaluated = false;
  bool HasJacobian = false;
};
}

#endif
