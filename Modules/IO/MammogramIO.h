// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramIO_h
#define mammoray_MammogramIO_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * Reads a DICOM mammogram (modality MG, one frame, MONOCHROME1 or MONOCHROME2) in any transfer
 * syntax GDCM decodes: implicit, explicit, big-endian, deflated, RLE, JPEG, JPEG-LS and JPEG 2000.
 *
 * Pixel spacing is taken at the receptor: Imager Pixel Spacing, else Pixel Spacing times Estimated
 * Radiographic Magnification Factor. Nothing that identifies the patient is read.
 *
 * Throws InputError, one line that names the file, when it is missing, truncated, not DICOM, not a
 * mammogram, in colour, a tomosynthesis stack, or without a usable pixel spacing.
 */
MAMMORAYIO_EXPORT Mammogram ReadMammogram(const std::string& path);
}

#endif
