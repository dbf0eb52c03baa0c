// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_TruthFile_h
#define mammoray_Private_TruthFile_h

#include "mammoray/Evidence/VirtualStudy.h"
#include "mammorayEvidenceModule.h"

#include <string>

namespace mammoray
{
/// Writes what ReadVirtualStudyTruth reads. Throws InputError where it cannot be written.
MAMMORAYEVIDENCE_EXPORT void WriteTruth(const VirtualStudyTruth& truth, const std::string& path);
}

#endif
