// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SeriesRules_h
#define mammoray_Private_SeriesRules_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Study/Intake.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A breast is 100 to 200 mm high and its slices 1 to 4 mm apart.
inline constexpr std::size_t FewestSlicesOfBreast = 12;

/// A volume on its way into a study: with the header of its first slice.
struct SeriesCandidate
{
  StudySeries Series;
  DicomHeader First;
};

/// Sequence, position and fat suppression of a series by the header of one of its slices, and why
/// it cannot be one of breast tissue, as far as its header tells.
MAMMORAYSTUDY_EXPORT void DescribeSeries(SeriesCandidate& candidate);

/// Why the volume is none of a breast by its grid or the lack of one; empty where it is.
MAMMORAYSTUDY_EXPORT std::string WhyNoBreastVolume(const SeriesCandidate& candidate);

/// A series whose scan options do not name fat suppression has none where those of others of the
/// same examination do.
MAMMORAYSTUDY_EXPORT void CompareScanOptions(std::vector<SeriesCandidate>& candidates);

/// Fills in the contrast phases, each of which follows from all series, in their order of time.
MAMMORAYSTUDY_EXPORT void FindContrastPhases(std::vector<SeriesCandidate>& candidates);

/// When a slice was taken, in order as a text: date and time of acquisition, else of the series;
/// empty where none is said.
MAMMORAYSTUDY_EXPORT std::string MomentOf(const DicomHeader& header);
}

#endif
