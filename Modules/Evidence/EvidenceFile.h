// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EvidenceFile_h
#define mammoray_EvidenceFile_h

#include "mammoray/Evidence/RegistrationEvidence.h"
#include "mammorayEvidenceModule.h"

#include <string>

namespace mammoray
{
/// What two runs must share to be one, as JSON: phantoms by their checksums, and what is asked of
/// the twins. Throws InputError where a phantom cannot be read.
MAMMORAYEVIDENCE_EXPORT std::string EvidenceSettings(const EvidenceOptions& options);

/// All runs as JSON, with the settings beside them; what is not a number is null.
MAMMORAYEVIDENCE_EXPORT std::string EvidenceJson(const RegistrationEvidence& evidence,
  const std::string& settings);

/// Reads a file of EvidenceJson. Throws InputError when it is none, or one of other settings.
MAMMORAYEVIDENCE_EXPORT RegistrationEvidence ReadEvidence(const std::string& path,
  const std::string& settings);
}

#endif
