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
  /// A search ends after so many poses without an equilibrium at one resolution. Each costs many
  /// times what a good one does, and the best match lies where the breast cannot be compressed to.
  static constexpr int LargestNumberOfFailures = 5;

  RegistrationEvaluator(std::vector<std::unique_ptr<ViewEvaluator>> views,
    std::vector<FreeParameter> free, const ProgressCallback& progress);

  void PrepareForEvaluation(bool evaluateJacobians, bool newPoint) override;

  /// Returns to equilibria of the current parameters.
  void ReturnTo(const std::vector<std::shared_ptr<PosedBreast>>& states);

  /// Applies new factors to each view (RegistrationResiduals::Weigh), at the evaluated point, whose
  /// Jacobian must be known, and from then on.
  void Weigh(const std::vector<std::vector<double>>& factors);

  /// Minimum of the Gauss-Newton model of the cost at the evaluated point, residuals weighted by
  /// the robust loss: the step there, -H^-1 g, in the block's units, and the decrease of the cost,
  /// g^T H^-1 g / 2. Parameters at a bound that would cross it are kept.
  struct Bottom
  {
    Eigen::VectorXd Step;
    double Fall = 0;
  };
  Bottom PredictedBottom() const;
  /// Factor of the robust loss on the square of a residual.
  double Weight(std::size_t residual) const;

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
  /// Residuals of all views, one view after the other.
  std::vector<double> Residuals;
  /// First residual of each view, then the number of all.
  std::vector<std::size_t> First;
  /// Sizes above which the robust loss is linear; infinite for priors.
  std::vector<double> RobustWidths;
  /// d Residuals / d Block, a column for each free parameter.
  Eigen::MatrixXd Jacobian;
  bool Valid = false;
  bool Stopped = false;
  /// Number of poses tried that have no equilibrium.
  int Failures = 0;

private:
  /// Equilibria and residuals at the block, with the Jacobian where it is wanted at once.
  bool Evaluate(bool withJacobian);
  void EvaluateJacobian();
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
  const ProgressCallback& Progress;
  std::vector<double> EvaluatedAt;
  bool IsEvaluated = false;
  bool HasJacobian = false;
};
}

#endif
