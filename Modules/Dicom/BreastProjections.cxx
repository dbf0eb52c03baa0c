// SPDX-License-Identifier: Apache-2.0
// Breast Projection X-Ray Image: frames of one compression, each with where its source stood.
#include "Private/DicomElements.h"
#include "Private/MammogramObject.h"
#include "Private/SourcePlace.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ProjectionImage.h"

#include <algorithm>
#include <tuple>

namespace mammoray
{
namespace
{
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

/// The detector's field, all of which was in the beam.
void AddField(DcmItem& groups, const Mammogram& mammogram)
{
  Add(groups,
    { { DCM_FieldOfViewSequence,
        Item({ { DCM_FieldOfViewShape, "RECTANGLE" }, { DCM_FieldOfViewOrigin, { 0, 0 } },
          { DCM_FieldOfViewRotation, 0 }, { DCM_FieldOfViewHorizontalFlip, "NO" },
          { DCM_FieldOfViewDimensionsInFloat,
            { mammogram.Rows * mammogram.RowSpacingMm,
              mammogram.Columns * mammogram.ColumnSpacingMm } } }) },
      { DCM_CollimatorShapeSequence,
        Item({ { DCM_CollimatorShape, "RECTANGULAR" }, { DCM_CollimatorLeftVerticalEdge, 0 },
          { DCM_CollimatorRightVerticalEdge, mammogram.Columns + 1 },
          { DCM_CollimatorUpperHorizontalEdge, 0 },
          { DCM_CollimatorLowerHorizontalEdge, mammogram.Rows + 1 } }) } });
}

/// The groups that all frames share.
DcmItem SharedGroups(const std::vector<Mammogram>& projections)
{
  const Mammogram& first = projections.front();
  float white = 1;
  for (const Mammogram& projection : projections)
  {
    white = std::max(white, FindWhite(projection.Pixels.data(), projection.Pixels.size()));
  }
  DcmItem groups = Item({ { DCM_FrameAnatomySequence,
                            Item({ { DCM_FrameLaterality, std::string(1, first.Laterality) },
                              { DCM_AnatomicRegionSequence, DicomCode("76752008", "Breast") } }) },
    { DCM_PatientOrientationInFrameSequence,
      Item({ { DCM_PatientOrientation, first.RowDirection + "\\" + first.ColumnDirection } }) },
    { DCM_FramePixelDataPropertiesSequence,
      Item({ { DCM_FrameType, "DERIVED\\PRIMARY\\\\NONE" },
        { DCM_ImagerPixelSpacing, { first.RowSpacingMm, first.ColumnSpacingMm } },
        { DCM_PixelIntensityRelationship, PixelRelationship(first) },
        { DCM_PixelIntensityRelationshipSign, PixelRelationshipSign(first) },
        { DCM_GeometricalProperties, "UNIFORM" }, { DCM_ImageProcessingApplied, "NONE" } }) },
    { DCM_PixelValueTransformationSequence,
      Item({ { DCM_RescaleIntercept, 0 }, { DCM_RescaleSlope, 1 }, { DCM_RescaleType, "US" } }) },
    { DCM_DerivationImageSequence, NoItems },
    // No photon was spent on what is computed.
    { DCM_XRayAcquisitionDoseSequence,
      Item({ { DCM_OrganDose, 0 }, { DCM_EntranceDoseInmGy, 0 }, { DCM_ExposureTimeInms, 0 },
        { DCM_ExposureInmAs, 0 } }) },
    { DCM_FrameVOILUTSequence,
      Item({ { DCM_WindowCenter, 0.5 * white }, { DCM_WindowWidth, white } }) } });
  AddField(groups, first);
  return groups;
}

DcmItem FrameGroups(const Mammogram& projection, double axisHeightMm)
{
  const SourcePlace place = PlaceSource(projection, axisHeightMm);
  const double height = projection.SourceToDetectorMm.value();
  const double toPatient = projection.SourceToPatientMm.value_or(height);
  return Item({ { DCM_FrameContentSequence, DcmItem() }, // all of it is optional
    { DCM_IrradiationEventIdentificationSequence, Item({ { DCM_IrradiationEventUID, NewUid() } }) },
    { DCM_XRayGeometrySequence,
      Item({ { DCM_DistanceSourceToDetector, height }, { DCM_DistanceSourceToPatient, toPatient },
        { DCM_EstimatedRadiographicMagnificationFactor, height / toPatient },
        { DCM_DistanceSourceToIsocenter, place.SourceToIsocenterMm } }) },
    { DCM_PositionerPositionSequence,
      Item({ { DCM_PositionerPrimaryAngle, -place.SourcePrimaryDeg },
        { DCM_PositionerSecondaryAngle, place.SourceSecondaryDeg },
        { DCM_PositionerPrimaryAngleDirection, "CC" } }) },
    { DCM_IsocenterReferenceSystemSequence,
      Item({ { DCM_XRaySourceIsocenterPrimaryAngle, place.SourcePrimaryDeg },
        { DCM_XRaySourceIsocenterSecondaryAngle, place.SourceSecondaryDeg },
        // The breast support is on the detector.
        { DCM_BreastSupportIsocenterPrimaryAngle, place.DetectorPrimaryDeg },
        { DCM_BreastSupportIsocenterSecondaryAngle, 0 },
        { DCM_BreastSupportXPositionToIsocenter, place.Detector[0] },
        { DCM_BreastSupportYPositionToIsocenter, place.Detector[1] },
        { DCM_BreastSupportZPositionToIsocenter, place.Detector[2] },
        { DCM_DetectorIsocenterPrimaryAngle, place.DetectorPrimaryDeg },
        { DCM_DetectorIsocenterSecondaryAngle, 0 },
        { DCM_DetectorXPositionToIsocenter, place.Detector[0] },
        { DCM_DetectorYPositionToIsocenter, place.Detector[1] },
        { DCM_DetectorZPositionToIsocenter, place.Detector[2] },
        { DCM_DetectorActiveAreaTLHCPosition, place.FirstPixel },
        { DCM_DetectorActiveAreaOrientation,
          { place.Row[0], place.Row[1], place.Row[2], place.Column[0], place.Column[1],
            place.Column[2] } } }) } });
}

void AddAcquisition(DcmItem& data, const Mammogram& mammogram)
{
  Add(data,
    { { DCM_AcquisitionDateTime, TimeNow("%Y%m%d%H%M%S") }, { DCM_PositionerMotion, "DYNAMIC" },
      { DCM_PositionerType, "MAMMOGRAPHIC" }, { DCM_ContentQualification, "RESEARCH" },
      { DCM_DetectorType, "DIRECT" }, { DCM_KVP, mammogram.PeakKilovoltage.value_or(0) },
      { DCM_FocalSpots, 0 },
      { DCM_AnodeTargetMaterial,
        mammogram.AnodeMaterial.empty() ? "OTHER" : mammogram.AnodeMaterial },
      { DCM_CompressionForce, 0 }, { DCM_PaddleDescription, "computed" },
      { DCM_ExposureControlMode, "MANUAL" }, { DCM_ExposureControlModeDescription, "computed" },
      { DCM_FrameOfReferenceUID, NewUid() }, { DCM_PositionReferenceIndicator, "" },
      { DCM_BreastImplantPresent, "NO" }, { DCM_OrganDose, 0 }, { DCM_EntranceDoseInmGy, 0 },
      { DCM_TypeOfDetectorMotion, "STATIONARY" }, { DCM_AcquisitionDuration, 0 },
      { DCM_ExposureInmAs, 0 },
      // Standing (C.8.4.6), as patients do before such units.
      { DCM_PatientOrientationCodeSequence, DicomCode("10904000", "erect") },
      { DCM_BodyPartThickness, mammogram.BodyPartThicknessMm },
      { DCM_ViewCodeSequence, MammogramViewItem(mammogram.View) },
      { DCM_AcquisitionContextSequence, NoItems } });
}
}

void WriteProjections(const std::vector<Mammogram>& projections,
  const DicomMammogramOptions& options, double axisHeightMm, const std::string& path)
{
  CheckProjections(projections);
  const Mammogram& first = projections.front();
  const bool processing = first.PresentationIntent == Mammogram::Intent::ForProcessing;
  DcmItem data;
  AddCommon(data, processing ? ForProcessingClass : ForPresentationClass, "MG",
    options.SeriesDescription, options.Identity);
  AddAcquisition(data, first);
  AddMammogramPixels(data, first);
  std::vector<DcmItem> frames;
  std::vector<std::uint16_t> stored;
  stored.reserve(projections.size() * first.Pixels.size());
  for (const Mammogram& projection : projections)
  {
    frames.push_back(FrameGroups(projection, axisHeightMm));
    stored.insert(stored.end(), projection.Pixels.begin(), projection.Pixels.end());
  }
  AddBulk(data, DCM_PixelData, stored);
  Add(data,
    { { DCM_ImageType, "DERIVED\\PRIMARY\\\\NONE" },
      { DCM_DerivationDescription, options.Derivation }, { DCM_NumberOfFrames, projections.size() },
      { DCM_SharedFunctionalGroupsSequence, SharedGroups(projections) },
      { DCM_PerFrameFunctionalGroupsSequence, frames } });
  WriteDicom(data, path);
}
}
