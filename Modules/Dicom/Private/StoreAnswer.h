// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_StoreAnswer_h
#define mammoray_Private_StoreAnswer_h

#include "mammorayDicomModule.h"

#include <string>

namespace mammoray
{
/// Why a DICOMweb server did not store an object, by its answer's status and body in JSON (PS3.18
/// section 10.5.3, PS3.3 C.30.1.2); empty where it did. The body is foreign bytes: what is none of
/// the standard's counts as nothing said.
MAMMORAYDICOM_EXPORT std::string WhyNotStored(long status, const std::string& body);
}

#endif
