// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_StoreAnswer_h
#define mammoray_Private_StoreAnswer_h

#include "mammorayDicomModule.h"

#include <string>

namespace mammoray
{
/// The reason why a DICOMweb server did not store an object, from the status and JSON body of its
/// answer (PS3.18 section 10.5.3, PS3.3 C.30.1.2). Empty if it was stored. Parts of the body that
/// do not follow the standard are ignored.
MAMMORAYDICOM_EXPORT std::string WhyNotStored(long status, const std::string& body);
}

#endif
