// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomMammogramWriter_h
#define mammoray_DicomMammogramWriter_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/IO/DicomIdentity.h"
#include "mammorayIOModule.h"

#include <optional>
#include <string>

namespace mammoray
{
struct DicomMammogramOptions
{
  DicomIdentity Identity;
  /// The mammogram that the image imitates; empty: the file refers to none.
  std::optional<DicomReference> Imitated;
  /// How the image was computed, a sentence or two, at most 1024 bytes.
  std::string Derivation;
};

/**
 * Writes a synthetic image as a DICOM mammogram (Digital Mammography X-Ray Image, PS3.3 section
 * A.26; For Presentation or For Processing as the mammogram says), marked as derived, 16 bits, not
 * compressed. ReadMammogram gives the same mammogram back. Its pixels must be whole numbers from 0
 * to 65535. A presentation's window reaches from 0 to FindWhite's value.
 *
 * The file holds nothing of the patient but what Identity says, and no private elements.
 *
 * Throws InputError when laterality, view or patient orientation is unknown (a mammogram must say
 * them), pixels or spacings are unusable, or the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteMammogram(const Mammogram& mammogram,
  const DicomMammogramOptions& options, const std::string& path);
}

#endif
