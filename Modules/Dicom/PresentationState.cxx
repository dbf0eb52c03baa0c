// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"
#include "Private/DicomFile.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

namespace mammoray
{
namespace
{
constexpr const char* Layer = "FINDINGS";

DcmItem Graphic(const std::string& type, const std::vector<double>& points)
{
  return Item({ { DCM_GraphicAnnotationUnits, "PIXEL" }, { DCM_GraphicType, type },
    { DCM_GraphicFilled, "N" }, { DCM_GraphicDimensions, 2 },
    { DCM_NumberOfGraphicPoints, points.size() / 2 }, { DCM_GraphicData, points } });
}

DcmItem Annotation(const DicomFinding& finding, const std::string& text, const DicomHeader& image)
{
  std::vector<DcmItem> graphics;
  std::vector<double> points;
  if (finding.Uncertainty)
  {
    for (const DicomFinding::Pixel& end : finding.Uncertainty->Ends)
    {
      AppendPixel(points, end);
    }
    graphics.push_back(Graphic("ELLIPSE", points));
  }
  for (const auto& outline : finding.Outlines)
  {
    points.clear();
    // A count is a number of 16 bits: every so many points of what has more.
    const std::size_t step = 1 + outline.size() / 60000;
    for (std::size_t index = 0; index < outline.size(); index += step)
    {
      AppendPixel(points, outline[index]);
    }
    AppendPixel(points, outline.front());
    graphics.push_back(Graphic("POLYLINE", points));
  }
  points.clear();
  AppendPixel(points, finding.Centre);
  graphics.push_back(Graphic("POINT", points));
  return Item({ { DCM_ReferencedImageSequence, ImageReference(image) }, { DCM_GraphicLayer, Layer },
    { DCM_GraphicObjectSequence, graphics },
    { DCM_TextObjectSequence,
      Item({ { DCM_AnchorPointAnnotationUnits, "PIXEL" }, { DCM_UnformattedTextValue, text },
        { DCM_AnchorPointVisibility, "Y" }, { DCM_AnchorPoint, points } }) } });
}

/// A copy of the first complete lookup table of a sequence. Empty if there is none.
std::vector<DcmItem> Table(DcmItem& data, const DcmTagKey& sequence)
{
  DcmItem* item = nullptr;
  for (signed long index = 0; data.findAndGetSequenceItem(sequence, item, index).good(); ++index)
  {
    const Uint16* descriptor = nullptr;
    const Uint16* values = nullptr;
    unsigned long three = 0;
    unsigned long count = 0;
    if (item->findAndGetUint16Array(DCM_LUTDescriptor, descriptor, &three).good() && three == 3 &&
      item->findAndGetUint16Array(DCM_LUTData, values, &count).good() && count > 0)
    {
      DcmItem table = Item({ { DcmTag(DCM_LUTDescriptor, DcmVR(EVR_US)),
                               std::vector<double>(descriptor, descriptor + 3) },
        { DCM_LUTExplanation, DicomText(*item, DCM_LUTExplanation) },
        { DCM_ModalityLUTType, IfAny(DicomText(*item, DCM_ModalityLUTType)) } });
      AddBulk(table, DCM_LUTData, std::vector<std::uint16_t>(values, values + count));
      return { table };
    }
  }
  return {};
}

/// Adds the mapping from stored to displayed values. A presentation state replaces the image's.
void AddDisplay(DcmItem& data, DcmItem& image)
{
  if (const auto table = Table(image, DCM_ModalityLUTSequence); !table.empty())
  {
    Add(data, { { DCM_ModalityLUTSequence, table } });
  }
  else if (const std::string slope = DicomText(image, DCM_RescaleSlope); !slope.empty())
  {
    Add(data,
      { { DCM_RescaleIntercept, DicomText(image, DCM_RescaleIntercept) },
        { DCM_RescaleSlope, slope }, { DCM_RescaleType, "US" } });
  }
  DcmItem values;
  const std::string centre = DicomText(image, DCM_WindowCenter);
  const std::string width = DicomText(image, DCM_WindowWidth);
  if (!centre.empty() && !width.empty())
  {
    Add(values,
      { { DCM_WindowCenter, centre }, { DCM_WindowWidth, width },
        { DCM_VOILUTFunction, IfAny(DicomText(image, DCM_VOILUTFunction)) } });
  }
  else if (const auto table = Table(image, DCM_VOILUTSequence); !table.empty())
  {
    Add(values, { { DCM_VOILUTSequence, table } });
  }
  if (values.card() > 0)
  {
    Add(data, { { DCM_SoftcopyVOILUTSequence, values } });
  }
  const bool inverse = DicomText(image, DCM_PhotometricInterpretation) == "MONOCHROME1";
  Add(data, { { DCM_PresentationLUTShape, inverse ? "INVERSE" : "IDENTITY" } });
}
}

void WritePresentationState(const std::vector<DicomFinding>& findings,
  const std::vector<std::string>& texts, const std::string& mammogram, const std::string& path)
{
  if (findings.empty() || texts.size() != findings.size())
  {
    throw InputError("presentation state: expected findings and a text for each, found " +
      std::to_string(findings.size()) + " and " + std::to_string(texts.size()));
  }
  const DicomHeader image = ReadMammogramHeader(mammogram);
  const DicomFile file(mammogram, "a DICOM mammogram", DicomExtent::Header);
  std::vector<DcmItem> annotations;
  for (std::size_t index = 0; index < findings.size(); ++index)
  {
    annotations.push_back(Annotation(findings[index], texts[index], image));
  }
  DcmItem data;
  AddCommon(data, UID_GrayscaleSoftcopyPresentationStateStorage, "PR",
    "Found by registration with MRI", image.Identity);
  Add(data,
    { { DCM_ContentLabel, "REGISTERED" },
      { DCM_ContentDescription, "Places of the MRI on the mammogram" },
      { DCM_PresentationCreationDate, DicomText(data, DCM_ContentDate) },
      { DCM_PresentationCreationTime, DicomText(data, DCM_ContentTime) },
      { DCM_ContentCreatorName, "" },
      { DCM_Laterality, DicomText(file.Data(), DCM_ImageLaterality) },
      { DCM_ReferencedSeriesSequence, SeriesReference(image, DCM_ReferencedImageSequence) },
      { DCM_DisplayedAreaSelectionSequence,
        Item({ { DCM_DisplayedAreaTopLeftHandCorner, { 1, 1 } },
          { DCM_DisplayedAreaBottomRightHandCorner,
            std::vector<double>{ 1.0 * image.Columns, 1.0 * image.Rows } },
          { DCM_PresentationSizeMode, "SCALE TO FIT" },
          { DCM_PresentationPixelAspectRatio, { 1, 1 } } }) },
      { DCM_GraphicAnnotationSequence, annotations },
      { DCM_GraphicLayerSequence,
        Item({ { DCM_GraphicLayer, Layer }, { DCM_GraphicLayerOrder, 1 },
          { DCM_GraphicLayerRecommendedDisplayGrayscaleValue, 65535 } }) } });
  data.findAndDeleteElement(DCM_ContentDate); // of images
  data.findAndDeleteElement(DCM_ContentTime);
  AddDisplay(data, file.Data());
  WriteDicom(data, path);
}
}
