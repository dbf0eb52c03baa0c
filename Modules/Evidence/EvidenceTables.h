// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EvidenceTables_h
#define mammoray_EvidenceTables_h

#include "mammoray/Evidence/RegistrationEvidence.h"
#include "mammorayEvidenceModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// The tables for a README, in Markdown.
MAMMORAYEVIDENCE_EXPORT std::string EvidenceTables(const RegistrationEvidence& evidence);

/// The curve of right against wrong results that pass a limit of their tissue correlation (a
/// receiver operating characteristic), both halves of the evidence, as a picture.
MAMMORAYEVIDENCE_EXPORT std::string TrustCurveSvg(const RegistrationEvidence& evidence);

/// A row for each twin run, comma separated, below a header.
MAMMORAYEVIDENCE_EXPORT std::string TwinTable(const std::vector<TwinRun>& runs);
}

#endif
