// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegisteredMammogram_h
#define mammoray_RegisteredMammogram_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayStudyModule.h"

#include <string>

namespace mammoray
{
/**
 * Reads the synthetic mammogram of a result, with pixels by SetPixels and a header for the unit and
 * pose that were found. View and patient orientation are those of `real`, the registered mammogram,
 * if its header has them; its laterality must be 'L' or 'R'. The tube's voltage is the end of the
 * synthetic beam's spectrum. Throws InputError, which names the file, for another laterality and if
 * the picture's rows and columns are not those of `real`.
 */
MAMMORAYSTUDY_EXPORT Mammogram ReadSyntheticMammogram(const ResultFile& result,
  const Mammogram& real, Mammogram::Intent intent);

/// Returns true if the file is the registered mammogram, by its checksum. Throws InputError if it
/// cannot be read.
MAMMORAYSTUDY_EXPORT bool IsRegisteredMammogram(const ResultFile& result,
  const std::string& mammogramPath);

/**
 * Reads the registered mammogram, with the search's spacing, view and laterality, which a picture
 * without a header lacks. Throws InputError, which names the file, if it is another one, and as
 * ReadMammogram or ReadMammogramPicture.
 */
MAMMORAYSTUDY_EXPORT Mammogram ReadRegisteredMammogram(const ResultFile& result,
  const std::string& mammogramPath);

/// Reads the header by which DICOM objects of a result refer to its mammogram. Throws InputError,
/// which names the file, if rows or columns are not the detector's, and as ReadMammogramHeader.
MAMMORAYSTUDY_EXPORT DicomHeader ReadRegisteredReference(const std::string& mammogramPath,
  const XRayDetector& detector);
}

#endif
