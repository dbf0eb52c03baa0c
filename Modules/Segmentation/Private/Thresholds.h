// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Thresholds_h
#define mammoray_Thresholds_h

#include "mammoraySegmentationModule.h"

#include <vector>

namespace mammoray
{
/// Otsu's thresholds between `classes` (at least 2) classes of the values, ascending. The histogram
/// omits the outermost 0.1 % at each end. If only one value remains, it is every threshold.
MAMMORAYSEGMENTATION_EXPORT std::vector<double> OtsuThresholds(const std::vector<float>& values,
  int classes);

/// The value below which a fraction [0, 1] of the values lies; there must be at least one value.
MAMMORAYSEGMENTATION_EXPORT double Quantile(std::vector<float> values, double fraction);

/// The midpoint of the shortest interval with half of the values: the level of the larger of two
/// tissues, whatever the other one's (Rousseeuw and Leroy 1987). There must be at least one value.
MAMMORAYSEGMENTATION_EXPORT double MiddleOfShortestHalf(std::vector<float> values);
}

#endif
