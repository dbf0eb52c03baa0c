// SPDX-License-Identifier: Apache-2.0
// What the sub-commands that write DICOM share. No algorithms here.
#ifndef mammoray_DicomOptions_h
#define mammoray_DicomOptions_h

#include "mammoray/IO/DicomIdentity.h"

#include <CLI/CLI.hpp>

#include <string>

namespace mammoray
{
/// Whom a DICOM object is about, as the options say.
struct DicomPatient
{
  std::string Name;
  std::string Id;
  /// Patient and study of the mammogram that is given.
  bool Same = false;

  /// Name and ID, and a new study; throws InputError on texts that DICOM cannot hold.
  DicomIdentity Identity() const;
};

/// Adds --patient-name and --patient-id, and, where a mammogram is given, --same-patient.
void AddDicomPatientOptions(CLI::App& command, DicomPatient& patient, bool mammogramGiven);

/// True for the extension .dcm.
bool IsDicomPath(const std::string& path);

/// Says on stderr when the mammogram is not the file that was registered.
void NoteOtherMammogram(const std::string& result, const std::string& mammogram);

/// How a synthetic image of `what` was computed and what its values mean, for its header.
std::string SyntheticDerivation(bool forProcessing, const std::string& what);
}

#endif
