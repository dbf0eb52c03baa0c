// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "DicomOptions.h"
#include "OutputFiles.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "mammoray/Case/RegisteredMammogram.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/DicomWriter.h"
#include "mammoray/IO/MammogramIO.h"

#include <cstdio>

namespace mammoray
{
namespace
{
struct DicomArguments
{
  std::string Result;
  std::string Mammogram;
  std::optional<char> Laterality;
  DicomPatient Patient;
  bool ForProcessing = false;
  std::string Output;
  bool Overwrite = false;
};

void Declare(const OptionList& add, DicomArguments& arguments)
{
  AddResultOption(add, arguments.Result)->required();
  add
    .Input("--mammogram", arguments.Mammogram,
      "the mammogram that was registered, DICOM MG: view, side and directions are taken from it")
    ->required();
  AddDicomPictureOptions(add, arguments.Laterality, arguments.ForProcessing,
    "default: what the header of --mammogram says");
  AddDicomPatientOptions(add, arguments.Patient, true);
  add("-o,--output", arguments.Output, "DICOM MG (.dcm)")->required();
  AddOverwriteFlag(add, arguments.Overwrite, "the output file");
}

void Run(DicomArguments& arguments)
{
  if (!IsDicomPath(arguments.Output))
  {
    throw InputError(arguments.Output + ": expected the extension .dcm");
  }
  CheckOutputFile(arguments.Output, arguments.Overwrite);
  const DicomIdentity identity = arguments.Patient.Identity();
  Mammogram real = ReadMammogram(CheckInputFile(arguments.Mammogram));
  real.Laterality = arguments.Laterality.value_or(real.Laterality);
  if (real.Laterality == '?')
  {
    throw InputError(arguments.Mammogram +
      ": expected Image Laterality (0020,0062), found none; --side left or right says it");
  }
  const ResultFile result = ReadResultFile(arguments.Result);
  WarnOfDistrust(result.Folder, result.Trust);
  const Mammogram synthetic = ReadSyntheticMammogram(result, real,
    arguments.ForProcessing ? Mammogram::Intent::ForProcessing
                            : Mammogram::Intent::ForPresentation);
  NoteOtherMammogram(result, arguments.Mammogram);
  DicomMammogramOptions writing;
  writing.Identity = identity;
  writing.Derivation = SyntheticDerivation(arguments.ForProcessing,
    "a compressed breast that was registered to a mammogram");
  if (arguments.Patient.Same)
  {
    writing.Imitated = ReadDicomReference(arguments.Mammogram);
    writing.Identity = writing.Imitated->Identity;
  }
  WriteMammogram(synthetic, writing, arguments.Output);
  std::printf("wrote %s: %d x %d pixels, %c %s, %.1f mm thick\n", arguments.Output.c_str(),
    synthetic.Columns, synthetic.Rows, synthetic.Laterality, synthetic.View.c_str(),
    *synthetic.BodyPartThicknessMm);
}
}

void AddDicomCommand(CLI::App& application)
{
  AddCommand<DicomArguments>(application, "dicom",
    "Write the synthetic mammogram of a registration as a DICOM mammogram.\nNothing of the patient "
    "is "
    "taken from --mammogram, and no reference to it, unless --same-patient says so.",
    Declare, Run);
}
}
