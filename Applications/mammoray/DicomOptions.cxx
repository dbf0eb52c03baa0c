// SPDX-License-Identifier: Apache-2.0
#include "DicomOptions.h"

#include "mammoray/Case/RegisteredMammogram.h"
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

void AddDicomPatientOptions(CLI::App& command, DicomPatient& patient, bool mammogramGiven)
{
  CLI::Option* name = command
                        .add_option("--patient-name", patient.Name,
                          "patient's name in DICOM files (Family^Given); default: empty")
                        ->group("DICOM");
  CLI::Option* id =
    command.add_option("--patient-id", patient.Id, "patient's ID in DICOM files; default: empty")
      ->group("DICOM");
  if (mammogramGiven)
  {
    command
      .add_flag("--same-patient", patient.Same,
        "copy name, ID, birth date, sex and study of --mammogram and refer to it, as archives need "
        "to file the new object beside it; otherwise nothing of the patient is copied")
      ->excludes(name)
      ->excludes(id)
      ->group("DICOM");
  }
}

bool IsDicomPath(const std::string& path)
{
  return std::filesystem::path(path).extension() == ".dcm";
}

void NoteOtherMammogram(const std::string& result, const std::string& mammogram)
{
  if (!IsRegisteredMammogram(result, mammogram))
  {
    std::fprintf(stderr, "mammoray: note: %s is not the file that was registered\n",
      mammogram.c_str());
  }
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
