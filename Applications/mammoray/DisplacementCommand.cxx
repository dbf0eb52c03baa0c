// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/CompressedVolume.h"

#include <cstdio>

namespace mammoray
{
namespace
{
struct DisplacementArguments
{
  std::string Result;
  DisplacementDirection Direction = DisplacementDirection::CompressedToVolume;
  double SpacingMm = 2;
  double MarginMm = 10;
  std::string Output;
};

void Declare(const OptionList& add, DisplacementArguments& arguments)
{
  add(Shared::Result, arguments.Result)->required();
  add.Choice("--direction", arguments.Direction,
    { { "compressed-to-volume", DisplacementDirection::CompressedToVolume },
      { "volume-to-compressed", DisplacementDirection::VolumeToCompressed } },
    "which points are moved\n(from the compressed breast to the volume, which resamples the MRI "
    "into that breast; or from the volume, which moves points and meshes into it)");
  add("--spacing", arguments.SpacingMm, Positive("mm"), "voxels of what is written");
  add.Expert()("--margin", arguments.MarginMm, NonNegative("mm"),
    "how far the field reaches beyond the breast\n(there, points move with the nearest tissue)");
  add("-o,--output", arguments.Output,
    "displacement field (.nrrd .mha .nii.gz) or ITK transform (.h5 .tfm)\n(mm, LPS, of points)")
    ->required();
}

void Run(DisplacementArguments& arguments)
{
  CheckDisplacementExtension(arguments.Output);
  CheckOutputFile(arguments.Output);
  const ResultFile result = ReadResultFile(arguments.Result);
  const RegisteredBreast breast(ReadBreastInUnit(result));
  const DisplacementField field = FindDisplacement(breast, arguments.Direction, arguments.SpacingMm,
    arguments.MarginMm, MakeProgressBar());
  WriteDisplacement(field, arguments.Output);
  std::printf("wrote %s: %d x %d x %d voxels\n", arguments.Output.c_str(), field.Size[0],
    field.Size[1], field.Size[2]);
  WarnOfDistrust(result.Folder, result.Trust);
}
}

void AddDisplacementCommand(CLI::App& application)
{
  AddCommand<DisplacementArguments>(application, "displacement",
    "Write the deformation as a displacement field for SimpleITK, elastix, ANTs or 3D Slicer",
    "displacement --result result -o displacement.nrrd", Declare, Run);
}
}
