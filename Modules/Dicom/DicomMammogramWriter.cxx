// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"
#include "Private/MammogramObject.h"
#include "Private/MammogramViews.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ProjectionImage.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace mammoray
{
namespace
{

const MammogramView& FindView(const std::string& name)
{
  const auto view = std::find_if(std::begin(MammogramViews), std::end(MammogramViews),
    [&](const MammogramView& known) { return known.Name == name; });
  if (view == std::end(MammogramViews))
  {
    throw InputError(
      "mammogram: expected the view CC, MLO, ML, LM, LMO or FB, found '" + name + "'");
  }
  return *view;
}

void AddImage(DcmItem& data, const Mammogram& mammogram)
{
  const bool processing = mammogram.PresentationIntent == Mammogram::Intent::ForProcessing;
  AddTexts(data,
    { { { 0x0008, 0x0068 }, EVR_CS, processing ? "FOR PROCESSING" : "FOR PRESENTATION" },
      { { 0x0028, 0x0301 }, EVR_CS, "NO" }, // burned in annotation
      { { 0x0028, 0x1040 }, EVR_CS, PixelRelationship(mammogram) },
      { { 0x0028, 0x1052 }, EVR_DS, "0" }, { { 0x0028, 0x1053 }, EVR_DS, "1" },
      { { 0x0028, 0x1054 }, EVR_LO, "US" }, { { 0x0028, 0x2110 }, EVR_CS, "00" }, // not lossy
      { { 0x2050, 0x0020 }, EVR_CS, mammogram.InvertedForDisplay ? "INVERSE" : "IDENTITY" } });
  AddPixelDescription(data, mammogram);
  const std::int16_t sign = PixelRelationshipSign(mammogram);
  AddBytes(data, { 0x0028, 0x1041 }, EVR_SS, &sign, sizeof sign);
  if (!processing)
  {
    const float white = FindWhite(mammogram.Pixels.data(), mammogram.Pixels.size());
    AddTexts(data,
      { { { 0x0028, 0x1050 }, EVR_DS, DecimalString(0.5 * white) },
        { { 0x0028, 0x1051 }, EVR_DS, DecimalString(std::max(white, 1.0f)) } });
  }
  const std::vector<std::uint16_t> stored(mammogram.Pixels.begin(), mammogram.Pixels.end());
  AddBytes(data, { 0x7fe0, 0x0010 }, EVR_OW, stored.data(), 2 * stored.size());
}

void AddGeometry(DcmItem& data, const Mammogram& mammogram)
{
  const auto optional = [&](DcmTagKey tag, const std::optional<double>& value)
  {
    if (value)
    {
      AddTexts(data, { { tag, EVR_DS, DecimalString(*value) } });
    }
  };
  optional({ 0x0018, 0x0060 }, mammogram.PeakKilovoltage);
  optional({ 0x0018, 0x1110 }, mammogram.SourceToDetectorMm);
  optional({ 0x0018, 0x1111 }, mammogram.SourceToPatientMm);
  optional({ 0x0018, 0x11a0 }, mammogram.BodyPartThicknessMm);
  optional({ 0x0018, 0x1510 }, mammogram.PositionerPrimaryAngleDeg);
  if (mammogram.PositionerPrimaryAngleDeg)
  {
    // Counter-clockwise: positive towards the patient's left, as BreastPose::RollDeg.
    AddTexts(data, { { { 0x0018, 0x9559 }, EVR_CS, "CC" } });
  }
  AddTexts(data,
    { { { 0x0018, 0x0015 }, EVR_CS, "BREAST" }, { { 0x0018, 0x1508 }, EVR_CS, "MAMMOGRAPHIC" },
      { { 0x0018, 0x1164 }, EVR_DS,
        DecimalString(mammogram.RowSpacingMm) + "\\" + DecimalString(mammogram.ColumnSpacingMm) },
      { { 0x0018, 0x1191 }, EVR_CS, mammogram.AnodeMaterial },
      { { 0x0018, 0x5101 }, EVR_CS, mammogram.View }, { { 0x0018, 0x7004 }, EVR_CS, "" },
      { { 0x0018, 0x7050 }, EVR_CS, mammogram.FilterMaterial },
      { { 0x0020, 0x0020 }, EVR_CS, mammogram.RowDirection + "\\" + mammogram.ColumnDirection },
      { { 0x0020, 0x0062 }, EVR_CS, std::string(1, mammogram.Laterality) },
      { { 0x0040, 0x0318 }, EVR_CS, "BREAST" } });
  AddSequence(data, { 0x0008, 0x2218 }, { DicomCode("76752008", "Breast") });
  AddSequence(data, { 0x0054, 0x0220 }, { MammogramViewItem(mammogram.View) });
  AddSequence(data, { 0x0040, 0x0555 }, {}); // acquisition context
}
}

void CheckMammogramObject(const Mammogram& mammogram)
{
  if (mammogram.Laterality != 'L' && mammogram.Laterality != 'R')
  {
    throw InputError("mammogram: expected the laterality L or R, found '" +
      std::string(1, mammogram.Laterality) + "'");
  }
  if (mammogram.RowDirection.empty() || mammogram.ColumnDirection.empty())
  {
    throw InputError("mammogram: expected patient directions of rows and columns, found none");
  }
  if (!(mammogram.RowSpacingMm > 0) || !(mammogram.ColumnSpacingMm > 0))
  {
    throw InputError("mammogram: expected positive pixel spacings");
  }
  const auto inRange = [](int count) { return count > 0 && count <= 65535; };
  if (!inRange(mammogram.Columns) || !inRange(mammogram.Rows) ||
    mammogram.Pixels.size() !=
      static_cast<std::size_t>(mammogram.Columns) * static_cast<std::size_t>(mammogram.Rows))
  {
    throw InputError(
      "mammogram: expected 1 to 65535 rows and columns and all their pixels, found " +
      std::to_string(mammogram.Columns) + " x " + std::to_string(mammogram.Rows) + " and " +
      std::to_string(mammogram.Pixels.size()) + " pixels");
  }
  const auto bad = std::find_if_not(mammogram.Pixels.begin(), mammogram.Pixels.end(),
    [](float pixel) { return pixel >= 0 && pixel <= 65535 && pixel == std::floor(pixel); });
  if (bad != mammogram.Pixels.end())
  {
    throw InputError(
      "mammogram: expected whole numbers from 0 to 65535 as pixels, found " + std::to_string(*bad));
  }
}

DcmItem MammogramViewItem(const std::string& name)
{
  const MammogramView& view = FindView(name);
  DcmItem code = DicomCode(view.SnomedCt, view.Meaning);
  AddSequence(code, { 0x0054, 0x0222 }, {}); // no modifier
  return code;
}

const char* PixelRelationship(const Mammogram& mammogram)
{
  // Of what is made for display neither is true; the standard allows no third (C.8.11.3).
  return mammogram.IntensityRelationship == Mammogram::Relationship::Linear ? "LIN" : "LOG";
}

std::int16_t PixelRelationshipSign(const Mammogram& mammogram)
{
  // Where nothing is said of it, what is shown bright is where little got through.
  const int byDisplay = mammogram.InvertedForDisplay ? 1 : -1;
  return static_cast<std::int16_t>(
    mammogram.IntensitySign != 0 ? mammogram.IntensitySign : byDisplay);
}

void AddPixelDescription(DcmItem& data, const Mammogram& mammogram)
{
  AddTexts(data,
    { { { 0x0028, 0x0004 }, EVR_CS,
      mammogram.InvertedForDisplay ? "MONOCHROME1" : "MONOCHROME2" } });
  AddShort(data, { 0x0028, 0x0002 }, 1); // samples per pixel
  AddShort(data, { 0x0028, 0x0010 }, static_cast<std::uint16_t>(mammogram.Rows));
  AddShort(data, { 0x0028, 0x0011 }, static_cast<std::uint16_t>(mammogram.Columns));
  AddShort(data, { 0x0028, 0x0100 }, 16);
  AddShort(data, { 0x0028, 0x0101 }, 16);
  AddShort(data, { 0x0028, 0x0102 }, 15);
  AddShort(data, { 0x0028, 0x0103 }, 0); // unsigned
}

void WriteMammogram(const Mammogram& mammogram, const DicomMammogramOptions& options,
  const std::string& path)
{
  CheckMammogramObject(mammogram);
  DcmItem data;
  AddCommon(data,
    mammogram.PresentationIntent == Mammogram::Intent::ForProcessing
      ? "1.2.840.10008.5.1.4.1.1.1.2.1"
      : "1.2.840.10008.5.1.4.1.1.1.2",
    "MG", options.SeriesDescription, options.Identity);
  // No third value: that one tells how a detector's image was made.
  AddTexts(data,
    { { { 0x0008, 0x0008 }, EVR_CS, "DERIVED\\PRIMARY\\" },
      { { 0x0008, 0x2111 }, EVR_ST, options.Derivation } });
  if (options.Imitated)
  {
    AddSequence(data, { 0x0008, 0x2112 }, { ImageReference(*options.Imitated) });
  }
  AddGeometry(data, mammogram);
  AddImage(data, mammogram);
  WriteDicom(data, path);
}
}
