// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Dicom/DicomReader.h"

#include "Private/DicomFile.h"
#include "Private/DicomFrames.h"
#include "Private/DicomPixels.h"
#include "Private/MammogramViews.h"
#include "Private/SourcePlace.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <utility>

namespace mammoray
{
/// Passes every member of a mammogram between a reader's process and this one.
static void Exchange(Parcel& parcel, Mammogram& mammogram)
{
  parcel(mammogram.Columns, mammogram.Rows, mammogram.Pixels, mammogram.InvertedForDisplay,
    mammogram.PresentationIntent, mammogram.IntensityRelationship, mammogram.IntensitySign,
    mammogram.BitsStored, mammogram.ColumnSpacingMm, mammogram.RowSpacingMm, mammogram.View,
    mammogram.Laterality, mammogram.RowDirection, mammogram.ColumnDirection,
    mammogram.BodyPartThicknessMm, mammogram.PositionerPrimaryAngleDeg,
    mammogram.SourceToDetectorMm, mammogram.SourceToPatientMm, mammogram.PeakKilovoltage,
    mammogram.AnodeMaterial, mammogram.FilterMaterial, mammogram.SourceFootPixel);
}

namespace
{
[[noreturn]] void Refuse(const std::string& path, const std::string& why)
{
  throw InputError(path + ": " + why);
}

std::optional<double> PositiveNumber(DcmItem& data, const DcmTagKey& tag, unsigned long index = 0)
{
  const std::optional<double> value = DicomNumber(data, tag, index);
  return value && *value > 0 ? value : std::nullopt;
}

/// Terms of the standard only are taken, since they are shown in reports: what somebody else wrote
/// in their place may be anything of the patient. CC, MLO, AT and the like.
std::string ViewTerm(const std::string& view)
{
  const bool isCode = view.size() <= 4 &&
    std::all_of(view.begin(), view.end(),
      [](char letter) { return letter >= 'A' && letter <= 'Z'; });
  return isCode ? view : "OTHER";
}

/// Letters of Patient Orientation; nothing of what is none.
std::string DirectionTerm(const std::string& direction)
{
  return direction.find_first_not_of("LRAPHF") == std::string::npos ? direction : "";
}

/// A metal of an anode or a filter (PS3.3, C.8.11.7 and CID 10006).
std::string MetalTerm(const std::string& metal)
{
  constexpr std::array<const char*, 12> known{ "", "MOLYBDENUM", "RHODIUM", "TUNGSTEN", "ALUMINUM",
    "COPPER", "SILVER", "NIOBIUM", "EUROPIUM", "LEAD", "TIN", "TITANIUM" };
  return std::find(known.begin(), known.end(), metal) != known.end() ? metal : "OTHER";
}

/// Reads the description of the breast and the unit.
void ReadAcquisition(DcmItem& data, Mammogram& mammogram)
{
  mammogram.View = ViewTerm(MammogramViewOf(data));
  mammogram.Laterality = MammogramLaterality(data);
  mammogram.RowDirection = DirectionTerm(DicomText(data, DCM_PatientOrientation, 0));
  mammogram.ColumnDirection = DirectionTerm(DicomText(data, DCM_PatientOrientation, 1));
  mammogram.BodyPartThicknessMm = PositiveNumber(data, DCM_BodyPartThickness);
  mammogram.PositionerPrimaryAngleDeg = DicomNumber(data, DCM_PositionerPrimaryAngle);
  mammogram.SourceToDetectorMm = PositiveNumber(data, DCM_DistanceSourceToDetector);
  mammogram.SourceToPatientMm = PositiveNumber(data, DCM_DistanceSourceToPatient);
  mammogram.PeakKilovoltage = PositiveNumber(data, DCM_KVP);
  mammogram.AnodeMaterial = MetalTerm(DicomText(data, DCM_AnodeTargetMaterial));
  mammogram.FilterMaterial = MetalTerm(DicomText(data, DCM_FilterMaterial));
}

/// Names all that is missing at once, with what supplies it.
[[noreturn]] void RefuseSpacing(const Mammogram& mammogram, const PictureDescription& given,
  const std::string& path, const std::string& why)
{
  std::string others;
  std::vector<std::string> fields{ "PixelSpacingMm" };
  const auto need = [&](bool known, const char* element, const char* field)
  {
    if (!known)
    {
      others += (others.empty() ? "; missing, too: " : ", ") + std::string(element);
      fields.emplace_back(field);
    }
  };
  need(!mammogram.View.empty(), "the view (0018,5101)", "View");
  need(mammogram.Laterality != '?', "the side (0020,0062)", "Laterality");
  need(mammogram.BodyPartThicknessMm || given.ThicknessMm, "the thickness (0018,11A0)",
    "ThicknessMm");
  throw InputError(path + ": " + why + others, { "PixelSpacingMm", "", fields, true });
}

/// Reads the distances of pixels at the receptor. `mammogram` has its view and side.
void ReadSpacing(DcmItem& data, const PictureDescription& given, const std::string& path,
  Mammogram& mammogram)
{
  std::string why;
  if (const auto spacing = ReceptorSpacingOf(data, why))
  {
    mammogram.RowSpacingMm = (*spacing)[0];
    mammogram.ColumnSpacingMm = (*spacing)[1];
  }
  else if (given.PixelSpacingMm)
  {
    mammogram.RowSpacingMm = mammogram.ColumnSpacingMm = *given.PixelSpacingMm;
  }
  else
  {
    RefuseSpacing(mammogram, given, path, why);
  }
}

/// Fills in what the header lacks.
void Complete(const PictureDescription& given, Mammogram& mammogram)
{
  mammogram.View = mammogram.View.empty() ? given.View : mammogram.View;
  mammogram.Laterality = mammogram.Laterality == '?' ? given.Laterality : mammogram.Laterality;
}

void ReadIntensityScale(DcmItem& data, const std::string& path, Mammogram& mammogram)
{
  mammogram.PresentationIntent = MammogramIntent(data);
  // An image of the wrong intent is registered with a wrong thickness, and looks right.
  const std::string storage = DicomText(data, DCM_SOPClassUID);
  const bool isRaw = mammogram.PresentationIntent == Mammogram::Intent::ForProcessing;
  const bool isKnown = IsBreastProjection(storage) ||
    storage == UID_DigitalMammographyXRayImageStorageForPresentation ||
    storage == UID_DigitalMammographyXRayImageStorageForProcessing;
  if (isKnown && IsForProcessingClass(storage) != isRaw)
  {
    Refuse(path,
      std::string("expected Presentation Intent Type (0008,0068) and SOP Class (0008,0016) of one "
                  "kind, found FOR ") +
        (isRaw ? "PROCESSING for what is stored as For Presentation"
               : "PRESENTATION for what is stored as For Processing"));
  }
  const std::string photometric = DicomText(data, DCM_PhotometricInterpretation);
  if (photometric != "MONOCHROME1" && photometric != "MONOCHROME2")
  {
    Refuse(path, "expected a grey image (MONOCHROME1 or MONOCHROME2), found '" + photometric + "'");
  }
  mammogram.InvertedForDisplay = photometric == "MONOCHROME1";

  const std::string relationship = DicomText(data, DCM_PixelIntensityRelationship);
  mammogram.IntensityRelationship = relationship == "LIN" ? Mammogram::Relationship::Linear
    : relationship == "LOG"                               ? Mammogram::Relationship::Logarithmic
                                                          : Mammogram::Relationship::Unknown;
  if (const auto sign = DicomShort(data, DCM_PixelIntensityRelationshipSign))
  {
    mammogram.IntensitySign = *sign == 1 ? 1 : *sign == 0xffff ? -1 : 0;
  }
  if (data.tagExists(DCM_ModalityLUTSequence))
  {
    Refuse(path, "expected a linear modality rescale, found a Modality LUT Sequence (0028,3000)");
  }
  for (const DcmTagKey& tag : { DCM_RescaleSlope, DCM_RescaleIntercept })
  {
    if (const std::string text = DicomText(data, tag); !text.empty() && !DicomNumber(data, tag))
    {
      Refuse(path, "expected a number to rescale pixels by, found '" + text + "'");
    }
  }
}

PixelPadding PaddingOf(DcmItem& data)
{
  return { DicomShort(data, DCM_PixelPaddingValue), DicomShort(data, DCM_PixelPaddingRangeLimit) };
}

/// Fills in the pixels of a frame, by the rescaling and padding of its header.
void SetPixels(Mammogram& mammogram, const DicomPixels& pixels, std::size_t frame, DcmItem& header)
{
  mammogram.Columns = pixels.Columns();
  mammogram.Rows = pixels.Rows();
  mammogram.BitsStored = pixels.BitsStored();
  mammogram.Pixels = pixels.Values(frame, DicomNumber(header, DCM_RescaleSlope).value_or(1),
    DicomNumber(header, DCM_RescaleIntercept).value_or(0), PaddingOf(header));
}

/// Throws InputError on another modality.
void CheckIsMammogram(DcmItem& data, const std::string& path)
{
  const std::string modality = DicomText(data, DCM_Modality);
  if (modality != "MG")
  {
    Refuse(path,
      "expected a mammogram (modality MG), found modality '" +
        (modality.empty() ? std::string("none") : modality) + "'");
  }
}

/// Throws InputError on stacks.
void CheckIsOne(DcmItem& data, const std::string& path)
{
  const double frames = DicomNumber(data, DCM_NumberOfFrames).value_or(1);
  if (frames > 1 || DicomText(data, DCM_SOPClassUID) == UID_BreastTomosynthesisImageStorage)
  {
    Refuse(path,
      "expected one projection, found a tomosynthesis or multi-frame object of " +
        std::to_string(static_cast<long>(frames)) + " frame(s)");
  }
}

/// Reads the positions of source and detector from the flat attributes of a frame.
SourcePlace ReadSourcePlace(DcmItem& frame, const std::string& path)
{
  const auto number = [&](const DcmTagKey& tag, unsigned long index = 0)
  {
    const std::optional<double> value = DicomNumber(frame, tag, index);
    // Angles of at most a turn, lengths of at most some metres.
    if (!value || std::abs(*value) > 1e4)
    {
      Refuse(path,
        std::string("expected where source and detector stood for each projection, found no "
                    "usable ") +
          DcmTag(tag).getTagName() + " " + tag.toString().c_str());
    }
    return *value;
  };
  const auto vector = [&](const DcmTagKey& tag, unsigned long first) {
    return Vector3{ number(tag, first), number(tag, first + 1), number(tag, first + 2) };
  };
  SourcePlace place;
  place.SourceToIsocenterMm = number(DCM_DistanceSourceToIsocenter);
  place.SourcePrimaryDeg = number(DCM_XRaySourceIsocenterPrimaryAngle);
  place.SourceSecondaryDeg = number(DCM_XRaySourceIsocenterSecondaryAngle);
  place.DetectorPrimaryDeg = number(DCM_DetectorIsocenterPrimaryAngle);
  for (const DcmTagKey& tag :
    { DCM_DetectorIsocenterSecondaryAngle, DCM_BreastSupportIsocenterSecondaryAngle })
  {
    if (DicomNumber(frame, tag).value_or(0) != 0)
    {
      Refuse(path, "expected a detector that turns about one axis, found one with a second angle");
    }
  }
  place.Detector = { number(DCM_DetectorXPositionToIsocenter),
    number(DCM_DetectorYPositionToIsocenter), number(DCM_DetectorZPositionToIsocenter) };
  place.FirstPixel = vector(DCM_DetectorActiveAreaTLHCPosition, 0);
  place.Row = vector(DCM_DetectorActiveAreaOrientation, 0);
  place.Column = vector(DCM_DetectorActiveAreaOrientation, 3);
  if (std::abs(Norm(place.Row) - 1) > 1e-3 || std::abs(Norm(place.Column) - 1) > 1e-3 ||
    std::abs(Dot(place.Row, place.Column)) > 1e-3 || std::abs(place.Row[2]) > 1e-3 ||
    std::abs(place.Column[2]) > 1e-3)
  {
    Refuse(path,
      "expected directions of rows and columns at right angles on the detector, found others in "
      "DetectorActiveAreaOrientation (0018,9558)");
  }
  return place;
}

/// Reads a frame without its pixels.
Mammogram ReadFrame(DcmItem& frame, const std::string& view, const PictureDescription& given,
  const std::string& path)
{
  Mammogram mammogram;
  ReadIntensityScale(frame, path, mammogram);
  ReadAcquisition(frame, mammogram);
  mammogram.View = ViewTerm(view);
  Complete(given, mammogram);
  ReadSpacing(frame, given, path, mammogram);
  const SourcePlace place = ReadSourcePlace(frame, path);
  const Vector3 over = SourceOverPixels(place, mammogram.ColumnSpacingMm, mammogram.RowSpacingMm);
  if (!(over[2] > 0))
  {
    Refuse(path, "expected a source above the detector, found one below it");
  }
  mammogram.SourceFootPixel = { over[0], over[1] };
  mammogram.SourceToDetectorMm = over[2];
  // The angle of the breast support; the source's own angle differs between projections.
  mammogram.PositionerPrimaryAngleDeg =
    place.DetectorPrimaryDeg == 0 ? 0 : -place.DetectorPrimaryDeg;
  return mammogram;
}

std::vector<Mammogram> ReadFrames(const DicomFile& file, const PictureDescription& given,
  const std::string& path)
{
  constexpr std::size_t most = 200; // units take 9 to 60
  const DicomFrames frames(file.Data(), path);
  if (frames.Count() < 2 || frames.Count() > most)
  {
    Refuse(path,
      "expected 2 to " + std::to_string(most) + " projections, found " +
        std::to_string(frames.Count()));
  }
  const std::string view = MammogramViewOf(file.Data());
  std::vector<Mammogram> projections;
  std::vector<std::unique_ptr<DcmItem>> headers;
  for (std::size_t number = 0; number < frames.Count(); ++number)
  {
    headers.push_back(frames.Flat(number));
    projections.push_back(ReadFrame(*headers.back(), view, given, path));
  }
  const DicomPixels pixels(file);
  for (std::size_t number = 0; number < frames.Count(); ++number)
  {
    SetPixels(projections[number], pixels, number, *headers[number]);
  }
  return projections;
}

std::vector<Mammogram> ReadHere(const std::string& path, const PictureDescription& given)
{
  // The header first: what is no mammogram is refused before its pixels are looked at.
  const DicomFile file(path, "a DICOM mammogram");
  CheckIsMammogram(file.Data(), path);
  NoteContradictions(file.Data(), path);
  if (IsBreastProjection(DicomText(file.Data(), DCM_SOPClassUID)))
  {
    return ReadFrames(file, given, path);
  }
  CheckIsOne(file.Data(), path);
  Mammogram mammogram;
  ReadIntensityScale(file.Data(), path, mammogram);
  ReadAcquisition(file.Data(), mammogram);
  Complete(given, mammogram);
  ReadSpacing(file.Data(), given, path, mammogram);
  SetPixels(mammogram, DicomPixels(file), 0, file.Data());
  return { std::move(mammogram) };
}
}

std::vector<Mammogram> ReadProjections(const std::string& path, const PictureDescription& given)
{
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code) || !std::ifstream(path))
  {
    Refuse(path, "expected a DICOM mammogram, found no file that can be read");
  }
  return ReadGuarded(path, "a DICOM mammogram", ReadLimits::Of({ path }),
    [&] { return ReadHere(path, given); });
}

std::size_t MiddleProjection(const std::vector<Mammogram>& projections)
{
  // An image without a foot is the only one.
  const auto foot = [&](std::size_t number) {
    return projections[number].SourceFootPixel.value_or(std::array<double, 2>{ 0, 0 });
  };
  std::array<double, 2> mean{ 0, 0 };
  for (std::size_t number = 0; number < projections.size(); ++number)
  {
    mean[0] += foot(number)[0] / static_cast<double>(projections.size());
    mean[1] += foot(number)[1] / static_cast<double>(projections.size());
  }
  std::size_t middle = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t number = 0; number < projections.size(); ++number)
  {
    const double away = std::hypot(foot(number)[0] - mean[0], foot(number)[1] - mean[1]);
    if (away < least)
    {
      least = away;
      middle = number;
    }
  }
  return middle;
}

Mammogram ReadMammogram(const std::string& path, const PictureDescription& given)
{
  std::vector<Mammogram> projections = ReadProjections(path, given);
  return std::move(projections[MiddleProjection(projections)]);
}
}
