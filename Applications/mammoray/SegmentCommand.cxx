// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OptionList.h"

#ifdef MAMMORAY_HAS_SEGMENTATION
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Segmentation/BreastSegmentation.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/StudyPictures.h"

#include <cstdio>
#include <optional>
#include <string>
#include <vector>
#endif

namespace mammoray
{
#ifdef MAMMORAY_HAS_SEGMENTATION
namespace
{
struct SegmentArguments
{
  std::string Image;
  /// Empty: Image alone.
  std::string Suppressed;
  /// Of folders that hold several volumes: of Image, and of Suppressed or else of Image, too.
  std::vector<int> Series;
  std::string Orientation = "LPS";
  SegmentationOptions Options;
  std::string Output;
  std::string Picture;
};

void Declare(const OptionList& add, SegmentArguments& arguments)
{
  SegmentationOptions& options = arguments.Options;
  add(Shared::Image, arguments.Image)->required();
  add(Shared::Series, arguments.Series);
  add.Input("--suppressed-image", arguments.Suppressed,
    "the MRI of the same session with fat suppression, beside a plain --image\n(chest wall and "
    "gland are found from both)");
  add("-o,--output", arguments.Output,
    "label volume to write, frame and axes of the MRI\n(.seg.nrrd for 3D Slicer, names and colours "
    "within; .nii.gz .mha .nrrd, names and colours beside in a .txt for ITK-SNAP)")
    ->required();
  add("--picture", arguments.Picture, "draw slices of the MRI with the labels' outlines (.png)");
  add(Shared::Orientation, arguments.Orientation);
  add.Choice<BreastSide>("--side", options.Side,
    { { "both", BreastSide::Both }, { "left", BreastSide::Left }, { "right", BreastSide::Right } },
    "the patient's own, cut in the valley between");
  add.Choice<FatContrast>("--contrast", options.Contrast,
    { { "auto", FatContrast::Auto }, { "fat-bright", FatContrast::FatBright },
      { "fat-dark", FatContrast::FatDark } },
    "fat is bright (plain T1) or dark\n(suppressed: SPAIR, SPIR, Dixon water); auto: by DICOM "
    "headers or, without, by the image");
  add(Shared::LabelSpacing, options.SpacingMm);
  const OptionList file = add.CaseFile();
  file("--skin-thickness", options.SkinThicknessMm, "mm",
    "layer below the air that becomes skin, at least a voxel; 0: none");
  file("--classes", options.Classes,
    "intensity classes of the breast, 2 to 5; the brightest (suppressed: the darkest) is fat, the "
    "others are gland");
  file("--gland-threshold", options.GlandThreshold,
    "fraction of fat's intensity below which the breast is gland or, beyond 1, above which it is "
    "(fat-suppressed); 0: by Otsu's method");
  file("--air-threshold", options.AirThreshold,
    "intensity of the MRI below which it is air; 0: by Otsu's method");
  file.FlagOff("--no-bias-correction", options.CorrectBias, "the intensities are even already");
}

void CheckArguments(const SegmentArguments& arguments)
{
  CheckOutputFile(arguments.Output);
  CheckLabelVolumeExtension(arguments.Output);
  if (!HoldsLabelNames(arguments.Output))
  {
    CheckOutputFile(LabelDescriptionOf(arguments.Output));
  }
  CheckPictureFile(arguments.Picture);
  if (arguments.Series.size() > 2)
  {
    throw CLI::ValidationError(
      "--series: expected one or two numbers, found " + std::to_string(arguments.Series.size()));
  }
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
  const bool dark = result.Contrast == FatContrast::FatDark;
  std::printf("%d breast%s; fat is %s; air below %.4g, gland %s %.2f of fat (muscle: %.2f)\n",
    result.Breasts, result.Breasts == 1 ? "" : "s", dark ? "dark" : "bright", result.AirThreshold,
    dark ? "above" : "below", result.GlandThreshold, result.MuscleLevel);
  const BreastMeasures& measures = result.Measures;
  std::printf(
    "breast %.1f cm3, %.1f %% gland; %.0f mm before the chest wall; gland %.2f of muscle\n",
    measures.FatCm3 + measures.GlandCm3 + measures.SkinCm3, 100 * measures.GlandFraction,
    measures.DepthMm, measures.GlandOverMuscle);
  for (const std::string& warning : result.Warnings)
  {
    std::printf("warning: %s\n", warning.c_str());
  }
}

void Run(SegmentArguments& arguments)
{
  CheckArguments(arguments);
  arguments.Options.AcceptUnusual = Program().AcceptUnusual;
  arguments.Options.Axes = AnatomicalAxes::FromCode(arguments.Orientation);
  arguments.Options.Validate();
  const MaterialTable table = FindMaterialTable("segment");
  const VolumeAxes axes = AxesOf(Program().AxesAsGiven);
  const auto numberAt = [&arguments](std::size_t index) {
    return index < arguments.Series.size() ? std::optional(arguments.Series[index]) : std::nullopt;
  };
  const IntensityVolume image = ReadMri(arguments.Image, axes, numberAt(0));
  FatContrast& contrast = arguments.Options.Contrast;
  if (contrast == FatContrast::Auto)
  {
    const FatSuppression fat = FatOfMri(arguments.Image, numberAt(0));
    contrast = fat == FatSuppression::Present ? FatContrast::FatDark
      : fat == FatSuppression::Absent         ? FatContrast::FatBright
                                              : FatContrast::Auto;
  }
  const std::string& suppressed = arguments.Suppressed.empty() && arguments.Series.size() > 1
    ? arguments.Image
    : arguments.Suppressed;
  SegmentationResult result = suppressed.empty()
    ? SegmentBreast(image, arguments.Options, MakeProgressBar())
    : SegmentBreast(image, ReadMri(suppressed, axes, numberAt(1)), arguments.Options,
        MakeProgressBar());
  result.Labels.Names = table.LabelNames();
  WriteLabelVolume(result.Labels, arguments.Output);
  if (!arguments.Picture.empty())
  {
    WriteAtomicFile(arguments.Picture,
      DrawLabelSlices(result.Corrected, result.Labels, arguments.Options.Axes, table.Names()).Png);
  }
  PrintResult(result, table);
}
}

void AddSegmentCommand(CLI::App& application)
{
  AddCommand<SegmentArguments>(application, "segment",
    "A first label volume from a T1-weighted breast MRI: prone, with or without fat "
    "suppression.\nLabels: 0 air, 1 fat, 2 gland, 3 skin, 4 chest wall; the material table "
    "'segment' goes with them.\nLook at --picture before you use it.",
    "segment --image t1-series/ -o labels.seg.nrrd --picture labels.png", Declare, Run);
}
#else
void AddSegmentCommand(CLI::App& application)
{
  AddMissingCommand(application, "segment",
    "Segmentation module (ITK 5 was not found, or "
    "MAMMORAY_BUILD_SEGMENTATION was OFF)");
}
#endif
}
