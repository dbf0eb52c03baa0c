// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MammogramRules_h
#define mammoray_Private_MammogramRules_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Study/Intake.h"
#include "mammorayStudyModule.h"

namespace mammoray
{
/// Whether a header is one of an X-ray of the breast, from the unit or made of one.
MAMMORAYSTUDY_EXPORT bool IsMammogram(const DicomHeader& header);

/// Why a mammogram is none of a whole breast as plates press it onto the receptor, by its header:
/// "magnification view"; empty where that does not say so.
MAMMORAYSTUDY_EXPORT std::string WhyNotWholeBreast(const DicomHeader& header);

MAMMORAYSTUDY_EXPORT StudyMammogram DescribeMammogram(const DicomHeader& header);

/**
 * The mammogram of a side and view to take: single exposures before what tomosynthesis computes,
 * the newest first, of one exposure's forms For Processing. Fills in why for it and for all others
 * of that side and view; an index, or nothing.
 */
MAMMORAYSTUDY_EXPORT std::optional<std::size_t> ChooseMammogram(
  const std::vector<StudyMammogram>& mammograms, char side, const std::string& view,
  std::vector<std::string>& reasons);
}

#endif
