// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/DicomIdentity.h"

#include "Private/DicomFile.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>

namespace mammoray
{
DicomReference ReadDicomReference(const std::string& path)
{
  const DicomFile file(path, "a DICOM mammogram");
  DcmItem& data = file.Data();
  if (const std::string modality = DicomText(data, DCM_Modality); modality != "MG")
  {
    throw InputError(
      path + ": expected a mammogram (modality MG), found modality '" + modality + "'");
  }
  DicomReference reference;
  reference.SopClassUid = DicomText(data, DCM_SOPClassUID);
  reference.SopInstanceUid = DicomText(data, DCM_SOPInstanceUID);
  reference.SeriesInstanceUid = DicomText(data, DCM_SeriesInstanceUID);
  reference.PatientOrientation = DicomTexts(data, DCM_PatientOrientation);
  reference.Identity = ReadIdentity(data);
  reference.Rows = DicomShort(data, DCM_Rows).value_or(0);
  reference.Columns = DicomShort(data, DCM_Columns).value_or(0);
  if (reference.SopClassUid.empty() || reference.SopInstanceUid.empty() ||
    reference.SeriesInstanceUid.empty() || reference.Identity.StudyInstanceUid.empty() ||
    reference.Rows == 0 || reference.Columns == 0)
  {
    throw InputError(path +
      ": expected a mammogram with UIDs of its class, instance, series and study, rows and "
      "columns, "
      "found some of them missing");
  }
  return reference;
}

void CheckDicomText(const std::string& text, const std::string& what)
{
  const bool bad = std::any_of(text.begin(), text.end(),
    [](char c) { return c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
  if (bad || text.size() > 64)
  {
    throw InputError(what +
      ": expected at most 64 bytes without '\\' and control characters, found " +
      (bad ? "some" : std::to_string(text.size()) + " bytes"));
  }
}
}
