// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ContourLines_h
#define mammoray_ContourLines_h

#include "mammorayStudyModule.h"

#include <array>
#include <optional>
#include <vector>

namespace mammoray
{
/**
 * Finds the lines along which an image of `columns` times `rows` values, row by row, has the value
 * `level`. Points are continuous column and row, whole at the centres of pixels. Closed lines
 * repeat their first point. `around` surrounds the image with a value, so that lines close along
 * its border; without it they end there.
 */
MAMMORAYSTUDY_EXPORT std::vector<std::vector<std::array<double, 2>>> ContourLines(
  const float* values, int columns, int rows, float level, std::optional<float> around = {});
}

#endif
