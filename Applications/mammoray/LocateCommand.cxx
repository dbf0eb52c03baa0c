// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"
#include "DicomOptions.h"
#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/DicomSegmentationWriter.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

namespace mammoray
{
namespace
{
struct LocateOptions
{
  std::string Result;
  std::vector<double> Point;
  std::vector<double> Pixel;
  std::string View;
  std::string Lesion;
  bool AxesAsGiven = false;
  std::string Device;
  double StepMm = 0.25;
  std::string Mammogram;
  DicomPatient Patient;
  std::string Output;
  bool Overwrite = false;
};

void PrintImaged(const Vector3& point, const ImagedPoint& imaged)
{
  std::printf("point       %9.2f %9.2f %9.2f mm, in %s\n", point[0], point[1], point[2],
    imaged.Material.c_str());
  std::printf("compressed  %9.2f %9.2f %9.2f mm\n", imaged.Compressed[0], imaged.Compressed[1],
    imaged.Compressed[2]);
  std::printf("receptor    %9.2f %9.2f mm (gantry x, y)\n", imaged.ReceptorMm[0],
    imaged.ReceptorMm[1]);
  std::printf("pixel       %9.1f %9.1f (column, row, from 0)%s\n", imaged.Column, imaged.Row,
    imaged.InImage ? "" : "; outside the mammogram");
  if (imaged.Uncertainty)
  {
    std::printf("uncertainty %9.2f x %.2f mm (1 sd), %.0f degrees from columns towards rows; of "
                "the parameters only, those held with their priors; the model's own error is not "
                "in it\n",
      imaged.Uncertainty->MajorMm, imaged.Uncertainty->MinorMm, imaged.Uncertainty->AngleDeg);
  }
  else
  {
    std::printf("uncertainty   unknown: the registration has no covariance\n");
  }
}

/// The result of one mammogram, and how its folder is called.
struct NamedBreast
{
  std::string Name;
  RegisteredBreast Breast;
};

/// Each point of the curve, and where the other mammograms show it.
void WriteCurve(const std::vector<TissueStretch>& stretches, const std::vector<NamedBreast>& others,
  const std::string& path)
{
  WriteComplete(path,
    [&](const std::string& temporary)
    {
      std::ofstream file(temporary);
      file << "x_mm,y_mm,z_mm,material";
      for (const NamedBreast& other : others)
      {
        file << ',' << other.Name << "_column," << other.Name << "_row," << other.Name
             << "_sigma_mm";
      }
      file << '\n';
      for (const TissueStretch& stretch : stretches)
      {
        for (const Vector3& point : stretch.Uncompressed)
        {
          file << point[0] << ',' << point[1] << ',' << point[2] << ',' << stretch.Material;
          for (const NamedBreast& other : others)
          {
            const ImagedPoint imaged = other.Breast.ToMammogram(point);
            file << ',' << imaged.Column << ',' << imaged.Row << ',';
            if (imaged.Uncertainty)
            {
              file << imaged.Uncertainty->MajorMm;
            }
          }
          file << '\n';
        }
      }
      if (!file.flush())
      {
        throw InputError(path + ": cannot be written");
      }
    });
}

/// Where another mammogram shows what lies behind the pixel: a line from the side of the source to
/// that of the receptor.
void PrintInOther(const NamedBreast& other, const std::vector<TissueStretch>& stretches)
{
  const ImagedPoint from = other.Breast.ToMammogram(stretches.front().Uncompressed.front());
  const ImagedPoint to = other.Breast.ToMammogram(stretches.back().Uncompressed.back());
  std::printf("in %s: on the line from pixel %.1f %.1f to %.1f %.1f", other.Name.c_str(),
    from.Column, from.Row, to.Column, to.Row);
  if (from.Uncertainty && to.Uncertainty)
  {
    std::printf(", +- %.1f mm (1 sd of that view's parameters)",
      std::max(from.Uncertainty->MajorMm, to.Uncertainty->MajorMm));
  }
  std::printf("\n");
}

void PrintPixel(const RegisteredBreast& breast, const std::vector<NamedBreast>& others,
  const LocateOptions& options)
{
  const std::vector<TissueStretch> stretches =
    breast.ToVolume(options.Pixel[0], options.Pixel[1], options.StepMm);
  if (stretches.empty())
  {
    std::printf("pixel %.1f %.1f: the X-ray misses the breast\n", options.Pixel[0],
      options.Pixel[1]);
  }
  else
  {
    std::printf("%-10s %8s  %-20s  %s\n", "tissue", "length", "height (receptor 0)",
      "uncompressed, from ... to (mm)");
  }
  for (const TissueStretch& stretch : stretches)
  {
    const Vector3& first = stretch.Uncompressed.front();
    const Vector3& last = stretch.Uncompressed.back();
    std::printf("%-10s %5.2f mm  %6.2f to %6.2f mm   %7.2f %7.2f %7.2f to %7.2f %7.2f %7.2f\n",
      stretch.Material.c_str(), stretch.LengthMm, stretch.EntryHeightMm, stretch.ExitHeightMm,
      first[0], first[1], first[2], last[0], last[1], last[2]);
  }
  for (const NamedBreast& other : others)
  {
    if (!stretches.empty())
    {
      PrintInOther(other, stretches);
    }
  }
  if (!options.Output.empty())
  {
    WriteCurve(stretches, others, options.Output);
    std::printf("wrote %s\n", options.Output.c_str());
  }
}

/// Closed polygons, one after the other.
void WriteOutlines(const std::vector<std::pair<int, ImagedLesion>>& lesions,
  const std::string& path)
{
  WriteComplete(path,
    [&](const std::string& temporary)
    {
      std::ofstream file(temporary);
      file << "label,polygon,column,row\n";
      for (const auto& [label, lesion] : lesions)
      {
        for (std::size_t polygon = 0; polygon < lesion.Outlines.size(); ++polygon)
        {
          for (const auto& [column, row] : lesion.Outlines[polygon])
          {
            file << label << ',' << polygon << ',' << column << ',' << row << '\n';
          }
        }
      }
      if (!file.flush())
      {
        throw InputError(path + ": cannot be written");
      }
    });
}

/// The image that a segmentation lies over; it must have the registered pixels.
DicomReference ReadSegmentedImage(const RegisteredBreast& breast, const LocateOptions& options)
{
  const DicomReference image = ReadDicomReference(CheckInputFile(options.Mammogram));
  const XRayDetector detector = breast.Detector();
  if (image.Columns != detector.Columns || image.Rows != detector.Rows)
  {
    throw InputError(options.Mammogram + ": expected the registered mammogram of " +
      std::to_string(detector.Columns) + " x " + std::to_string(detector.Rows) + " pixels, found " +
      std::to_string(image.Columns) + " x " + std::to_string(image.Rows));
  }
  NoteOtherMammogram(options.Result, options.Mammogram);
  return image;
}

/// One segment for each lesion.
void WriteShadows(std::vector<std::pair<int, ImagedLesion>>& lesions, const DicomReference& image,
  const LocateOptions& options)
{
  // The study tells viewers what belongs together; it names nobody.
  DicomIdentity identity = options.Patient.Identity();
  identity.StudyInstanceUid = image.Identity.StudyInstanceUid;
  std::vector<DicomSegment> segments;
  for (auto& [label, lesion] : lesions)
  {
    segments.push_back({ "Lesion " + std::to_string(label), std::move(lesion.Shadow) });
  }
  WriteComplete(options.Output,
    [&](const std::string& temporary)
    {
      WriteSegmentation(segments, image, options.Patient.Same ? image.Identity : identity,
        temporary);
    });
}

/// Every label of the volume is a lesion.
void PrintLesions(const RegisteredBreast& breast, const LocateOptions& options)
{
  std::optional<DicomReference> image;
  if (IsDicomPath(options.Output))
  {
    image = ReadSegmentedImage(breast, options);
  }
  const LabelVolume volume = ReadLabelVolume(options.Lesion,
    options.AxesAsGiven ? VolumeAxes::AsGiven : VolumeAxes::Patient);
  const auto projector = MakeProjector({ .Device = options.Device });
  std::vector<std::pair<int, ImagedLesion>> lesions;
  for (const auto& [label, count] : volume.CountLabels())
  {
    if (label != 0)
    {
      lesions.emplace_back(label, breast.ToMammogram(volume, label, *projector));
    }
  }
  if (lesions.empty())
  {
    throw InputError(options.Lesion + ": expected voxels that are not 0, found none");
  }
  for (const auto& [label, lesion] : lesions)
  {
    std::printf(
      "lesion %d: %.1f mm3, at most %.1f mm thick along an X-ray; shadow %.1f mm2, outlines: "
      "%zu\n",
      label, lesion.VolumeMm3, lesion.LargestThicknessMm, lesion.AreaMm2, lesion.Outlines.size());
    if (lesion.ShareOutside > 0)
    {
      std::printf("%.0f %% of its surface lies outside the breast\n", 100 * lesion.ShareOutside);
    }
    PrintImaged(lesion.Centre, lesion.ImagedCentre);
  }
  if (!options.Output.empty())
  {
    if (image)
    {
      WriteShadows(lesions, *image, options);
    }
    else
    {
      WriteOutlines(lesions, options.Output);
    }
    std::printf("wrote %s\n", options.Output.c_str());
  }
}

/// What a DICOM file needs, and that the options can be written.
void CheckDicomOptions(const LocateOptions& options)
{
  if (!IsDicomPath(options.Output))
  {
    return;
  }
  if (options.Lesion.empty() || options.Mammogram.empty())
  {
    throw InputError("output " + options.Output +
      ": expected --lesion and --mammogram for a DICOM segmentation, found " +
      (options.Lesion.empty() ? "no --lesion" : "no --mammogram"));
  }
  options.Patient.Identity();
}

std::string NamesOf(const std::vector<NamedBreast>& breasts)
{
  std::string names;
  for (const NamedBreast& breast : breasts)
  {
    names += (names.empty() ? "" : ", ") + breast.Name;
  }
  return names;
}

/// In the view that was asked for, or in all.
void PrintPoint(const Vector3& point, const std::optional<NamedBreast>& asked,
  const std::vector<NamedBreast>& others)
{
  if (asked)
  {
    PrintImaged(point, asked->Breast.ToMammogram(point));
  }
  for (const NamedBreast& other : others)
  {
    std::printf("in %s\n", other.Name.c_str());
    PrintImaged(point, other.Breast.ToMammogram(point));
  }
}

void Locate(const LocateOptions& options)
{
  if (!options.Output.empty())
  {
    CheckOutputFile(options.Output, options.Overwrite);
    CheckDicomOptions(options);
  }
  std::vector<NamedBreast> others;
  std::optional<NamedBreast> asked;
  for (const std::string& folder : RegistrationFolders(options.Result))
  {
    const std::string name = std::filesystem::path(folder).filename().string();
    NamedBreast breast{ name, RegisteredBreast(folder) };
    WarnOfDistrust(folder);
    if (folder == options.Result || name == options.View)
    {
      asked.emplace(std::move(breast));
    }
    else
    {
      others.push_back(std::move(breast));
    }
  }
  if (!options.View.empty() && !asked)
  {
    throw InputError("view '" + options.View + "': expected " + NamesOf(others));
  }
  if (asked && !options.Point.empty())
  {
    others.clear(); // of the one view only
  }
  if (!options.Point.empty())
  {
    PrintPoint({ options.Point[0], options.Point[1], options.Point[2] }, asked, others);
    return;
  }
  if (!asked)
  {
    throw InputError("result " + options.Result +
      ": expected --view with the result of several mammograms, one of " + NamesOf(others));
  }
  if (!options.Lesion.empty())
  {
    PrintLesions(asked->Breast, options);
  }
  else
  {
    PrintPixel(asked->Breast, others, options);
  }
}
}

void AddLocateCommand(CLI::App& application)
{
  auto options = std::make_shared<LocateOptions>();
  CLI::App* command = application.add_subcommand("locate",
    "Find a point or a lesion of the volume in the mammogram, or what lies behind a pixel of it");
  command->add_option("--result", options->Result, "folder written by 'mammoray register'")
    ->required();
  command->add_option("--view", options->View,
    "which mammogram, where several were registered together: the name of its folder, such as mlo; "
    "--point without it gives all");
  CLI::Option_group* place = command->add_option_group("place", "what to find; one of");
  place
    ->add_option("--point", options->Point,
      "a place in the frame of the label volume, mm: gives its pixel with an uncertainty ellipse")
    ->expected(3)
    ->type_name("X Y Z");
  place
    ->add_option("--pixel", options->Pixel,
      "column and row of the mammogram, from 0 at the centre of the first pixel: gives the tissues "
      "along its X-ray and the curve through the uncompressed volume")
    ->expected(2)
    ->type_name("COLUMN ROW");
  place->add_option("--lesion", options->Lesion,
    "label volume in the same frame (.nrrd .mha .nii .nii.gz, DICOM SEG): gives the outline of "
    "each "
    "label's shadow, its size, and where its centre is");
  place->require_option(1);
  command->add_flag("--axes-as-given", options->AxesAsGiven,
    "take the header's axes of --lesion as they are, with no conversion to LPS");
  command->add_option("--device", options->Device,
    "part of the name of the Vulkan device that projects --lesion");
  command
    ->add_option("--step", options->StepMm,
      "distance of the curve's points in the compressed breast, mm")
    ->check(PositiveNumber())
    ->capture_default_str();
  command->add_option("-o,--output", options->Output,
    "write the curve of --pixel there (.csv: x_mm,y_mm,z_mm,material, and column, row and sigma_mm "
    "in each of the other mammograms), or the outlines of --lesion "
    "(.csv: label,polygon,column,row), or its shadow as a DICOM segmentation (.dcm)");
  command
    ->add_option("--mammogram", options->Mammogram,
      "the mammogram that was registered, DICOM: a segmentation lies on its pixels and refers to "
      "it by the UIDs of instance, series and study")
    ->group("DICOM");
  AddDicomPatientOptions(*command, options->Patient, true);
  command->add_flag("--overwrite", options->Overwrite, "replace the output file");
  AddConfigurationOptions(*command);
  command->callback([options]() { Locate(*options); });
}
}
