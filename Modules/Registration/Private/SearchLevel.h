// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SearchLevel_h
#define mammoray_SearchLevel_h

#include "Private/SearchState.h"

#include <memory>
#include <vector>

namespace mammoray
{
enum class LevelEnd
{
  Reached,
  /// The next level has nothing to go on from.
  Failed,
  /// The user has stopped the search.
  Stopped
};

/// What a search compares at one resolution, and its end criterion.
struct ResolutionLevel
{
  double PixelSizeMm = 0;
  PictureComparison Comparison = PictureComparison::Global;
  /// Half the square of the way to the bottom, in standard deviations: with less left it ends.
  double NegligibleFall = 0;
  int MaximumIterations = 0;
  /// The finest resolution as the result is to compare it.
  bool Last = false;
  /**
   * Residuals count as their variances tell where the level begins, which is where another
   * comparison has converged: generalised least squares with an estimated covariance, in two
   * stages (Carroll and Ruppert 1988, chapter 2, where more cycles gain nothing to first order).
   * Estimated anew at the end it would run away: outlines that count less fit less, and count
   * still less then. Whether it has settled where its iterations are spent, a
   * covariance tells that is made as a result's, of where the level begins: that of the weights
   * alone lacks what parameters absorb.
   */
  bool Reweighed = false;
};

/// Searches at one resolution, from where `views` stand. The accepted states go into `search`, and
/// at the last level the covariance.
LevelEnd SearchLevel(std::vector<std::unique_ptr<ViewEvaluator>> views,
  const ResolutionLevel& level, SearchState& search, const ProgressCallback& progress);
}

#endif
