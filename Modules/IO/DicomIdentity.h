// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomIdentity_h
#define mammoray_DicomIdentity_h

#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * Whom a new DICOM object is about, and in which study. Empty members are written empty, but for
 * the study's UID, which is made anew. Texts are in CharacterSet (DICOM Specific Character Set).
 */
struct DicomIdentity
{
  std::string PatientName;
  std::string PatientId;
  std::string PatientBirthDate;
  std::string PatientSex;
  std::string StudyInstanceUid;
  std::string StudyDate;
  std::string StudyTime;
  std::string StudyId;
  std::string AccessionNumber;
  std::string ReferringPhysicianName;
  std::string CharacterSet = "ISO_IR 192"; // UTF-8
};

/// A mammogram in a DICOM file that another object refers to.
struct DicomReference
{
  std::string SopClassUid;
  std::string SopInstanceUid;
  std::string SeriesInstanceUid;
  /// Patient directions of rows and columns, as in the header ("A\R"); empty where it says none.
  std::string PatientOrientation;
  /// What the file says of patient and study.
  DicomIdentity Identity;
  int Columns = 0;
  int Rows = 0;
};

/// Throws InputError, one line with the file, unless it is a DICOM mammogram with its UIDs and
/// size.
MAMMORAYIO_EXPORT DicomReference ReadDicomReference(const std::string& path);

/// Throws InputError that names `what` unless the text can be a DICOM name or identifier: at most
/// 64 bytes, without '\' and control characters.
MAMMORAYIO_EXPORT void CheckDicomText(const std::string& text, const std::string& what);
}

#endif
