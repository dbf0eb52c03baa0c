// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SecureLayer_h
#define mammoray_SecureLayer_h

#include "mammoray/Dicom/DicomNetwork.h"

#include <memory>

class DcmTransportLayer;

namespace mammoray
{
/**
 * Makes the TLS layer for connections to the node: TLS 1.2 or newer, ciphers of DICOM's profile BCP
 * 195, non-downgrading (PS3.15 B.10). The archive's certificate must match the name or address of
 * the node. Returns null if the node uses no TLS. Throws InputError on unusable certificates and
 * keys.
 */
std::unique_ptr<DcmTransportLayer> MakeSecureLayer(const DicomNode& node);
}

#endif
