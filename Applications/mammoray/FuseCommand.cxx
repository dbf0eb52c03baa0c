// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"
#include "mammoray/Case/CompressedImage.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ProjectionImage.h"

#include "vtkImageData.h"
#include "vtkPointData.h"

#include <cstdio>
#include <memory>

namespace mammoray
{
namespace
{
struct FuseOptions
{
  std::string Result;
  std::string Image;
  bool AxesAsGiven = false;
  double SpacingMm = 1.0;
  std::string Output;
  std::string Projection;
  std::string MaximumPicture;
  std::string MeanPicture;
  bool Overwrite = false;
};

void Fuse(const FuseOptions& options)
{
  if (options.Output.empty() && options.Projection.empty() && options.MaximumPicture.empty() &&
    options.MeanPicture.empty())
  {
    throw InputError("fuse: expected --output, --projection, --maximum-picture or --mean-picture, "
                     "found none");
  }
  for (const std::string* path :
    { &options.Output, &options.Projection, &options.MaximumPicture, &options.MeanPicture })
  {
    if (!path->empty())
    {
      CheckOutputFile(*path, options.Overwrite);
    }
  }
  if (!options.Output.empty())
  {
    CheckLabelVolumeExtension(options.Output);
  }
  if (!options.Projection.empty())
  {
    CheckProjectionExtension(options.Projection);
  }
  const RegisteredBreast breast(options.Result);
  WarnOfDistrust(options.Result);
  const IntensityVolume image = ReadIntensityVolume(options.Image,
    options.AxesAsGiven ? VolumeAxes::AsGiven : VolumeAxes::Patient);
  const ProgressCallback progress = MakeProgressBar();
  const CompressedImage compressed = CompressImage(image, breast, options.SpacingMm, progress);
  const vtkSmartPointer<vtkImageData> projection = ProjectImage(compressed, breast, progress);
  const auto write = [&](const std::string& path, const auto& writer)
  {
    if (!path.empty())
    {
      WriteComplete(path, writer);
      std::printf("wrote %s\n", path.c_str());
    }
  };
  write(options.Output,
    [&](const std::string& temporary) { WriteIntensityVolume(compressed.Image, temporary); });
  write(options.Projection,
    [&](const std::string& temporary) { WriteProjection(projection, temporary); });
  write(options.MaximumPicture,
    [&](const std::string& temporary) { WriteRadiograph(projection, temporary, "Maximum"); });
  write(options.MeanPicture,
    [&](const std::string& temporary) { WriteRadiograph(projection, temporary, "Mean"); });
}
}

void AddFuseCommand(CLI::App& application)
{
  auto options = std::make_shared<FuseOptions>();
  CLI::App* command = application.add_subcommand("fuse",
    "Resample an MRI into the registered, compressed breast and project it on the mammogram");
  command->add_option("--result", options->Result, "folder written by 'mammoray register'")
    ->required();
  command
    ->add_option("--image", options->Image,
      "MRI in the frame of the registered label volume, a contrast-enhanced subtraction for "
      "example (.nrrd .nhdr .mha .mhd .nii .nii.gz, or a folder of DICOM slices)")
    ->required();
  command->add_flag("--axes-as-given", options->AxesAsGiven,
    "take the header's axes of --image as they are, with no conversion to LPS");
  command->add_option("--spacing", options->SpacingMm, "voxels of the compressed image, mm")
    ->check(PositiveNumber())
    ->capture_default_str();
  command->add_option("-o,--output", options->Output,
    "write the image in the compressed breast there (.nrrd .mha .nii.gz), 0 outside");
  command->add_option("--projection", options->Projection,
    "write its maximum and mean along the X-ray of each pixel of the registered mammogram there "
    "(.vti; .mha and .nrrd take the maximum only)");
  command->add_option("--maximum-picture", options->MaximumPicture,
    "write the maximum as a picture (.png) of the mammogram's rows and columns");
  command->add_option("--mean-picture", options->MeanPicture, "write the mean as a picture (.png)");
  command->add_flag("--overwrite", options->Overwrite, "replace the output files");
  AddConfigurationOptions(*command);
  command->callback([options]() { Fuse(*options); });
}
}
