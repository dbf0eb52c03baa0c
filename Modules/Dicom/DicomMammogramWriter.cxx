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
  AddMammogramPixels(data, mammogram);
  Add(data,
    { { DCM_PixelIntensityRelationship, PixelRelationship(mammogram) },
      { DCM_PixelIntensityRelationshipSign, PixelRelationshipSign(mammogram) },
      { DCM_RescaleIntercept, 0 }, { DCM_RescaleSlope, 1 }, { DCM_RescaleType, "US" } });
  if (mammogram.PresentationIntent == Mammogram::Intent::ForPresentation)
  {
    const float white = FindWhite(mammogram.Pixels.data(), mammogram.Pixels.size());
    Add(data, { { DCM_WindowCenter, 0.5 * white }, { DCM_WindowWidth, std::max(white, 1.0f) } });
  }
  AddBulk(data, DCM_PixelData,
    std::vector<std::uint16_t>(mammogram.Pixels.begin(), mammogram.Pixels.end()));
}

void AddGeometry(DcmItem& data, const Mammogram& mammogram)
{
  Add(data,
    { { DCM_KVP, mammogram.PeakKilovoltage },
      { DCM_DistanceSourceToDetector, mammogram.SourceToDetectorMm },
      { DCM_DistanceSourceToPatient, mammogram.SourceToPatientMm },
      { DCM_BodyPartThickness, mammogram.BodyPartThicknessMm },
      { DCM_PositionerPrimaryAngle, mammogram.PositionerPrimaryAngleDeg },
      { DCM_BodyPartExamined, "BREAST" }, { DCM_PositionerType, "MAMMOGRAPHIC" },
      { DCM_ImagerPixelSpacing, { mammogram.RowSpacingMm, mammogram.ColumnSpacingMm } },
      { DCM_AnodeTargetMaterial, mammogram.AnodeMaterial }, { DCM_ViewPosition, mammogram.View },
      { DCM_DetectorType, "" }, { DCM_FilterMaterial, mammogram.FilterMaterial },
      { DCM_PatientOrientation, mammogram.RowDirection + "\\" + mammogram.ColumnDirection },
      { DCM_ImageLaterality, std::string(1, mammogram.Laterality) }, { DCM_OrganExposed, "BREAST" },
      { DCM_AnatomicRegionSequence, DicomCode("76752008", "Breast") },
      { DCM_ViewCodeSequence, MammogramViewItem(mammogram.View) },
      { DCM_AcquisitionContextSequence, NoItems } });
  if (mammogram.PositionerPrimaryAngleDeg)
  {
    // Counter-clockwise: positive towards the patient's left, as BreastPose::RollDeg.
    Add(data, { { DCM_PositionerPrimaryAngleDirection, "CC" } });
  }
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
  Add(code, { { DCM_ViewModifierCodeSequence, NoItems } });
  return code;
}

const char* PixelRelationship(const Mammogram& mammogram)
{
  // Neither is true of an image made for display, but the standard allows no third (C.8.11.3).
  return mammogram.IntensityRelationship == Mammogram::Relationship::Linear ? "LIN" : "LOG";
}

int PixelRelationshipSign(const Mammogram& mammogram)
{
  // If the sign is unknown, pixels that are shown bright are those that few photons reached.
  const int byDisplay = mammogram.InvertedForDisplay ? 1 : -1;
  return mammogram.IntensitySign != 0 ? mammogram.IntensitySign : byDisplay;
}

void AddMammogramPixels(DcmItem& data, const Mammogram& mammogram)
{
  AddPixelDescription(data, mammogram.Columns, mammogram.Rows, 16,
    mammogram.InvertedForDisplay ? "MONOCHROME1" : "MONOCHROME2");
  Add(data,
    { { DCM_PresentationIntentType,
        mammogram.PresentationIntent == Mammogram::Intent::ForProcessing ? "FOR PROCESSING"
                                                                         : "FOR PRESENTATION" },
      { DCM_BurnedInAnnotation, "NO" }, { DCM_LossyImageCompression, "00" },
      { DCM_PresentationLUTShape, mammogram.InvertedForDisplay ? "INVERSE" : "IDENTITY" } });
}

void WriteMammogram(const Mammogram& mammogram, const DicomMammogramOptions& options,
  const std::string& path)
{
  CheckMammogramObject(mammogram);
  DcmItem data;
  AddCommon(data,
    mammogram.PresentationIntent == Mammogram::Intent::ForProcessing
      ? UID_DigitalMammographyXRayImageStorageForProcessing
      : UID_DigitalMammographyXRayImageStorageForPresentation,
    "MG", options.SeriesDescription, options.Identity);
  // No third value: that one tells how a detector's image was made.
  Add(data,
    { { DCM_ImageType, "DERIVED\\PRIMARY\\" }, { DCM_DerivationDescription, options.Derivation } });
  if (options.Imitated)
  {
    Add(data, { { DCM_SourceImageSequence, ImageReference(*options.Imitated) } });
  }
  AddGeometry(data, mammogram);
  AddImage(data, mammogram);
  WriteDicom(data, path);
}
}
