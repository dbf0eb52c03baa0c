// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramMask_h
#define mammoray_MammogramMask_h

#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <optional>
#include <vector>

namespace mammoray
{
/// Edge of the pectoral muscle on the receptor, a straight line.
struct PectoralEdge
{
  /// Intersections with the head-side end of the breast and with the chest-wall side of the
  /// picture; gantry x, y, mm.
  std::array<double, 2> Head{ 0, 0 };
  std::array<double, 2> ChestWall{ 0, 0 };
  /// Mean step of log attenuation across it, in standard deviations of the breast.
  double Contrast = 0;
};

/**
 * Looks for the pectoral muscle of an oblique view: the corner between chest wall and head (at +x
 * where `headward` is 1, at -x where it is -1) that a straight edge cuts off, brighter all along it
 * than the breast beside it (after Karssemeijer 1998, who takes the edge from a Hough transform;
 * here all lines on a grid of 2 mm are tried). Nothing where no line is brighter on its inner side
 * along three quarters of its length and by 0.6 standard deviations of the breast on average.
 */
MAMMORAYREGISTRATION_EXPORT std::optional<PectoralEdge> FindPectoralEdge(
  const RegistrationTarget& target, int headward);

/// Excludes the corner behind the edge, and 2 mm beyond it.
MAMMORAYREGISTRATION_EXPORT void ExcludePectoral(const PectoralEdge& edge, int headward,
  RegistrationTarget& target);

/**
 * Excludes what is burnt into the picture of the breast: pixels at the brightest value of all, and
 * 0.5 mm around them, where they have at least 0.5 mm^2 together: text and markers, and tissue that
 * the display saturates. Answers their area, mm^2. Nothing is excluded where a twentieth of the
 * breast or more is that bright.
 */
MAMMORAYREGISTRATION_EXPORT double ExcludeSaturated(RegistrationTarget& target);
}

#endif
