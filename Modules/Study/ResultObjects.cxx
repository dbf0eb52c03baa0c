// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/ResultObjects.h"

#include "Private/HeaderRules.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/CompressedVolume.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/LesionShadow.h"
#include "mammoray/Study/RegisteredMammogram.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

/// Findings, and the segments of each.
struct Findings
{
  std::vector<DicomFinding> All;
  std::vector<DicomSegment> Segments;
};

/// Semi-axes of the region's ellipse, the major one first, in columns and rows; each at least so
/// long.
std::optional<std::array<std::array<double, 2>, 2>> SemiAxes(const ImagedPoint& imaged,
  const XRayDetector& detector, double leastMm = 0)
{
  if (!imaged.Uncertainty)
  {
    return std::nullopt;
  }
  const UncertaintyEllipse& ellipse = *imaged.Uncertainty;
  const double angle = ellipse.AngleDeg * std::numbers::pi / 180;
  const double width = Norm(detector.ColumnStep);
  const double height = Norm(detector.RowStep);
  const double major = std::max(leastMm, Deviations95 * ellipse.MajorMm);
  const double minor = std::max(leastMm, Deviations95 * ellipse.MinorMm);
  using Axis = std::array<double, 2>;
  return std::array<Axis, 2>{ Axis{ major * std::cos(angle) / width,
                                major * std::sin(angle) / height },
    Axis{ -minor * std::sin(angle) / width, minor * std::cos(angle) / height } };
}

DicomFinding FindingOf(const std::string& label, const Vector3& point, const ImagedPoint& imaged,
  const XRayDetector& detector)
{
  if (!imaged.InImage)
  {
    char text[120];
    std::snprintf(text, sizeof text,
      ": expected a place on the mammogram, found column %.1f and row %.1f", imaged.Column,
      imaged.Row);
    throw InputError(label + text);
  }
  DicomFinding finding;
  finding.Label = label;
  finding.Centre = { imaged.Column, imaged.Row };
  finding.VolumePoint = point;
  if (const auto axes = SemiAxes(imaged, detector))
  {
    DicomFinding::Ellipse ellipse;
    ellipse.MajorSigmaMm = imaged.Uncertainty->MajorMm;
    ellipse.MinorSigmaMm = imaged.Uncertainty->MinorMm;
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      const auto [columns, rows] = (*axes)[axis];
      ellipse.Ends[2 * axis] = { imaged.Column - columns, imaged.Row - rows };
      ellipse.Ends[2 * axis + 1] = { imaged.Column + columns, imaged.Row + rows };
    }
    finding.Uncertainty = ellipse;
  }
  return finding;
}

/// Pixels within the ellipse around one of the mask's pixels.
std::vector<unsigned char> Widened(const std::vector<unsigned char>& mask,
  const std::array<std::array<double, 2>, 2>& axes, const XRayDetector& detector)
{
  const auto& [major, minor] = axes;
  const int reach = 1 +
    static_cast<int>(
      std::ceil(std::max(std::hypot(major[0], minor[0]), std::hypot(major[1], minor[1]))));
  const double determinant = major[0] * minor[1] - major[1] * minor[0];
  // From -half to half columns, in each row around the middle.
  std::vector<std::pair<int, int>> spans(static_cast<std::size_t>(2 * reach + 1), { 1, 0 });
  for (int row = -reach; row <= reach; ++row)
  {
    auto& [first, last] = spans.at(row + reach);
    for (int column = -reach; column <= reach; ++column)
    {
      const double along = (column * minor[1] - row * minor[0]) / determinant;
      const double across = (major[0] * row - major[1] * column) / determinant;
      if (along * along + across * across <= 1)
      {
        first = first > last ? column : first;
        last = column;
      }
    }
  }
  std::vector<unsigned char> widened(mask);
  const auto inside = [&](int column, int row)
  {
    return column >= 0 && row >= 0 && column < detector.Columns && row < detector.Rows &&
      mask[static_cast<std::size_t>(row) * detector.Columns + column] != 0;
  };
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column)
    {
      // Where all neighbours are in the mask, theirs reach as far.
      if (!inside(column, row) ||
        (inside(column - 1, row) && inside(column + 1, row) && inside(column, row - 1) &&
          inside(column, row + 1)))
      {
        continue;
      }
      for (int up = -reach; up <= reach; ++up)
      {
        const auto [first, last] = spans.at(up + reach);
        const int from = std::max(column + first, 0);
        const int to = std::min(column + last, detector.Columns - 1);
        if (row + up >= 0 && row + up < detector.Rows && from <= to)
        {
          const auto start = widened.begin() + std::ptrdiff_t{ row + up } * detector.Columns;
          std::fill(start + from, start + to + 1, static_cast<unsigned char>(1));
        }
      }
    }
  }
  return widened;
}

