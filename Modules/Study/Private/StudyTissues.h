// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_StudyTissues_h
#define mammoray_Private_StudyTissues_h

#include "mammoray/Study/StudyCase.h"

namespace mammoray
{
/// Material indices and the MRI on their grid become a study's tissue: what of it is registered,
/// what was cut off behind, and its measures. Both in DICOM LPS.
StudyTissue MakeStudyTissue(LabelVolume&& materials, IntensityVolume&& mri,
  const MaterialTable& table);
}

#endif
