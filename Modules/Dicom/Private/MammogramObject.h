// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MammogramObject_h
#define mammoray_Private_MammogramObject_h

#include "mammoray/Foundation/Mammogram.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <string>

namespace mammoray
{
/// Throws InputError unless a DICOM object can hold the mammogram (WriteMammogram).
void CheckMammogramObject(const Mammogram& mammogram);

/// The item of a View Code Sequence. Throws InputError on a view that has no code.
DcmItem MammogramViewItem(const std::string& view);

/// "LIN" or "LOG", and the sign, as a header says them where the mammogram does not.
const char* PixelRelationship(const Mammogram& mammogram);
std::int16_t PixelRelationshipSign(const Mammogram& mammogram);

/// What of the Image Pixel module is the same of all mammograms: one unsigned value of 16 bits.
void AddPixelDescription(DcmItem& data, const Mammogram& mammogram);
}

#endif
