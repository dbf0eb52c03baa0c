// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"
#include "DicomOptions.h"
#include "mammoray/Case/RegisteredMammogram.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/DicomMammogramWriter.h"
#include "mammoray/IO/MammogramIO.h"

#include <cstdio>
#include <memory>

namespace mammoray
{
namespace
{
struct DicomOptions
{
  std::string Result;
  std::string Mammogram;
  std::string Laterality;
  DicomPatient Patient;
  bool ForProcessing = false;
  std::string Output;
  bool Overwrite = false;
};

void RunDicom(const DicomOptions& options)
{
  if (!IsDicomPath(options.Output))
  {
    throw InputError(options.Output + ": expected the extension .dcm");
  }
  CheckOutputFile(options.Output, options.Overwrite);
  const DicomIdentity identity = options.Patient.Identity();
  mammoray::Mammogram real = ReadMammogram(CheckInputFile(options.Mammogram));
  real.Laterality = options.Laterality.empty() ? real.Laterality : options.Laterality.front();
  if (real.Laterality == '?')
  {
    throw InputError(options.Mammogram +
      ": expected Image Laterality (0020,0062), found none; --laterality L or R says it");
  }
  const mammoray::Mammogram synthetic = ReadSyntheticMammogram(options.Result, real,
    options.ForProcessing ? mammoray::Mammogram::Intent::ForProcessing
                          : mammoray::Mammogram::Intent::ForPresentation);
  NoteOtherMammogram(options.Result, options.Mammogram);
  DicomMammogramOptions writing;
  writing.Identity = identity;
  writing.Derivation = SyntheticDerivation(options.ForProcessing,
    "a compressed breast that was registered to a mammogram");
  if (options.Patient.Same)
  {
    writing.Imitated = ReadDicomReference(options.Mammogram);
    writing.Identity = writing.Imitated->Identity;
  }
  WriteComplete(options.Output,
    [&](const std::string& temporary) { WriteMammogram(synthetic, writing, temporary); });
  std::printf("wrote %s: %d x %d pixels, %c %s, %.1f mm thick\n", options.Output.c_str(),
    synthetic.Columns, synthetic.Rows, synthetic.Laterality, synthetic.View.c_str(),
    *synthetic.BodyPartThicknessMm);
}
}

void AddDicomCommand(CLI::App& application)
{
  auto options = std::make_shared<DicomOptions>();
  CLI::App* command = application.add_subcommand("dicom",
    "Write the synthetic mammogram of a registration as a DICOM mammogram.\nNothing of the patient "
    "is "
    "taken from --mammogram, and no reference to it, unless --same-patient says so.");
  command->add_option("--result", options->Result, "folder written by 'mammoray register'")
    ->required();
  command
    ->add_option("--mammogram", options->Mammogram,
      "the mammogram that was registered, DICOM MG: view, side and directions are taken from it")
    ->required();
  command
    ->add_option("--laterality", options->Laterality,
      "the breast's side; default: what the header of --mammogram says")
    ->check(CLI::IsMember({ "L", "R" }))
    ->group("DICOM");
  AddDicomPatientOptions(*command, options->Patient, true);
  command
    ->add_flag("--for-processing", options->ForProcessing,
      "store the transmission, linear, instead of a picture For Presentation")
    ->group("DICOM");
  command->add_option("-o,--output", options->Output, "DICOM MG (.dcm)")->required();
  command->add_flag("--overwrite", options->Overwrite, "replace the output file");
  AddConfigurationOptions(*command);
  command->callback([options]() { RunDicom(*options); });
}
}
