// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "DicomOptions.h"
#include "OutputFiles.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/LesionShadow.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegisteredMammogram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <sstream>
#include <vector>

namespace mammoray
{
namespace
{
struct LocateArguments
{
  std::string Result;
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  /// VIEW=COLUMN,ROW
  std::string Also;
  std::string View;
  std::string Lesion;
  std::string Mammogram;
  bool SamePatient = false;
  std::string Output;
};

void Declare(const OptionList& add, LocateArguments& arguments)
{
  add(Shared::Result, arguments.Result)->required();
  add("--view", arguments.View,
    "name of a mammogram's folder, such as mlo, where there are several\n(--point without it gives "
    "all)");
  const OptionList place = add.OneOf("What to find, one of");
  place(Shared::Point, arguments.Point);
  place(Shared::Pixel, arguments.Pixel);
  place(Shared::Lesion, arguments.Lesion);
  add("--also", arguments.Also,
    "VIEW=COLUMN,ROW: where another mammogram shows what --pixel does\n(mlo=640,710: gives the one "
    "place in the volume that is behind both)");
  add("-o,--output", arguments.Output,
    "curve of --pixel (.csv), outlines of --lesion (.csv) or its shadow (.dcm)\n(x_mm,y_mm,z_mm,"
    "material, and column, row and sigma_mm in each of the other mammograms; "
    "label,polygon,column,row; a DICOM segmentation)");
  add.Group("DICOM").File("--mammogram", arguments.Mammogram, RegisteredMammogramHelp);
  AddSamePatientFlag(add.Group("DICOM"), arguments.SamePatient);
}

void PrintImaged(const Vector3& point, const ImagedPoint& imaged)
{
  std::printf("point       %9.2f %9.2f %9.2f mm, in %s\n", point[0], point[1], point[2],
    imaged.Material.c_str());
  std::printf("compressed  %9.2f %9.2f %9.2f mm\n", imaged.Compressed[0], imaged.Compressed[1],
    imaged.Compressed[2]);
  std::printf("receptor    %9.2f %9.2f mm (gantry x, y)\n", imaged.ReceptorMm[0],
    imaged.ReceptorMm[1]);
  std::printf("pixel       %9.1f %9.1f (column, row, from 0)%s\n", imaged.Column, imaged.Row,
    imaged.InImage               ? ""
      : imaged.ReceptorMm[1] < 0 ? "; behind the receptor's edge, where no mammogram shows it"
                                 : "; outside the mammogram");
  if (imaged.Uncertainty)
  {
    const std::array<double, 9>& covariance = *imaged.Covariance;
    std::printf("uncertainty %9.2f x %.2f mm (1 sd), %.0f degrees from columns towards rows\n",
      imaged.Uncertainty->MajorMm, imaged.Uncertainty->MinorMm, imaged.Uncertainty->AngleDeg);
    std::printf("in 3D       %9.2f %9.2f %9.2f mm (1 sd, gantry x, y, z)\n",
      std::sqrt(covariance[0]), std::sqrt(covariance[4]), std::sqrt(covariance[8]));
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
  ResultFile Result;
  RegisteredBreast Breast;
};

/// Writes each point of the curve and where the other mammograms show it.
void WriteCurve(const std::vector<RaySegment>& segments, const std::vector<NamedBreast>& others,
  const std::string& path)
{
  std::ostringstream file;
  file << "x_mm,y_mm,z_mm,material";
  for (const NamedBreast& other : others)
  {
    file << ',' << other.Name << "_column," << other.Name << "_row," << other.Name << "_sigma_mm";
  }
  file << '\n';
  for (const RaySegment& segment : segments)
  {
    for (const Vector3& point : segment.Uncompressed)
    {
      file << point[0] << ',' << point[1] << ',' << point[2] << ',' << segment.Material;
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
  WriteAtomicFile(path, file.str());
}

/// Prints where another mammogram shows what lies behind the pixel: a line from the side of the
/// source to that of the receptor.
void PrintInOther(const NamedBreast& other, const std::vector<RaySegment>& segments)
{
  const ImagedPoint from = other.Breast.ToMammogram(segments.front().Uncompressed.front());
  const ImagedPoint to = other.Breast.ToMammogram(segments.back().Uncompressed.back());
  std::printf("in %s: on the line from pixel %.1f %.1f to %.1f %.1f", other.Name.c_str(),
    from.Column, from.Row, to.Column, to.Row);
  if (from.Uncertainty && to.Uncertainty)
  {
    std::printf(", +- %.1f mm (1 sd)",
      std::max(from.Uncertainty->MajorMm, to.Uncertainty->MajorMm));
  }
  std::printf("\n");
}

void PrintPixel(const RegisteredBreast& breast, const std::vector<NamedBreast>& others,
  const LocateArguments& arguments)
{
  const auto [column, row] = *arguments.Pixel;
  const std::vector<RaySegment> segments = breast.ToVolume(column, row);
  if (!arguments.Output.empty())
  {
    WriteCurve(segments, others, arguments.Output);
  }
  if (segments.empty())
  {
    std::printf("pixel %.1f %.1f: the X-ray misses the breast\n", column, row);
  }
  else
  {
    std::printf("%-10s %8s  %-20s  %s\n", "tissue", "length", "height (receptor 0)",
      "uncompressed, from ... to (mm)");
  }
  for (const RaySegment& segment : segments)
  {
    const Vector3& first = segment.Uncompressed.front();
    const Vector3& last = segment.Uncompressed.back();
    std::printf("%-10s %5.2f mm  %6.2f to %6.2f mm   %7.2f %7.2f %7.2f to %7.2f %7.2f %7.2f\n",
      segment.Material.c_str(), segment.LengthMm, segment.EntryHeightMm, segment.ExitHeightMm,
      first[0], first[1], first[2], last[0], last[1], last[2]);
  }
  for (const NamedBreast& other : others)
  {
    if (!segments.empty())
    {
      PrintInOther(other, segments);
    }
  }
  if (!arguments.Output.empty())
  {
    std::printf("wrote %s\n", arguments.Output.c_str());
  }
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

/// The pixel of another view that --also names; nullopt where it is not given.
std::optional<SeenInView> AlsoAsked(const std::vector<NamedBreast>& others,
  const LocateArguments& arguments)
{
  if (arguments.Also.empty())
  {
    return std::nullopt;
  }
  const auto [view, place] =
    SplitAssignment(arguments.Also, "--also", "VIEW=COLUMN,ROW, for example mlo=640,710");
  std::array<double, 2> pixel{};
  int end = 0;
  if (std::sscanf(place.c_str(), "%lf,%lf%n", &pixel[0], &pixel[1], &end) != 2 ||
    static_cast<std::size_t>(end) != place.size() || !std::isfinite(pixel[0] + pixel[1]))
  {
    throw InputError("--also: expected VIEW=COLUMN,ROW, for example mlo=640,710, found '" +
      EscapeControls(arguments.Also) + "'");
  }
  const auto other = std::find_if(others.begin(), others.end(),
    [&view = view](const NamedBreast& each) { return each.Name == view; });
  if (other == others.end())
  {
    throw InputError("--also: expected one of the result's other views, " + NamesOf(others) +
      ", found '" + EscapeControls(view) + "'");
  }
  return SeenInView{ &other->Breast, pixel };
}

void PrintInBoth(const std::optional<TissueInTwoViews>& found)
{
  if (!found)
  {
    std::printf("behind both: nothing; an X-ray misses the breast\n");
    return;
  }
  const Vector3& point = found->Point;
  std::printf("behind both: %.2f %.2f %.2f mm; the X-rays' tissue passes each other by %.1f mm "
              "there\n",
    point[0], point[1], point[2], found->GapMm);
}

/// Writes closed polygons, one after the other.
void WriteOutlines(const std::vector<std::pair<int, LesionShadow>>& lesions,
  const std::string& path)
{
  std::ostringstream file;
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
  WriteAtomicFile(path, file.str());
}

/// Writes one segment for each lesion.
void WriteShadows(std::vector<std::pair<int, LesionShadow>>& lesions, const DicomHeader& image,
  const LocateArguments& arguments)
{
  // Viewers group objects by study; its UID names nobody.
  DicomIdentity identity;
  identity.StudyInstanceUid = image.Identity.StudyInstanceUid;
  std::vector<DicomSegment> segments;
  segments.reserve(lesions.size());
  for (auto& [label, lesion] : lesions)
  {
    segments.push_back({ "Lesion " + std::to_string(label), std::move(lesion.Shadow) });
  }
  WriteSegmentation(segments, image, arguments.SamePatient ? image.Identity : identity,
    arguments.Output);
}

/// Every label of the volume is a lesion.
void PrintLesions(const NamedBreast& registered, const LocateArguments& arguments)
{
  std::optional<DicomHeader> image;
  if (IsDicomPath(arguments.Output))
  {
    image = ReadRegisteredReference(arguments.Mammogram, registered.Breast.Detector());
    NoteOtherMammogram(registered.Result, arguments.Mammogram);
  }
  const LabelVolume volume = ReadLesions(arguments.Lesion, AxesOf(Program().AxesAsGiven));
  const auto projector = MakeProjector(Program().Projector);
  std::vector<std::pair<int, LesionShadow>> lesions;
  for (const Lesion& found : FindLesions(volume))
  {
    lesions.emplace_back(found.Label,
      ProjectLesion(registered.Breast, volume, found.Label, *projector));
  }
  if (image)
  {
    WriteShadows(lesions, *image, arguments);
  }
  else if (!arguments.Output.empty())
  {
    WriteOutlines(lesions, arguments.Output);
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
  if (!arguments.Output.empty())
  {
    std::printf("wrote %s\n", arguments.Output.c_str());
  }
}

/// Throws InputError unless a DICOM segmentation has its lesion and its mammogram.
void CheckDicomOptions(const LocateArguments& arguments)
{
  if (!IsDicomPath(arguments.Output))
  {
    return;
  }
  if (arguments.Lesion.empty() || arguments.Mammogram.empty())
  {
    throw InputError("output " + arguments.Output +
      ": expected --lesion and --mammogram for a DICOM segmentation, found " +
      (arguments.Lesion.empty() ? "no --lesion" : "no --mammogram"));
  }
}

/// Prints where the point lies in the chosen view, or in all.
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

void Run(LocateArguments& arguments)
{
  if (!arguments.Also.empty() && !arguments.Pixel)
  {
    throw InputError("--also: expected --pixel beside it, found none");
  }
  if (!arguments.Output.empty())
  {
    CheckOutputFile(arguments.Output);
    CheckDicomOptions(arguments);
  }
  std::vector<NamedBreast> others;
  std::optional<NamedBreast> asked;
  const std::vector<ResultFile> results = ReadResultFiles(arguments.Result);
  for (const ResultFile& result : results)
  {
    const std::string name = std::filesystem::path(result.Folder).filename().string();
    NamedBreast breast{ name, result, RegisteredBreast(ReadBreastInUnit(result)) };
    if (result.Folder == arguments.Result || name == arguments.View)
    {
      asked.emplace(std::move(breast));
    }
    else
    {
      others.push_back(std::move(breast));
    }
  }
  if (!arguments.View.empty() && !asked)
  {
    throw InputError("view '" + arguments.View + "': expected " + NamesOf(others));
  }
  if (!asked && !arguments.Point)
  {
    throw InputError("result " + arguments.Result +
      ": expected --view with the result of several mammograms, one of " + NamesOf(others));
  }
  if (arguments.Point)
  {
    if (asked)
    {
      others.clear(); // --view restricts the answer to one view
    }
    PrintPoint(*arguments.Point, asked, others);
  }
  else if (!arguments.Lesion.empty())
  {
    PrintLesions(*asked, arguments);
  }
  else
  {
    const std::optional<SeenInView> also = AlsoAsked(others, arguments);
    const std::optional<TissueInTwoViews> both =
      also ? FindInTwoViews({ &asked->Breast, *arguments.Pixel }, *also) : std::nullopt;
    PrintPixel(asked->Breast, others, arguments);
    if (also)
    {
      PrintInBoth(both);
    }
  }
  for (const ResultFile& result : results)
  {
    WarnOfDistrust(result.Folder, result.Trust);
  }
}
}

void AddLocateCommand(CLI::App& application)
{
  AddCommand<LocateArguments>(application, "locate",
    "Find a point or a lesion of the volume in the mammogram, or what lies behind a pixel of it",
    "locate --result result --point 30 12 -10", Declare, Run);
}
}