void AddFinding(Findings& findings, const DicomFinding& finding, std::vector<unsigned char> mask,
  bool shadow, const ImagedPoint& imaged, const XRayDetector& detector)
{
  std::vector<unsigned char> region;
  // An ellipse as narrow as a line would fall between pixels.
  const double leastMm = 0.5 * std::max(Norm(detector.ColumnStep), Norm(detector.RowStep));
  if (const auto axes = SemiAxes(imaged, detector, leastMm))
  {
    region = Widened(mask, *axes, detector);
  }
  if (shadow)
  {
    findings.Segments.push_back({ finding.Label, std::move(mask), false });
  }
  if (!region.empty())
  {
    findings.Segments.push_back(
      { finding.Label + ", where it may be (95 %)", std::move(region), true });
  }
  findings.All.push_back(finding);
}

Findings Find(const RegisteredBreast& breast, const ResultObjects& objects,
  const ProjectorOptions& options)
{
  const XRayDetector detector = breast.Detector();
  const std::size_t pixelCount = detector.NumberOfPixels();
  Findings findings;
  for (std::size_t index = 0; index < objects.Points.size(); ++index)
  {
    const Vector3& point = objects.Points[index];
    const ImagedPoint imaged = breast.ToMammogram(point);
    const DicomFinding finding =
      FindingOf("Point " + std::to_string(index + 1), point, imaged, detector);
    std::vector<unsigned char> mask(pixelCount, 0);
    const auto column = std::clamp(std::lround(imaged.Column), 0L, detector.Columns - 1L);
    const auto row = std::clamp(std::lround(imaged.Row), 0L, detector.Rows - 1L);
    mask[static_cast<std::size_t>(row) * detector.Columns + static_cast<std::size_t>(column)] = 1;
    AddFinding(findings, finding, std::move(mask), false, imaged, detector);
  }
  if (objects.Lesions)
  {
    const auto projector = MakeProjector(options);
    for (const Lesion& found : FindLesions(*objects.Lesions))
    {
      LesionShadow lesion = ProjectLesion(breast, *objects.Lesions, found.Label, *projector);
      DicomFinding finding = FindingOf("Lesion " + std::to_string(found.Label), lesion.Centre,
        lesion.ImagedCentre, detector);
      finding.Outlines = std::move(lesion.Outlines);
      AddFinding(findings, finding, std::move(lesion.Shadow), true, lesion.ImagedCentre, detector);
    }
  }
  return findings;
}

/// What stands beside it on the mammogram.
std::string TextOf(const DicomFinding& finding, Trust trust)
{
  char text[160];
  if (finding.Uncertainty)
  {
    std::snprintf(text, sizeof text, "%s: +-%.1f mm (95 %%, of the parameters), trust: %s",
      finding.Label.c_str(), Deviations95 * finding.Uncertainty->MajorSigmaMm, NameOf(trust));
  }
  else
  {
    std::snprintf(text, sizeof text, "%s: uncertainty not known, trust: %s", finding.Label.c_str(),
      NameOf(trust));
  }
  return text;
}

/// The MRI as the archive has it.
struct DicomMri
{
  DicomHeader Header;
  IntensityVolume Image;
};

