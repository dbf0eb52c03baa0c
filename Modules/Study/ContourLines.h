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
 * The lines along which an image of `columns` times `rows` values, row by row, has the value
 * `level`: continuous column and row, whole numbers at the centres of pixels. Closed lines repeat
 * their first point. With `around` the image is surrounded by that value, so that lines close along
 * its border; without it they end there.
 */
MAMMORAYSTUDY_EXPORT std::vector<std::vector<std::array<double, 2>>> ContourLines(
  const float* values, int columns, int rows, float level, std::optional<float> around = {});
}

#endif
