// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationEvaluator_h
#define mammoray_RegistrationEvaluator_h

#include "Private/MammogramEvaluator.h"

#include <Eigen/Core>
#include <ceres/evaluation_callback.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace mammoray
{
/// A free parameter of a search, of one mammogram or shared by all.
struct SearchUnknown
{
  int Parameter = 0;
  /// The mammograms that have it.
  std::vector<std::size_t> Mammograms;
  /// These are those of the first of them.
  double Lower = 0;
  double Upper = 0;
  double Scale = 1;
};

/// The residuals of all mammograms for Ceres, one parameter block for all unknowns.
class MAMMORAYREGISTRATION_EXPORT RegistrationEvaluator : public ceres::EvaluationCallback
{
public:
  /// Poses without an equilibrium, of one resolution, after which a search ends: each costs many
  /// times what a good one does, and the best match lies where the breast cannot be compressed to.
  static constexpr int LargestNumberOfFailures = 5;

  RegistrationEvaluator(std::vector<SearchedMammogram> mammograms,
    std::vector<SearchUnknown> unknowns, const ProgressCallback& progress);

  void PrepareForEvaluation(bool evaluateJacobians, bool newPoint) override;

  /// Back to equilibria, those of the unknowns as they are now.
  void ReturnTo(const std::vector<std::shared_ptr<EvaluatedState>>& states);

  /// Of each mammogram what MammogramEvaluator::Weigh takes, at the evaluated point, which has its
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
  /// By which the robust loss multiplies the square of each residual.
  std::vector<double> Weights() const;

  /// Residuals beside the evaluated point for Ceres' differences, which are relative to their
  /// argument: offsets[0][u] is 1 at the point, and 1 more one scale of unknown u beside it.
  bool operator()(const double* const* offsets, double* residuals) const;

  const std::vector<SearchUnknown> Unknowns;
  std::vector<std::unique_ptr<MammogramEvaluator>> Mammograms;
  /// Ceres' parameter block: the unknowns over their scales.
  std::vector<double> Block;
  /// Those of all mammograms follow one after the other.
  std::vector<double> Residuals;
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
  bool IsExact() const;
  bool DifferentiateByDifferences();
  bool IsStoppedByBound(std::size_t unknown, double slope) const;
  bool Stop();
  std::vector<double> ValuesAt(std::size_t mammogram) const;
  /// The unknowns that a mammogram has: their numbers and its parameters.
  struct Selection
  {
    std::vector<std::size_t> Unknowns;
    std::vector<int> Parameters;
  };

  std::vector<Selection> Selected;
  /// Where each mammogram's residuals begin.
  std::vector<std::size_t> First;
  const ProgressCallback& Progress;
  std::vector<double> EvaluatedAt;
  bool IsEvaluated = false;
  bool HasJacobian = false;
};
}

#endif
