// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SeriesSplit_h
#define mammoray_Private_SeriesSplit_h

#include "Private/SeriesRules.h"
#include "mammorayStudyModule.h"

#include <vector>

namespace mammoray
{
/**
 * Slices to volumes: by series, and within a series by what makes slices unlike (kind of image,
 * orientation, size, spacing, echo time) and, where several lie at one place, by what tells their
 * phases apart: temporal position, acquisition, trigger, time, or else their order. Files in the
 * order of the grid; no grid where the slices make no regular volume.
 */
MAMMORAYSTUDY_EXPORT std::vector<SeriesCandidate> SplitIntoVolumes(
  const std::vector<DicomHeader>& slices);
}

#endif
