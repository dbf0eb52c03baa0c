// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MammogramObject_h
#define mammoray_Private_MammogramObject_h

#include "mammoray/Foundation/Mammogram.h"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <string>

namespace mammoray
{
/// Throws InputError unless the mammogram can be written as a DICOM object (WriteMammogram).
void CheckMammogramObject(const Mammogram& mammogram);

/// Item of a View Code Sequence. Throws InputError if the view has no code.
DcmItem MammogramViewItem(const std::string& view);

/// Pixel Intensity Relationship ("LIN" or "LOG") and its sign, with defaults for unknown values.
const char* PixelRelationship(const Mammogram& mammogram);
int PixelRelationshipSign(const Mammogram& mammogram);

/// Adds the description of the pixels, 16 bits, and their intent.
void AddMammogramPixels(DcmItem& data, const Mammogram& mammogram);
}

#endif
