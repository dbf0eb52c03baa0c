// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SecureLayer_h
#define mammoray_SecureLayer_h

#include "mammoray/Dicom/DicomNetwork.h"

#include <memory>

class DcmTransportLayer;

namespace mammoray
{
/**
 * What connections to the node go through where it wants TLS: 1.2 or newer, ciphers of DICOM's
 * profile BCP 195, non-downgrading (PS3.15 B.10), with an archive that proves the node's name or
 * address by its certificate. Null where it wants none. Throws InputError on certificates and keys
 * that cannot be used.
 */
std::unique_ptr<DcmTransportLayer> MakeSecureLayer(const DicomNode& node);
}

#endif
