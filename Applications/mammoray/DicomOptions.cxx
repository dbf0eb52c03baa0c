// SPDX-License-Identifier: Apache-2.0
#include "DicomOptions.h"

#include "SharedOptions.h"

#include <filesystem>

namespace mammoray
{
DicomIdentity DicomPatient::Identity() const
{
  CheckDicomText(this->Name, "--patient-name");
  CheckDicomText(this->Id, "--patient-id");
  DicomIdentity identity;
  identity.PatientName = this->Name;
  identity.PatientId = this->Id;
  return identity;
}

void AddDicomPatientOptions(const OptionList& add, DicomPatient& patient)
{
  const OptionList dicom = add.Group("DICOM").Expert();
  dicom("--patient-name", patient.Name, "patient's name in DICOM files (Family^Given)");
  dicom("--patient-id", patient.Id, "patient's ID in DICOM files");
}

void AddSamePatientFlag(const OptionList& add, bool& same)
{
  add.Flag("--same-patient", same,
    "name the patient and study as the mammogram's header does\n(archives need it; otherwise only "
    "dates are written)");
}

void AddDicomPictureOptions(const OptionList& add, std::optional<char>& laterality,
  bool& forProcessing)
{
  const OptionList dicom = add.Group("DICOM");
  AddSideOption(dicom, laterality);
  dicom.Expert().Flag("--for-processing", forProcessing,
    "store the transmission, linear, instead of a picture For Presentation");
}

bool IsDicomPath(const std::string& path)
{
  return std::filesystem::path(path).extension() == ".dcm";
}
}
