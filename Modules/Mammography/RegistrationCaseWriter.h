// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationCaseWriter_h
#define mammoray_RegistrationCaseWriter_h

#include "RegistrationCase.h"
#include "mammorayMammographyModule.h"

#include <string>

namespace mammoray
{
/**
 * Writes into an existing folder: uncompressed.vtu and compressed.vtu (volume frame, both with the
 * point array "Displacement", mm, from the one to the other), synthetic.mha (log attenuation on the
 * mammogram's pixel grid, float), and what WriteRegistrationReport writes. Throws InputError when a
 * file cannot be written.
 */
MAMMORAYMAMMOGRAPHY_EXPORT void WriteRegistrationCase(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::string& folder);
}

#endif
