// SPDX-License-Identifier: Apache-2.0
#include "DicomOptions.h"

#include "SharedOptions.h"

#include "mammoray/IO/MammogramSynthesis.h"

#include <cstdio>
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

void AddDicomPatientOptions(const OptionList& add, DicomPatient& patient, bool mammogramGiven)
{
  const OptionList dicom = add.Group("DICOM");
  CLI::Option* name = dicom("--patient-name", patient.Name,
    "patient's name in DICOM files (Family^Given); default: empty");
  CLI::Option* id =
    dicom("--patient-id", patient.Id, "patient's ID in DICOM files; default: empty");
  if (mammogramGiven)
  {
    dicom
      .Flag("--same-patient", patient.Same,
        "copy name, ID, birth date, sex and study of --mammogram and refer to it, as archives need "
        "to file the new object beside it; otherwise nothing of the patient is copied")
      ->excludes(name)
      ->excludes(id);
  }
}

void AddDicomPictureOptions(const OptionList& add, std::optional<char>& laterality,
  bool& forProcessing, const std::string& remark)
{
  const OptionList dicom = add.Group("DICOM");
  AddSideOption(dicom, laterality, "the patient's own breast; " + remark);
  dicom.Flag("--for-processing", forProcessing,
    "store the transmission, linear, instead of a picture For Presentation");
}

bool IsDicomPath(const std::string& path)
{
  return std::filesystem::path(path).extension() == ".dcm";
}

std::string SyntheticDerivation(bool forProcessing, const std::string& what)
{
  char values[80];
  std::snprintf(values, sizeof values,
    forProcessing ? "Stored values are %.0f times the transmission."
                  : "Stored values are %.0f times the log attenuation.",
    forProcessing ? ProcessingValuesPerTransmission : PresentationValuesPerLogAttenuation);
  return "Synthetic X-ray image, computed by MammoRay " MAMMORAY_VERSION " from a mesh of " + what +
    "; not a radiograph. " + values;
}
}
