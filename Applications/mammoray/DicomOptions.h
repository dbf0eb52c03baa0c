// SPDX-License-Identifier: Apache-2.0
// Options of the commands that write DICOM.
#ifndef mammoray_DicomOptions_h
#define mammoray_DicomOptions_h

#include "OptionList.h"
#include "mammoray/Dicom/DicomHeader.h"

#include <optional>
#include <string>

namespace mammoray
{
/// The patient of a DICOM object that refers to no other object.
struct DicomPatient
{
  std::string Name;
  std::string Id;

  /// Name and ID, and a new study; throws InputError on texts that DICOM cannot hold.
  DicomIdentity Identity() const;
};

/// Adds --patient-name and --patient-id.
void AddDicomPatientOptions(const OptionList& add, DicomPatient& patient);

/// Adds --side ('L' or 'R') and --for-processing of a synthetic mammogram.
void AddDicomPictureOptions(const OptionList& add, std::optional<char>& laterality,
  bool& forProcessing);

/// Help of --mammogram where it is that of a result.
inline constexpr const char* RegisteredMammogramHelp =
  "the mammogram that was registered (DICOM MG), which objects refer to";

/// Adds --same-patient: patient and study of the mammogram.
void AddSamePatientFlag(const OptionList& add, bool& same);

/// True for the extension .dcm.
bool IsDicomPath(const std::string& path);
}

#endif
