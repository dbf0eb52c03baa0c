// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/DicomIdentity.h"

#include "Private/DicomElements.h"
#include "Private/DicomStructure.h"
#include "Private/QuietGdcm.h"
#include "mammoray/Foundation/Error.h"

#include <gdcmAttribute.h>
#include <gdcmReader.h>

#include <algorithm>

namespace mammoray
{
DicomReference ReadDicomReference(const std::string& path)
{
  const QuietGdcm quiet;
  if (const std::string damage = FindDicomDamage(path); !damage.empty())
  {
    throw InputError(path + ": expected a DICOM mammogram, " + damage);
  }
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read())
  {
    throw InputError(path + ": expected a DICOM mammogram, found a header that cannot be read");
  }
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  if (const std::string modality = DicomText(data, { 0x0008, 0x0060 }); modality != "MG")
  {
    throw InputError(
      path + ": expected a mammogram (modality MG), found modality '" + modality + "'");
  }
  const auto text = [&](std::uint16_t group, std::uint16_t element) {
    return DicomText(data, { group, element });
  };
  DicomReference reference;
  reference.SopClassUid = text(0x0008, 0x0016);
  reference.SopInstanceUid = text(0x0008, 0x0018);
  reference.SeriesInstanceUid = text(0x0020, 0x000e);
  reference.PatientOrientation = text(0x0020, 0x0020);
  DicomIdentity& identity = reference.Identity;
  identity.PatientName = text(0x0010, 0x0010);
  identity.PatientId = text(0x0010, 0x0020);
  identity.PatientBirthDate = text(0x0010, 0x0030);
  identity.PatientSex = text(0x0010, 0x0040);
  identity.StudyInstanceUid = text(0x0020, 0x000d);
  identity.StudyDate = text(0x0008, 0x0020);
  identity.StudyTime = text(0x0008, 0x0030);
  identity.StudyId = text(0x0020, 0x0010);
  identity.AccessionNumber = text(0x0008, 0x0050);
  identity.ReferringPhysicianName = text(0x0008, 0x0090);
  identity.CharacterSet = text(0x0008, 0x0005);
  gdcm::Attribute<0x0028, 0x0010> rows{ 0 };
  gdcm::Attribute<0x0028, 0x0011> columns{ 0 };
  rows.SetFromDataSet(data);
  columns.SetFromDataSet(data);
  reference.Rows = rows.GetValue();
  reference.Columns = columns.GetValue();
  if (reference.SopClassUid.empty() || reference.SopInstanceUid.empty() ||
    reference.SeriesInstanceUid.empty() || identity.StudyInstanceUid.empty() ||
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
