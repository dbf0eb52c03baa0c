// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Dicom/DicomWriter.h"

#include "Private/DicomElements.h"
#include "Private/DicomFile.h"
#include "mammoray/Foundation/Error.h"

namespace mammoray
{
namespace
{

void Check(const std::vector<DicomSegment>& segments, const DicomHeader& image)
{
  if (segments.empty() || segments.size() > 65535)
  {
    throw InputError(
      "segmentation: expected 1 to 65535 segments, found " + std::to_string(segments.size()));
  }
  const std::size_t pixelCount =
    static_cast<std::size_t>(image.Columns) * static_cast<std::size_t>(image.Rows);
  for (const DicomSegment& segment : segments)
  {
    CheckDicomText(segment.Label, "segment's label");
    if (segment.Label.empty() || segment.Mask.size() != pixelCount)
    {
      throw InputError("segmentation: expected a label and " + std::to_string(pixelCount) +
        " pixels in each segment, found '" + segment.Label + "' and " +
        std::to_string(segment.Mask.size()));
    }
  }
}

/// PS3.3 table C.8.20-4.
DcmItem Description(const DicomSegment& segment, std::size_t number)
{
  // CIELab of sRGB 255 0 0 and 255 255 0.
  const std::vector<double> red{ 0x8a3d, 0xd0a4, 0xc2ae };
  const std::vector<double> yellow{ 0xf8c6, 0x6a44, 0xdf1e };
  return Item({ { DCM_SegmentedPropertyCategoryCodeSequence,
                  DicomCode("49755003", "Morphologically Abnormal Structure") },
    { DCM_SegmentNumber, number }, { DCM_SegmentLabel, segment.Label },
    // Someone drew it in the volume; software carried it over.
    { DCM_SegmentAlgorithmType, "SEMIAUTOMATIC" },
    { DCM_SegmentAlgorithmName, "MammoRay registration" },
    { DCM_RecommendedDisplayCIELabValue, segment.Uncertainty ? yellow : red },
    { DCM_SegmentedPropertyTypeCodeSequence,
      segment.Uncertainty ? DicomCode("uncertainty", "Where the lesion may be", OwnCodes)
                          : DicomCode("52988006", "Lesion") } });
}

/// Functional groups of one frame: which segment it is, and of which image.
DcmItem FrameGroups(const DicomHeader& image, std::size_t number)
{
  DcmItem source = ImageReference(image);
  Add(source,
    { { DCM_SpatialLocationsPreserved, "YES" },
      { DCM_PurposeOfReferenceCodeSequence,
        DicomCode("121322", "Source image for image processing operation", "DCM") } });
  return Item({ { DCM_DerivationImageSequence,
                  Item({ { DCM_SourceImageSequence, source },
                    { DCM_DerivationCodeSequence, DicomCode("113076", "Segmentation", "DCM") } }) },
    { DCM_FrameContentSequence, Item({ { DCM_DimensionIndexValues, number } }) },
    { DCM_SegmentIdentificationSequence, Item({ { DCM_ReferencedSegmentNumber, number } }) } });
}

/// Frames are ordered by the number of their segment.
void AddDimensions(DcmItem& data)
{
  const std::string uid = NewUid();
  DcmItem index = Item(
    { { DCM_DimensionOrganizationUID, uid }, { DCM_DimensionDescriptionLabel, "Segment number" } });
  index.putAndInsertTagKey(DCM_DimensionIndexPointer, DCM_ReferencedSegmentNumber);
  index.putAndInsertTagKey(DCM_FunctionalGroupPointer, DCM_SegmentIdentificationSequence);
  Add(data,
    { { DCM_DimensionOrganizationSequence, Item({ { DCM_DimensionOrganizationUID, uid } }) },
      { DCM_DimensionIndexSequence, index } });
}

/// Common Instance Reference module: the image's series, in this study or in another.
void AddReferencedSeries(DcmItem& data, const DicomHeader& image)
{
  const std::string& study = image.Identity.StudyInstanceUid;
  const DicomElement series{ DCM_ReferencedSeriesSequence,
    SeriesReference(image, DCM_ReferencedInstanceSequence) };
  if (DicomText(data, DCM_StudyInstanceUID) == study)
  {
    Add(data, { series });
    return;
  }
  Add(data,
    { { DCM_StudiesContainingOtherReferencedInstancesSequence,
      Item({ { DCM_StudyInstanceUID, study }, series }) } });
}

/// One bit per pixel from the lowest of each byte, frames without a gap (PS3.5 section 8.1.1).
void AddPixels(DcmItem& data, const std::vector<DicomSegment>& segments, const DicomHeader& image)
{
  AddPixelDescription(data, image.Columns, image.Rows, 1);
  std::vector<std::uint8_t> bits((segments.size() * segments.front().Mask.size() + 7) / 8, 0);
  std::size_t at = 0;
  for (const DicomSegment& segment : segments)
  {
    for (const unsigned char inside : segment.Mask)
    {
      bits[at / 8] |= static_cast<std::uint8_t>((inside != 0 ? 1 : 0) << at % 8);
      ++at;
    }
  }
  AddBulk(data, DCM_PixelData, bits);
}
}

void WriteSegmentation(const std::vector<DicomSegment>& segments, const DicomHeader& image,
  const DicomIdentity& identity, const std::string& path)
{
  Check(segments, image);
  DcmItem data;
  AddCommon(data, UID_SegmentationStorage, "SEG", "Registered lesions", identity);
  std::vector<DcmItem> descriptions;
  std::vector<DcmItem> frames;
  for (const DicomSegment& segment : segments)
  {
    descriptions.push_back(Description(segment, descriptions.size() + 1));
    frames.push_back(FrameGroups(image, descriptions.size()));
  }
  Add(data,
    { { DCM_ImageType, "DERIVED\\PRIMARY" }, { DCM_PatientOrientation, image.PatientOrientation },
      { DCM_SegmentationType, "BINARY" }, { DCM_ContentLabel, "LESIONS" },
      { DCM_ContentDescription, "Shadows of lesions of a registered volume" },
      { DCM_ContentCreatorName, "" }, { DCM_NumberOfFrames, segments.size() },
      { DCM_LossyImageCompression, "00" }, { DCM_SegmentSequence, descriptions },
      { DCM_SharedFunctionalGroupsSequence, DcmItem() },
      { DCM_PerFrameFunctionalGroupsSequence, frames } });
  AddDimensions(data);
  AddReferencedSeries(data, image);
  AddPixels(data, segments, image);
  WriteDicom(data, path);
}
}
