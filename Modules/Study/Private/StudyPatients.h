// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_StudyPatients_h
#define mammoray_Private_StudyPatients_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Throws InputError, one line, where the images are of two patients: where identifiers, names,
 * dates of birth or sexes contradict. An identifier of another clinic is no contradiction where
 * name and date of birth agree, nor is a name that changed where identifier and date of birth do; a
 * line of warning is answered for these. No identity is shown: patients are told apart by a number
 * made of it, numbers of images and the folder of the first one.
 */
MAMMORAYSTUDY_EXPORT std::vector<std::string> CheckOnePatient(
  const std::vector<DicomHeader>& images, const std::string& folder);
}

#endif
