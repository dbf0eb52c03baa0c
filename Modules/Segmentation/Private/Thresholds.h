// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Thresholds_h
#define mammoray_Thresholds_h

#include "mammoraySegmentationModule.h"

#include <vector>

namespace mammoray
{
/**
 * Otsu's thresholds between `classes` classes of the values (at least two of them), ascending. The
 * histogram spans all but the outermost thousandth at each end; where that is one value, it is
 * every threshold.
 */
MAMMORAYSEGMENTATION_EXPORT std::vector<double> OtsuThresholds(const std::vector<float>& values,
  int classes);

/// The value below which a fraction [0, 1] of the values lies; there must be one at least.
MAMMORAYSEGMENTATION_EXPORT double Quantile(std::vector<float> values, double fraction);

/// The middle of the shortest interval that holds half of the values: the level of the larger of
/// two tissues, whatever the other's (Rousseeuw and Leroy 1987). There must be one value at least.
MAMMORAYSEGMENTATION_EXPORT double MiddleOfShortestHalf(std::vector<float> values);
}

#endif
