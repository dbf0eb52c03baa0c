// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegisteredMammogram_h
#define mammoray_RegisteredMammogram_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammorayCaseModule.h"

#include <string>

namespace mammoray
{
/**
 * The synthetic mammogram in a folder that 'mammoray register' wrote, with SetPixels' pixels and a
 * header of the unit and pose that were found. View and patient orientation are those of `real`,
 * the mammogram that was registered, where its header says them; its laterality must be 'L' or 'R'.
 * The beam's voltage and materials are left out: the spectrum was another. Throws InputError that
 * names the file, on another laterality, and where the picture has other rows and columns than
 * `real`.
 */
MAMMORAYCASE_EXPORT Mammogram ReadSyntheticMammogram(const std::string& folder,
  const Mammogram& real, Mammogram::Intent intent);

/// Whether the file is the very mammogram that was registered, by its checksum. Throws InputError
/// that names the file where the folder is no result.
MAMMORAYCASE_EXPORT bool IsRegisteredMammogram(const std::string& folder,
  const std::string& mammogramPath);

/**
 * The mammogram that was registered, with spacing, view and laterality as the search had them: a
 * picture without a header has none of its own. Throws InputError, which names the file, when that
 * is another one, and as ReadMammogram or ReadMammogramPicture.
 */
MAMMORAYCASE_EXPORT Mammogram ReadRegisteredMammogram(const std::string& folder,
  const std::string& mammogramPath);
}

#endif
