// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SearchCovariance_h
#define mammoray_SearchCovariance_h

#include "Private/ResidualGroups.h"
#include "Private/SearchState.h"

#include <Eigen/Core>

namespace mammoray
{
/// Covariance of the free parameters over their scales, where the evaluator stands and its groups
/// were compared.
MAMMORAYREGISTRATION_EXPORT Eigen::MatrixXd CovarianceOf(RegistrationEvaluator& evaluator,
  const ResidualGroups& compared);

/**
 * Finds the covariance of the unknowns where the search stands, for all mammograms and each of
 * them, also with what is not known of the parameters that are fixed (consider covariance). How
 * much outline and picture tell follows from their own residuals there (EstimateVariances), not
 * from the weights of the search. What the roundness of the plates' edges does is counted, too;
 * results warn where it could not be found.
 */
MAMMORAYREGISTRATION_EXPORT void KeepCovariance(RegistrationEvaluator& evaluator,
  SearchState& search);
}

#endif
