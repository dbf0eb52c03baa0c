// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ResidualGroups_h
#define mammoray_ResidualGroups_h

#include "Private/RegistrationEvaluator.h"
#include "Private/VarianceComponents.h"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace mammoray
{
/// The residuals of the outline and of the picture, in turn, of each projection of each view. The
/// pairs are counted on by RegistrationResiduals::Weigh and by SearchCovariance's misfit.
struct MAMMORAYREGISTRATION_EXPORT ResidualGroups
{
  std::vector<ResidualGroup> Groups;
  /// First residual of each group, and the number of its view.
  std::vector<Eigen::Index> First;
  std::vector<std::size_t> View;
  /// Factors that multiply each group's residuals in the search.
  std::vector<double> Factors;
  /// The precision of what is known of the free parameters beforehand, in their scales.
  Eigen::MatrixXd Priors;
  /// Estimated from the residuals themselves.
  VarianceComponents Variances;

  /// Makes each group's residuals standard deviations by Variances, here as in the evaluator, which
  /// stands where these were compared; Groups and Variances are what they were.
  void WeighByVariances(RegistrationEvaluator& evaluator);
};

/// Compares the groups at the evaluator's current point; nothing if the Jacobian there does not
/// determine all free parameters, or if the user has stopped the search.
MAMMORAYREGISTRATION_EXPORT std::optional<ResidualGroups> CompareGroups(
  RegistrationEvaluator& evaluator);
}

#endif
