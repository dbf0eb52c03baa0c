// SPDX-License-Identifier: Apache-2.0
#include "ArchiveOptions.h"
#include "Commands.h"
#include "DicomOptions.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/Study/LesionShadow.h"
#include "mammoray/Study/RegisteredMammogram.h"
#include "mammoray/Study/ResultObjects.h"

#include <cstdio>
#include <filesystem>
#include <optional>

namespace mammoray
{
namespace
{
struct DicomArguments
{
  std::string Result;
  std::string Mammogram;
  std::optional<char> Laterality;
  bool SamePatient = false;
  bool ForProcessing = false;
  std::optional<Vector3> Point;
  std::string Lesion;
  std::string Mri;
  std::optional<int> Series;
  std::string Output;
};

void Declare(const OptionList& add, DicomArguments& arguments)
{
  add(Shared::Result, arguments.Result)->required();
  add.File("--mammogram", arguments.Mammogram, RegisteredMammogramHelp)->required();
  AddDicomPictureOptions(add, arguments.Laterality, arguments.ForProcessing);
  AddSamePatientFlag(add.Group("DICOM"), arguments.SamePatient);
  const OptionList shown = add.Group("Of a folder");
  shown(Shared::Point, arguments.Point);
  shown(Shared::Lesion, arguments.Lesion);
  CLI::Option* const mri = shown.Input("--mri", arguments.Mri,
    "folder with the MRI's DICOM slices: adds it between the plates\n(in the frame of the label "
    "volume; and the registration that leads to it)");
  shown(Shared::Series, arguments.Series)->needs(mri);
  add("-o,--output", arguments.Output,
    "the synthetic mammogram (.dcm) or a new folder for all objects\n(default: the folder dicom in "
    "that of --result)");
}

/// Returns what it wrote.
std::string WriteSynthetic(const DicomArguments& arguments, const ResultFile& result,
  const std::string& path)
{
  const Mammogram& searched = result.Mammogram;
  Mammogram real = ReadMammogram(arguments.Mammogram,
    { searched.ColumnSpacingMm, searched.View, searched.Laterality });
  real.Laterality = arguments.Laterality.value_or(real.Laterality);
  if (real.Laterality == '?')
  {
    throw InputError(arguments.Mammogram +
      ": expected Image Laterality (0020,0062), found none; --side left or right says it");
  }
  const Mammogram synthetic = ReadSyntheticMammogram(result, real,
    arguments.ForProcessing ? Mammogram::Intent::ForProcessing
                            : Mammogram::Intent::ForPresentation);
  NoteOtherMammogram(result, arguments.Mammogram);
  DicomMammogramOptions writing;
  writing.Derivation = SyntheticDerivation(arguments.ForProcessing,
    "a compressed breast that was registered to a mammogram");
  if (arguments.SamePatient)
  {
    writing.Imitated = ReadMammogramHeader(arguments.Mammogram);
    writing.Identity = writing.Imitated->Identity;
  }
  WriteMammogram(synthetic, writing, path);
  char text[80];
  std::snprintf(text, sizeof text, "%d x %d pixels, %c %s, %.1f mm thick", synthetic.Columns,
    synthetic.Rows, synthetic.Laterality, synthetic.View.c_str(), *synthetic.BodyPartThicknessMm);
  return text;
}

/// All of them lie in the mammogram's study, or could not refer to it.
void WriteFolder(const DicomArguments& arguments, const ResultFile& result)
{
  ResultObjects objects;
  objects.Mammogram = arguments.Mammogram;
  if (arguments.Point)
  {
    objects.Points.push_back(*arguments.Point);
  }
  if (!arguments.Lesion.empty())
  {
    objects.Lesions = ReadLesions(arguments.Lesion, AxesOf(Program().AxesAsGiven));
  }
  objects.Mri = arguments.Mri;
  objects.MriSeries = arguments.Series;
  const RegisteredBreast breast(ReadBreastInUnit(result));
  std::string synthetic;
  WriteAtomicFolder(arguments.Output,
    [&](const std::string& folder)
    {
      synthetic = WriteSynthetic(arguments, result, folder + "/synthetic.dcm");
      WriteResultObjects(result, breast, objects, Program().Projector, folder, MakeProgressBar());
    });
  std::printf("wrote %s: %s\n", arguments.Output.c_str(), synthetic.c_str());
}

void Run(DicomArguments& arguments)
{
  const bool alone = IsDicomPath(arguments.Output);
  if (!alone && std::filesystem::path(arguments.Output).has_extension())
  {
    throw InputError(
      arguments.Output + ": expected the extension .dcm of a file, or none of a folder");
  }
  if (alone && (arguments.Point || !arguments.Lesion.empty() || !arguments.Mri.empty()))
  {
    throw InputError(arguments.Output + ": expected a folder for --point, --lesion and --mri");
  }
  if (!alone && !arguments.SamePatient)
  {
    throw InputError("output: expected --same-patient for a folder of objects, which refer to the "
                     "mammogram, or a file (.dcm) for the synthetic one alone");
  }
  if (alone)
  {
    CheckOutputFile(arguments.Output);
  }
  const ResultFile result = ReadResultFile(arguments.Result);
  if (alone)
  {
    const std::string synthetic = WriteSynthetic(arguments, result, arguments.Output);
    std::printf("wrote %s: %s\n", arguments.Output.c_str(), synthetic.c_str());
  }
  else
  {
    if (arguments.Output.empty())
    {
      arguments.Output = (std::filesystem::path(result.Folder) / ObjectsFolderName).string();
    }
    ReserveEmptyFolder(arguments.Output);
    WriteFolder(arguments, result);
  }
  WarnOfDistrust(result.Folder, result.Trust);
}
}

void AddDicomCommand(CLI::App& application)
{
  AddCommand<DicomArguments>(application, "dicom",
    "Write a registration as DICOM objects\nThe synthetic mammogram, and in a folder also where a "
    "point or a lesion is found (segmentation, presentation state, report) and the MRI between the "
    "plates. Nothing of the patient is taken from --mammogram, and no reference to it, unless "
    "--same-patient says so.",
    "dicom --result result --mammogram mg.dcm -o synthetic.dcm", Declare, Run);
}
}