DicomMri ReadDicomMri(const std::string& folder, std::optional<int> series,
  const DicomHeader& mammogram)
{
  DicomMri mri;
  mri.Image = ReadMri(folder, VolumeAxes::Patient, series);
  std::optional<DicomHeader> header;
  if (series)
  {
    Study study = ReadStudy(folder);
    header = VolumeOfNumber(study, *series).Header;
  }
  for (fs::directory_iterator entry(folder); !header && entry != fs::directory_iterator(); ++entry)
  {
    header = entry->is_regular_file() ? ReadDicomHeader(entry->path()) : std::nullopt;
  }
  mri.Header = header.value_or(DicomHeader());
  const std::string& patient = mri.Header.Identity.PatientId;
  if (patient != mammogram.Identity.PatientId)
  {
    throw InputError(folder + ": expected the MRI of the mammogram's patient, '" +
      mammogram.Identity.PatientId + "', found that of '" + patient + "'");
  }
  if (mri.Header.FrameOfReferenceUid.empty())
  {
    throw InputError(
      folder + ": expected a Frame of Reference UID (0020,0052) of the MRI, found none");
  }
  return mri;
}

/// Values that 16 bits hold: as they are where they fit, else spread over the range.
std::string FitValues(IntensityVolume& image)
{
  const auto [least, most] = std::minmax_element(image.Voxels.begin(), image.Voxels.end());
  const double low = *least;
  const double high = *most;
  if (low >= 0 && high <= 65535 && (high > 255 || high == 0))
  {
    return {};
  }
  const double factor = high > low ? 4095 / (high - low) : 1;
  for (float& value : image.Voxels)
  {
    value = static_cast<float>(factor * (value - low));
  }
  return " (rescaled)";
}

void WriteMri(const DicomMri& mri, const RegisteredBreast& breast, const ResultObjects& objects,
  const DicomIdentity& identity, const std::string& folder, const ProgressCallback& progress)
{
  const std::string source = mri.Header.FrameOfReferenceUid;
  const std::string registered = NewDicomUid();
  const DisplacementField field = FindDisplacement(breast,
    DisplacementDirection::CompressedToVolume, objects.FieldSpacingMm, 10, progress);
  WriteSpatialRegistration(field, registered, source, identity, folder + "/registration.dcm");
  IntensityVolume image = CompressVolume(mri.Image, breast, objects.MriSpacingMm, progress).Values;
  DicomHeader header = mri.Header;
  header.Identity = identity;
  header.SeriesInstanceUid.clear();
  header.FrameOfReferenceUid = registered;
  header.ImageType = { "DERIVED", "SECONDARY", "MPR" }; // a reformat, which no intake takes
  const std::string remark = FitValues(image);
  header.SeriesDescription =
    ("MRI between the plates" + remark + ": " + header.SeriesDescription).substr(0, 64);
  fs::create_directories(folder + "/mri");
  std::vector<std::string> paths;
  for (int layer = 0; layer < image.Size[2]; ++layer)
  {
    char name[40];
    std::snprintf(name, sizeof name, "/mri/%05d.dcm", layer + 1);
    paths.push_back(folder + name);
  }
  WriteMrSeries(image, header, paths);
}
}

void WriteResultObjects(const ResultFile& result, const RegisteredBreast& breast,
  const ResultObjects& objects, const ProjectorOptions& projector, const std::string& folder,
  const ProgressCallback& progress)
{
  const DicomHeader mammogram = ReadRegisteredReference(objects.Mammogram, breast.Detector());
  std::optional<DicomMri> mri;
  if (!objects.Mri.empty())
  {
    ReportProgress(progress, 0, "reading the MRI");
    mri = ReadDicomMri(objects.Mri, objects.MriSeries, mammogram);
  }
  ReportProgress(progress, 0, "finding lesions");
  const Findings findings = Find(breast, objects, projector);
  if (!findings.All.empty())
  {
    if (!findings.Segments.empty())
    {
      WriteSegmentation(findings.Segments, mammogram, mammogram.Identity, folder + "/lesions.dcm");
    }
    std::vector<std::string> texts;
    for (const DicomFinding& finding : findings.All)
    {
      texts.push_back(TextOf(finding, result.Trust.Level));
    }
    WritePresentationState(findings.All, texts, objects.Mammogram, folder + "/presentation.dcm");
    DicomReportContext context;
    context.Laterality = result.Mammogram.Laterality;
    context.VolumeFrameUid = mri ? mri->Header.FrameOfReferenceUid : std::string();
    context.Trust = NameOf(result.Trust.Level);
    context.Reasons = result.Trust.Reasons;
    WriteMeasurementReport(findings.All, context, mammogram, folder + "/report.dcm");
  }
  if (mri)
  {
    WriteMri(*mri, breast, objects, mammogram.Identity, folder, progress);
  }
}
}
