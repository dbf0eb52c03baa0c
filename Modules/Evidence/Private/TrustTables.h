// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_TrustTables_h
#define mammoray_Private_TrustTables_h

#include "mammoray/Evidence/RegistrationEvidence.h"

#include <string>

namespace mammoray
{
/// How far twins, wrong pairs and virtual studies were trusted, a row each; empty without any.
std::string TrustTable(const RegistrationEvidence& evidence);

/// How well the tissue's correlation tells right from wrong results, by a limit that is chosen on
/// one half; empty without either.
std::string ScoreText(const RegistrationEvidence& evidence);
}

#endif
