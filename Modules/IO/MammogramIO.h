// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramIO_h
#define mammoray_MammogramIO_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammorayIOModule.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * Reads a DICOM mammogram (modality MG, MONOCHROME1 or MONOCHROME2) in any transfer syntax GDCM
 * decodes: implicit, explicit, big-endian, deflated, RLE, JPEG, JPEG-LS and JPEG 2000. Of the
 * projections of a tomosynthesis (ReadProjections) the one whose source stands nearest to the
 * middle of all.
 *
 * Pixel spacing is taken at the receptor: Imager Pixel Spacing, else Pixel Spacing times Estimated
 * Radiographic Magnification Factor. Nothing that identifies the patient is read.
 *
 * Throws InputError, one line that names the file, when it is missing, truncated, not DICOM, not a
 * mammogram, in colour, a stack of reconstructed slices, or without a usable pixel spacing.
 */
MAMMORAYIO_EXPORT Mammogram ReadMammogram(const std::string& path);

/**
 * Reads the projections of one compression from a Breast Projection X-Ray Image (PS3.3 A.74): of
 * each frame a mammogram with its SourceFootPixel and the height of its source, by the object's
 * isocenter reference system (C.8.31.6), in the order of the frames. Of any other mammogram itself,
 * as ReadMammogram. Pixels of 8 or 16 bits; 2 to 200 frames.
 *
 * Throws InputError as ReadMammogram, and where a frame does not say where source and detector
 * stood.
 */
MAMMORAYIO_EXPORT std::vector<Mammogram> ReadProjections(const std::string& path);

/// The number of the projection whose source stands nearest to the middle of all; of at least one.
MAMMORAYIO_EXPORT std::size_t MiddleProjection(const std::vector<Mammogram>& projections);
}

#endif
