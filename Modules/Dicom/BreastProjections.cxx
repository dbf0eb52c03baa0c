// SPDX-License-Identifier: Apache-2.0
// Breast Projection X-Ray Image: frames of one compression, each with where its source stood.
#include "Private/DicomElements.h"
#include "Private/MammogramObject.h"
#include "Private/SourcePlace.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ProjectionImage.h"

#include <algorithm>
#include <ctime>
#include <tuple>

namespace mammoray
{
namespace
{
using DataSet = DcmItem;

constexpr const char* ForPresentationClass = "1.2.840.10008.5.1.4.1.1.13.1.4";
constexpr const char* ForProcessingClass = "1.2.840.10008.5.1.4.1.1.13.1.5";
/// 16 bits, as many as a stack of a real unit has at most, and within what a file can hold.
constexpr std::size_t MostProjections = 999;

/// Throws InputError unless the projections are of one picture plane and one kind.
void CheckProjections(const std::vector<Mammogram>& projections)
{
  if (projections.empty() || projections.size() > MostProjections)
  {
    throw InputError("projections: expected 1 to " + std::to_string(MostProjections) + ", found " +
      std::to_string(projections.size()));
  }
  const auto shared = [](const Mammogram& one)
  {
    return std::tie(one.Columns, one.Rows, one.ColumnSpacingMm, one.RowSpacingMm,
      one.PresentationIntent, one.IntensityRelationship, one.IntensitySign, one.InvertedForDisplay,
      one.View, one.Laterality, one.RowDirection, one.ColumnDirection,
      one.PositionerPrimaryAngleDeg, one.BodyPartThicknessMm);
  };
  for (const Mammogram& projection : projections)
  {
    CheckMammogramObject(projection);
    if (!projection.SourceFootPixel || !projection.SourceToDetectorMm)
    {
      throw InputError("projections: expected where the source stood over each, found one without");
    }
    if (shared(projection) != shared(projections.front()))
    {
      throw InputError("projections: expected all of one size, view and kind, found others");
    }
  }
}

DataSet GroupItem(const std::vector<DicomTextElement>& texts)
{
  DataSet item;
  AddTexts(item, texts);
  return item;
}

/// Date and time in one.
std::string Now()
{
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[24];
  std::strftime(text, sizeof text, "%Y%m%d%H%M%S", &local);
  return text;
}

/// What was in the beam: all of the detector.
void AddField(DataSet& groups, const Mammogram& mammogram)
{
  DataSet field =
    GroupItem({ { { 0x0018, 0x1147 }, EVR_CS, "RECTANGLE" }, { { 0x0018, 0x7030 }, EVR_DS, "0\\0" },
      { { 0x0018, 0x7032 }, EVR_DS, "0" }, { { 0x0018, 0x7034 }, EVR_CS, "NO" } });
  AddFloats(field, { 0x0018, 0x9461 },
    { static_cast<float>(mammogram.Rows * mammogram.RowSpacingMm),
      static_cast<float>(mammogram.Columns * mammogram.ColumnSpacingMm) });
  AddSequence(groups, { 0x0018, 0x9432 }, { field });
  AddSequence(groups, { 0x0018, 0x9407 },
    { GroupItem(
      { { { 0x0018, 0x1700 }, EVR_CS, "RECTANGULAR" }, { { 0x0018, 0x1702 }, EVR_IS, "0" },
        { { 0x0018, 0x1704 }, EVR_IS, std::to_string(mammogram.Columns + 1) },
        { { 0x0018, 0x1706 }, EVR_IS, "0" },
        { { 0x0018, 0x1708 }, EVR_IS, std::to_string(mammogram.Rows + 1) } }) });
}

/// The groups that all frames share.
DataSet SharedGroups(const std::vector<Mammogram>& projections)
{
  const Mammogram& first = projections.front();
  DataSet groups;
  DataSet anatomy = GroupItem({ { { 0x0020, 0x9072 }, EVR_CS, std::string(1, first.Laterality) } });
  AddSequence(anatomy, { 0x0008, 0x2218 }, { DicomCode("76752008", "Breast") });
  AddSequence(groups, { 0x0020, 0x9071 }, { anatomy });
  AddSequence(groups, { 0x0020, 0x9450 },
    { GroupItem(
      { { { 0x0020, 0x0020 }, EVR_CS, first.RowDirection + "\\" + first.ColumnDirection } }) });
  DataSet properties = GroupItem({ { { 0x0008, 0x9007 }, EVR_CS, "DERIVED\\PRIMARY\\\\NONE" },
    { { 0x0018, 0x1164 }, EVR_DS,
      DecimalString(first.RowSpacingMm) + "\\" + DecimalString(first.ColumnSpacingMm) },
    { { 0x0028, 0x1040 }, EVR_CS, PixelRelationship(first) },
    { { 0x0028, 0x9444 }, EVR_CS, "UNIFORM" }, { { 0x0028, 0x9446 }, EVR_CS, "NONE" } });
  const std::int16_t sign = PixelRelationshipSign(first);
  AddBytes(properties, { 0x0028, 0x1041 }, EVR_SS, &sign, sizeof sign);
  AddSequence(groups, { 0x0028, 0x9443 }, { properties });
  AddSequence(groups, { 0x0028, 0x9145 },
    { GroupItem({ { { 0x0028, 0x1052 }, EVR_DS, "0" }, { { 0x0028, 0x1053 }, EVR_DS, "1" },
      { { 0x0028, 0x1054 }, EVR_LO, "US" } }) });
  AddField(groups, first);
  AddSequence(groups, { 0x0008, 0x9124 }, {}); // derived from no image
  // No photon was spent on what is computed.
  DataSet dose =
    GroupItem({ { { 0x0040, 0x0316 }, EVR_DS, "0" }, { { 0x0040, 0x8302 }, EVR_DS, "0" } });
  AddDoubles(dose, { 0x0018, 0x9328 }, { 0 }); // exposure time, ms
  AddDoubles(dose, { 0x0018, 0x9332 }, { 0 }); // exposure, mAs
  AddSequence(groups, { 0x0018, 0x9542 }, { dose });
  float white = 1;
  for (const Mammogram& projection : projections)
  {
    white = std::max(white, FindWhite(projection.Pixels.data(), projection.Pixels.size()));
  }
  AddSequence(groups, { 0x0028, 0x9132 },
    { GroupItem({ { { 0x0028, 0x1050 }, EVR_DS, DecimalString(0.5 * white) },
      { { 0x0028, 0x1051 }, EVR_DS, DecimalString(white) } }) });
  return groups;
}

/// Distances of one frame.
DataSet ProjectionGeometry(const Mammogram& projection, const SourcePlace& place)
{
  const double height = projection.SourceToDetectorMm.value();
  const double toPatient = projection.SourceToPatientMm.value_or(height);
  DataSet geometry = GroupItem({ { { 0x0018, 0x1110 }, EVR_DS, DecimalString(height) },
    { { 0x0018, 0x1111 }, EVR_DS, DecimalString(toPatient) },
    { { 0x0018, 0x1114 }, EVR_DS, DecimalString(height / toPatient) } });
  AddFloats(geometry, { 0x0018, 0x9402 }, { static_cast<float>(place.SourceToIsocenterMm) });
  return geometry;
}

DataSet FrameGroups(const Mammogram& projection, double axisHeightMm)
{
  const SourcePlace place = PlaceSource(projection, axisHeightMm);
  DataSet groups;
  AddSequence(groups, { 0x0020, 0x9111 }, { DataSet{} }); // frame content, of which all is optional
  AddSequence(groups, { 0x0018, 0x9477 },
    { GroupItem({ { { 0x0008, 0x3010 }, EVR_UI, NewUid() } }) }); // irradiation event
  AddSequence(groups, { 0x0018, 0x9476 }, { ProjectionGeometry(projection, place) });
  AddSequence(groups, { 0x0018, 0x9405 },
    { GroupItem({ { { 0x0018, 0x1510 }, EVR_DS, DecimalString(-place.SourcePrimaryDeg) },
      { { 0x0018, 0x1511 }, EVR_DS, DecimalString(place.SourceSecondaryDeg) },
      { { 0x0018, 0x9559 }, EVR_CS, "CC" } }) });
  DataSet isocenter;
  const auto add = [&](std::uint16_t element, double value) {
    AddDoubles(isocenter, { 0x0018, element }, { value });
  };
  add(0x9543, place.SourcePrimaryDeg);
  add(0x9544, place.SourceSecondaryDeg);
  add(0x9545, place.DetectorPrimaryDeg); // of the breast support, which is on the detector
  add(0x9546, 0);
  add(0x9547, place.Detector[0]);
  add(0x9548, place.Detector[1]);
  add(0x9549, place.Detector[2]);
  add(0x9550, place.DetectorPrimaryDeg);
  add(0x9551, 0);
  add(0x9552, place.Detector[0]);
  add(0x9553, place.Detector[1]);
  add(0x9554, place.Detector[2]);
  AddDoubles(isocenter, { 0x0018, 0x9557 },
    { place.FirstPixel[0], place.FirstPixel[1], place.FirstPixel[2] });
  AddDoubles(isocenter, { 0x0018, 0x9558 },
    { place.Row[0], place.Row[1], place.Row[2], place.Column[0], place.Column[1],
      place.Column[2] });
  AddSequence(groups, { 0x0018, 0x9462 }, { isocenter });
  return groups;
}

void AddAcquisition(DataSet& data, const Mammogram& mammogram)
{
  AddTexts(data,
    { { { 0x0008, 0x002a }, EVR_DT, Now() }, { { 0x0018, 0x1500 }, EVR_CS, "DYNAMIC" },
      { { 0x0018, 0x1508 }, EVR_CS, "MAMMOGRAPHIC" }, { { 0x0018, 0x9004 }, EVR_CS, "RESEARCH" },
      { { 0x0018, 0x7004 }, EVR_CS, "DIRECT" },
      { { 0x0018, 0x0060 }, EVR_DS, DecimalString(mammogram.PeakKilovoltage.value_or(0)) },
      { { 0x0018, 0x1190 }, EVR_DS, "0" },
      { { 0x0018, 0x1191 }, EVR_CS,
        mammogram.AnodeMaterial.empty() ? "OTHER" : mammogram.AnodeMaterial },
      { { 0x0018, 0x11a2 }, EVR_DS, "0" }, { { 0x0018, 0x11a4 }, EVR_LO, "computed" },
      { { 0x0018, 0x7060 }, EVR_CS, "MANUAL" }, { { 0x0018, 0x7062 }, EVR_LT, "computed" },
      { { 0x0020, 0x0052 }, EVR_UI, NewUid() }, { { 0x0020, 0x1040 }, EVR_LO, "" },
      { { 0x0028, 0x1300 }, EVR_CS, "NO" }, { { 0x0040, 0x0316 }, EVR_DS, "0" },
      { { 0x0040, 0x8302 }, EVR_DS, "0" }, { { 0x0054, 0x0202 }, EVR_CS, "STATIONARY" } });
  AddDoubles(data, { 0x0018, 0x9073 }, { 0 }); // acquisition duration, s
  AddDoubles(data, { 0x0018, 0x9332 }, { 0 }); // exposure, mAs
  // Standing (C.8.4.6), as patients do before such units.
  DataSet erect = DicomCode("10904000", "erect");
  AddSequence(data, { 0x0054, 0x0410 }, { erect });
  if (mammogram.BodyPartThicknessMm)
  {
    AddTexts(data,
      { { { 0x0018, 0x11a0 }, EVR_DS, DecimalString(*mammogram.BodyPartThicknessMm) } });
  }
  AddSequence(data, { 0x0054, 0x0220 }, { MammogramViewItem(mammogram.View) });
  AddSequence(data, { 0x0040, 0x0555 }, {}); // acquisition context
}
}

void WriteProjections(const std::vector<Mammogram>& projections,
  const DicomMammogramOptions& options, double axisHeightMm, const std::string& path)
{
  CheckProjections(projections);
  const Mammogram& first = projections.front();
  const bool processing = first.PresentationIntent == Mammogram::Intent::ForProcessing;
  DataSet data;
  AddCommon(data, processing ? ForProcessingClass : ForPresentationClass, "MG",
    options.SeriesDescription, options.Identity);
  AddTexts(data,
    { { { 0x0008, 0x0008 }, EVR_CS, "DERIVED\\PRIMARY\\\\NONE" },
      { { 0x0008, 0x0068 }, EVR_CS, processing ? "FOR PROCESSING" : "FOR PRESENTATION" },
      { { 0x0008, 0x2111 }, EVR_ST, options.Derivation },
      { { 0x0028, 0x0008 }, EVR_IS, std::to_string(projections.size()) },
      { { 0x0028, 0x0301 }, EVR_CS, "NO" }, { { 0x0028, 0x2110 }, EVR_CS, "00" },
      { { 0x2050, 0x0020 }, EVR_CS, first.InvertedForDisplay ? "INVERSE" : "IDENTITY" } });
  AddAcquisition(data, first);
  AddPixelDescription(data, first);
  AddSequence(data, { 0x5200, 0x9229 }, { SharedGroups(projections) });
  std::vector<DataSet> frames;
  std::vector<std::uint16_t> stored;
  stored.reserve(projections.size() * first.Pixels.size());
  for (const Mammogram& projection : projections)
  {
    frames.push_back(FrameGroups(projection, axisHeightMm));
    stored.insert(stored.end(), projection.Pixels.begin(), projection.Pixels.end());
  }
  AddSequence(data, { 0x5200, 0x9230 }, frames);
  AddBytes(data, { 0x7fe0, 0x0010 }, EVR_OW, stored.data(), 2 * stored.size());
  WriteDicom(data, path);
}
}
