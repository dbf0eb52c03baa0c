// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/Study/CompressedVolume.h"
#include "mammoray/Study/Intake.h"

#include "vtkImageData.h"
#include "vtkPointData.h"

#include <cstdio>
#include <optional>

namespace mammoray
{
namespace
{
struct FuseArguments
{
  std::string Result;
  std::string Image;
  std::optional<int> Series;
  double SpacingMm = 1.0;
  std::string Output;
  std::string Projection;
  std::string MaximumPicture;
  std::string MeanPicture;
};

void Declare(const OptionList& add, FuseArguments& arguments)
{
  add(Shared::Result, arguments.Result)->required();
  add(Shared::Image, arguments.Image)->required();
  add(Shared::Series, arguments.Series);
  add("--spacing", arguments.SpacingMm, Positive("mm"), "voxels of what is written");
  add("-o,--output", arguments.Output,
    "the image in the compressed breast (.nrrd .mha .nii.gz), 0 outside");
  add("--projection", arguments.Projection,
    "its maximum and mean along the X-ray of each pixel (.vti .mha .nrrd)\n(of the registered "
    "mammogram; .mha and .nrrd take the maximum only)");
  add("--maximum-picture", arguments.MaximumPicture,
    "the maximum as a picture (.png) of the mammogram's rows and columns");
  add("--mean-picture", arguments.MeanPicture, "the mean as such a picture (.png)");
}

void Run(FuseArguments& arguments)
{
  if (arguments.Output.empty() && arguments.Projection.empty() &&
    arguments.MaximumPicture.empty() && arguments.MeanPicture.empty())
  {
    throw InputError("fuse: expected --output, --projection, --maximum-picture or --mean-picture, "
                     "found none");
  }
  if (!arguments.Output.empty())
  {
    CheckOutputFile(arguments.Output);
    CheckLabelVolumeExtension(arguments.Output);
  }
  if (!arguments.Projection.empty())
  {
    CheckOutputFile(arguments.Projection);
    CheckProjectionExtension(arguments.Projection);
  }
  CheckPictureFile(arguments.MaximumPicture);
  CheckPictureFile(arguments.MeanPicture);
  if (!Program().AcceptUnusual)
  {
    CheckValidRange(ValidRanges::VoxelSpacing, arguments.SpacingMm, "SpacingMm");
  }
  const ResultFile result = ReadResultFile(arguments.Result);
  const RegisteredBreast breast(ReadBreastInUnit(result));
  const IntensityVolume image =
    ReadMri(arguments.Image, AxesOf(Program().AxesAsGiven), arguments.Series);
  if (!Program().AcceptUnusual)
  {
    CheckValidRange(ValidRanges::VoxelSpacing, image.Spacing, arguments.Image);
  }
  const ProgressCallback progress = MakeProgressBar();
  const CompressedVolume compressed =
    CompressVolume(image, breast, arguments.SpacingMm, ShareOf(progress, 0, 0.4));
  const vtkSmartPointer<vtkImageData> projection =
    ProjectVolume(compressed, breast, ShareOf(progress, 0.4, 1));
  ReportProgress(progress, 1.0, "done"); // ends the bar before what follows
  const auto write = [](const std::string& path, const auto& writer)
  {
    if (!path.empty())
    {
      writer(path);
      std::printf("wrote %s\n", path.c_str());
    }
  };
  write(arguments.Output,
    [&](const std::string& path) { WriteIntensityVolume(compressed.Values, path); });
  write(arguments.Projection, [&](const std::string& path) { WriteProjection(projection, path); });
  write(arguments.MaximumPicture,
    [&](const std::string& path) { WriteRadiograph(projection, path, "Maximum"); });
  write(arguments.MeanPicture,
    [&](const std::string& path) { WriteRadiograph(projection, path, "Mean"); });
  WarnOfDistrust(result.Folder, result.Trust);
}
}

void AddFuseCommand(CLI::App& application)
{
  AddCommand<FuseArguments>(application, "fuse",
    "Resample an MRI into the registered, compressed breast and project it on the mammogram",
    "fuse --result result --image t1-series/ -o compressed.nrrd --maximum-picture maximum.png",
    Declare, Run);
}
}
