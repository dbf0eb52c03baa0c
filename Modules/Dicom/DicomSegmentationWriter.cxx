// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Dicom/DicomWriter.h"

#include "Private/DicomElements.h"
#include "Private/DicomFile.h"
#include "mammoray/Foundation/Error.h"

#include <array>

namespace mammoray
{
namespace
{

void Check(const std::vector<DicomSegment>& segments, const DicomReference& image)
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
DcmItem Description(const DicomSegment& segment, std::uint16_t number)
{
  DcmItem item;
  AddSequence(item, { 0x0062, 0x0003 },
    { DicomCode("49755003", "Morphologically Abnormal Structure") });
  AddShort(item, { 0x0062, 0x0004 }, number);
  AddTexts(item,
    { { { 0x0062, 0x0005 }, EVR_LO, segment.Label },
      // Someone drew it in the volume; software carried it over.
      { { 0x0062, 0x0008 }, EVR_CS, "SEMIAUTOMATIC" },
      { { 0x0062, 0x0009 }, EVR_LO, "MammoRay registration" } });
  // CIELab of sRGB 255 0 0 and 255 255 0.
  using Colour = std::array<std::uint16_t, 3>;
  const Colour colour =
    segment.Uncertainty ? Colour{ 0xf8c6, 0x6a44, 0xdf1e } : Colour{ 0x8a3d, 0xd0a4, 0xc2ae };
  AddBytes(item, { 0x0062, 0x000d }, EVR_US, colour.data(), sizeof colour);
  AddSequence(item, { 0x0062, 0x000f },
    { segment.Uncertainty ? DicomCode("uncertainty", "Where the lesion may be", OwnCodes)
                          : DicomCode("52988006", "Lesion") });
  return item;
}

/// Functional groups of one frame: which segment it is, and of which image.
DcmItem FrameGroups(const DicomReference& image, std::uint16_t number)
{
  DcmItem source = ImageReference(image);
  AddTexts(source, { { { 0x0028, 0x135a }, EVR_CS, "YES" } }); // locations preserved
  AddSequence(source, { 0x0040, 0xa170 },
    { DicomCode("121322", "Source image for image processing operation", "DCM") });
  DcmItem derivation;
  AddSequence(derivation, { 0x0008, 0x2112 }, { source });
  AddSequence(derivation, { 0x0008, 0x9215 }, { DicomCode("113076", "Segmentation", "DCM") });
  DcmItem content;
  const std::uint32_t index = number;
  AddBytes(content, { 0x0020, 0x9157 }, EVR_UL, &index, sizeof index);
  DcmItem segment;
  AddShort(segment, { 0x0062, 0x000b }, number);
  DcmItem groups;
  AddSequence(groups, { 0x0008, 0x9124 }, { derivation });
  AddSequence(groups, { 0x0020, 0x9111 }, { content });
  AddSequence(groups, { 0x0062, 0x000a }, { segment });
  return groups;
}

/// Frames are ordered by the number of their segment.
void AddDimensions(DcmItem& data)
{
  const std::string uid = NewUid();
  DcmItem organization;
  AddTexts(organization, { { { 0x0020, 0x9164 }, EVR_UI, uid } });
  AddSequence(data, { 0x0020, 0x9221 }, { organization });
  DcmItem index;
  const std::array<std::uint16_t, 2> number{ 0x0062, 0x000b };
  const std::array<std::uint16_t, 2> group{ 0x0062, 0x000a };
  AddTexts(index, { { { 0x0020, 0x9164 }, EVR_UI, uid } });
  AddBytes(index, { 0x0020, 0x9165 }, EVR_AT, number.data(), sizeof number);
  AddBytes(index, { 0x0020, 0x9167 }, EVR_AT, group.data(), sizeof group);
  AddTexts(index, { { { 0x0020, 0x9421 }, EVR_LO, "Segment number" } });
  AddSequence(data, { 0x0020, 0x9222 }, { index });
}

/// Common Instance Reference module: the image's series, in this study or in another.
void AddReferencedSeries(DcmItem& data, const DicomReference& image)
{
  const DcmItem series = SeriesReference(image, { 0x0008, 0x114a });
  if (DicomText(data, { 0x0020, 0x000d }) == image.Identity.StudyInstanceUid)
  {
    AddSequence(data, { 0x0008, 0x1115 }, { series });
    return;
  }
  DcmItem study;
  AddTexts(study, { { { 0x0020, 0x000d }, EVR_UI, image.Identity.StudyInstanceUid } });
  AddSequence(study, { 0x0008, 0x1115 }, { series });
  AddSequence(data, { 0x0008, 0x1200 }, { study });
}

/// One bit per pixel from the lowest of each byte, frames without a gap (PS3.5 section 8.1.1).
void AddPixels(DcmItem& data, const std::vector<DicomSegment>& segments,
  const DicomReference& image)
{
  AddTexts(data,
    { { { 0x0028, 0x0004 }, EVR_CS, "MONOCHROME2" },
      { { 0x0028, 0x0008 }, EVR_IS, std::to_string(segments.size()) },
      { { 0x0028, 0x2110 }, EVR_CS, "00" } });
  AddShort(data, { 0x0028, 0x0002 }, 1);
  AddShort(data, { 0x0028, 0x0010 }, static_cast<std::uint16_t>(image.Rows));
  AddShort(data, { 0x0028, 0x0011 }, static_cast<std::uint16_t>(image.Columns));
  AddShort(data, { 0x0028, 0x0100 }, 1);
  AddShort(data, { 0x0028, 0x0101 }, 1);
  AddShort(data, { 0x0028, 0x0102 }, 0);
  AddShort(data, { 0x0028, 0x0103 }, 0);
  std::vector<unsigned char> bits((segments.size() * segments.front().Mask.size() + 7) / 8, 0);
  std::size_t at = 0;
  for (const DicomSegment& segment : segments)
  {
    for (const unsigned char inside : segment.Mask)
    {
      bits[at / 8] |= static_cast<unsigned char>((inside != 0 ? 1 : 0) << at % 8);
      ++at;
    }
  }
  AddBytes(data, { 0x7fe0, 0x0010 }, EVR_OB, bits.data(), bits.size());
}
}

void WriteSegmentation(const std::vector<DicomSegment>& segments, const DicomReference& image,
  const DicomIdentity& identity, const std::string& path)
{
  Check(segments, image);
  DcmItem data;
  AddCommon(data, "1.2.840.10008.5.1.4.1.1.66.4", "SEG", "Registered lesions", identity);
  AddTexts(data,
    { { { 0x0008, 0x0008 }, EVR_CS, "DERIVED\\PRIMARY" },
      { { 0x0020, 0x0020 }, EVR_CS, image.PatientOrientation },
      { { 0x0062, 0x0001 }, EVR_CS, "BINARY" }, { { 0x0070, 0x0080 }, EVR_CS, "LESIONS" },
      { { 0x0070, 0x0081 }, EVR_LO, "Shadows of lesions of a registered volume" },
      { { 0x0070, 0x0084 }, EVR_PN, "" } });
  std::vector<DcmItem> descriptions;
  std::vector<DcmItem> frames;
  for (std::size_t index = 0; index < segments.size(); ++index)
  {
    const auto number = static_cast<std::uint16_t>(index + 1);
    descriptions.push_back(Description(segments[index], number));
    frames.push_back(FrameGroups(image, number));
  }
  AddSequence(data, { 0x0062, 0x0002 }, descriptions);
  AddDimensions(data);
  AddReferencedSeries(data, image);
  AddSequence(data, { 0x5200, 0x9229 }, { DcmItem() });
  AddSequence(data, { 0x5200, 0x9230 }, frames);
  AddPixels(data, segments, image);
  WriteDicom(data, path);
}
}
