// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#ifdef MAMMORAY_HAS_SEGMENTATION
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Report/SlicePicture.h"
#include "mammoray/Segmentation/BreastSegmentation.h"

#include <cstdio>
#include <map>
#include <memory>
#endif

namespace mammoray
{
#ifdef MAMMORAY_HAS_SEGMENTATION
namespace
{
struct SegmentArguments
{
  std::string Image;
  bool AxesAsGiven = false;
  std::string Orientation = "LPS";
  SegmentationOptions Options;
  bool NoBiasCorrection = false;
  std::string Side = "both";
  std::string Output;
  std::string Picture;
  bool Overwrite = false;
};

void CheckArguments(const SegmentArguments& arguments)
{
  CheckOutputFile(arguments.Output, arguments.Overwrite);
  CheckLabelVolumeExtension(arguments.Output);
  CheckPictureFile(arguments.Picture, arguments.Overwrite);
}

void PrintResult(const SegmentationResult& result, const MaterialTable& table)
{
  std::printf("%-12s %6s %12s\n", "tissue", "label", "[cm3]");
  for (const auto& [label, count] : result.Labels.CountLabels())
  {
    if (label != 0)
    {
      const int material = table.MaterialOfLabel.at(label);
      std::printf("%-12s %6d %12.1f\n",
        table.Materials[static_cast<std::size_t>(material)].Name.c_str(), label,
        static_cast<double>(count) * result.Labels.VoxelVolume() / 1000);
    }
  }
  std::printf("%d breast%s; air below %.4g, gland below %.2f of fat (muscle: %.2f)\n",
    result.Breasts, result.Breasts == 1 ? "" : "s", result.AirThreshold, result.GlandThreshold,
    result.MuscleLevel);
}

void RunSegment(SegmentArguments arguments)
{
  CheckArguments(arguments);
  static const std::map<std::string, BreastSide> sides = { { "both", BreastSide::Both },
    { "left", BreastSide::Left }, { "right", BreastSide::Right } };
  arguments.Options.Side = sides.at(arguments.Side);
  arguments.Options.CorrectBias = !arguments.NoBiasCorrection;
  arguments.Options.Axes = AnatomicalAxes::FromCode(arguments.Orientation);
  arguments.Options.Validate();
  const MaterialTable table = FindMaterialTable("segment");
  const SegmentationResult result =
    SegmentBreast(ReadIntensityVolume(arguments.Image,
                    arguments.AxesAsGiven ? VolumeAxes::AsGiven : VolumeAxes::Patient),
      arguments.Options, MakeProgressBar());
  WriteComplete(arguments.Output,
    [&](const std::string& temporary) { WriteLabelVolume(result.Labels, temporary); });
  if (!arguments.Picture.empty())
  {
    WriteComplete(arguments.Picture,
      [&](const std::string& temporary)
      {
        WriteSlicePicture(result.Corrected, result.Labels, arguments.Options.Axes, table.Names(),
          temporary);
      });
  }
  PrintResult(result, table);
}
}

void AddSegmentCommand(CLI::App& application)
{
  CLI::App* command = application.add_subcommand("segment",
    "A first label volume from a plain T1-weighted breast MRI: prone, fat bright (no fat "
    "suppression).\nLabels: 0 air, 1 fat, 2 gland, 3 skin, 4 chest wall; the material table "
    "'segment' goes with them.\nLook at --picture before you use it.");
  auto arguments = std::make_shared<SegmentArguments>();
  SegmentationOptions& options = arguments->Options;
  command
    ->add_option("--image", arguments->Image,
      "MRI: a folder with a DICOM series, .nrrd .nhdr .mha .mhd .nii .nii.gz")
    ->required();
  command
    ->add_option("-o,--output", arguments->Output,
      "label volume to write (.nrrd .mha .nii.gz), frame and axes of the MRI")
    ->required();
  command->add_option("--picture", arguments->Picture,
    "draw slices of the MRI in three planes with the labels' outlines there (.png)");
  command
    ->add_option("--orientation", arguments->Orientation,
      "directions of the volume's axes: L/R, A/P, S/I, e.g. LPS (DICOM) or ALS (FDA phantoms)")
    ->capture_default_str();
  command->add_flag("--axes-as-given", arguments->AxesAsGiven,
    "take the header's axes as they are, with no conversion to LPS");
  command
    ->add_option("--side", arguments->Side,
      "the patient's own left or right breast, or both; cut in the middle of the valley between")
    ->check(CLI::IsMember({ "both", "left", "right" }))
    ->capture_default_str();
  const auto add = [&](const char* name, auto& value, const char* help)
  { command->add_option(name, value, help)->capture_default_str(); };
  add("--spacing", options.SpacingMm,
    "cubic voxels of the result, mm; 0 keeps the grid of the MRI");
  add("--skin-thickness", options.SkinThicknessMm,
    "layer below the air that becomes skin, mm, at least a voxel; 0: none");
  add("--chest-wall-depth", options.ChestWallDepthMm,
    "how far the result reaches behind the front of the chest wall, mm");
  add("--classes", options.Classes,
    "intensity classes of the breast, 2 to 5; the brightest is fat, the others are gland");
  add("--gland-threshold", options.GlandThreshold,
    "fraction of fat's intensity below which the breast is gland; 0: by Otsu's method");
  add("--air-threshold", options.AirThreshold,
    "intensity of the MRI below which it is air; 0: by Otsu's method");
  add("--smallest-gland", options.SmallestGlandMm3, "smaller parts of gland become fat, mm3");
  command->add_flag("--no-bias-correction", arguments->NoBiasCorrection,
    "the intensities are even already");
  command->add_flag("--overwrite", arguments->Overwrite, "replace output files");
  AddConfigurationOptions(*command);
  command->callback([arguments] { RunSegment(*arguments); });
}
#else
void AddSegmentCommand(CLI::App& application)
{
  CLI::App* command =
    application.add_subcommand("segment", "Not in this build (no Segmentation module).");
  command->allow_extras();
  command->callback(
    []
    {
      throw InputError("segment: this build has no Segmentation module (ITK 5 was not found, or "
                       "MAMMORAY_BUILD_SEGMENTATION was OFF)");
    });
}
#endif
}
