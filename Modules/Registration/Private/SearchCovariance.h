// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SearchCovariance_h
#define mammoray_SearchCovariance_h

#include "Private/JointSearch.h"

namespace mammoray
{
/**
 * Finds the covariance of the unknowns where the search stands, for all mammograms and each of
 * them, also with what is not known of the parameters that are held (consider covariance). How
 * much outline and picture tell follows from their own residuals there (EstimateVariances), not
 * from the weights of the search.
 */
void KeepCovariance(RegistrationEvaluator& evaluator, JointSearch& search);
}

#endif
