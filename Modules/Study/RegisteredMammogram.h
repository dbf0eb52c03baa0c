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
 * The synthetic mammogram in a result's folder, with SetPixels' pixels and a header of the unit and
 * pose that were found. View and patient orientation are those of `real`, the mammogram that was
 * registered, where its header says them; its laterality must be 'L' or 'R'. The tube's voltage is
 * where the synthetic beam's spectrum ends; its materials are left out. Throws InputError that
 * names the file, on another laterality, and where the picture has other rows and columns than
 * `real`.
 */
MAMMORAYSTUDY_EXPORT Mammogram ReadSyntheticMammogram(const ResultFile& result,
  const Mammogram& real, Mammogram::Intent intent);

/// Whether the file is the very mammogram that was registered, by its checksum. Throws InputError
/// where it cannot be read.
MAMMORAYSTUDY_EXPORT bool IsRegisteredMammogram(const ResultFile& result,
  const std::string& mammogramPath);

/**
 * The mammogram that was registered, with spacing, view and laterality as the search had them: a
 * picture without a header has none of its own. Throws InputError, which names the file, when that
 * is another one, and as ReadMammogram or ReadMammogramPicture.
 */
MAMMORAYSTUDY_EXPORT Mammogram ReadRegisteredMammogram(const ResultFile& result,
  const std::string& mammogramPath);

/// What DICOM objects of a result need to refer to its mammogram. Throws InputError, which names
/// the file, where it has not the pixels of the registered detector, and as ReadDicomReference.
MAMMORAYSTUDY_EXPORT DicomReference ReadRegisteredReference(const std::string& mammogramPath,
  const XRayDetector& detector);
}

#endif
