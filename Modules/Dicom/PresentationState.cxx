// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"
#include "Private/DicomFile.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

#include <array>

namespace mammoray
{
namespace
{

constexpr const char* Layer = "FINDINGS";

DcmItem Graphic(const std::string& type, const std::vector<float>& points)
{
  DcmItem item;
  AddTexts(item,
    { { { 0x0070, 0x0005 }, EVR_CS, "PIXEL" }, { { 0x0070, 0x0023 }, EVR_CS, type },
      { { 0x0070, 0x0024 }, EVR_CS, "N" } });
  AddShort(item, { 0x0070, 0x0020 }, 2);
  AddShort(item, { 0x0070, 0x0021 }, static_cast<std::uint16_t>(points.size() / 2));
  AddFloats(item, { 0x0070, 0x0022 }, points);
  return item;
}

DcmItem Annotation(const DicomFinding& finding, const std::string& text,
  const DicomReference& image)
{
  std::vector<DcmItem> graphics;
  std::vector<float> points;
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
  DcmItem label;
  AddTexts(label,
    { { { 0x0070, 0x0004 }, EVR_CS, "PIXEL" }, { { 0x0070, 0x0006 }, EVR_ST, text },
      { { 0x0070, 0x0015 }, EVR_CS, "Y" } });
  AddFloats(label, { 0x0070, 0x0014 }, points);
  DcmItem item;
  AddSequence(item, { 0x0008, 0x1140 }, { ImageReference(image) });
  AddTexts(item, { { { 0x0070, 0x0002 }, EVR_CS, Layer } });
  AddSequence(item, { 0x0070, 0x0008 }, { label });
  AddSequence(item, { 0x0070, 0x0009 }, graphics);
  return item;
}

/// The items of a sequence of tables of values.
std::vector<DcmItem> Tables(DcmItem& data, const DcmTagKey& sequence)
{
  std::vector<DcmItem> tables;
  DcmSequenceOfItems* items = nullptr;
  if (data.findAndGetSequence(sequence, items).bad())
  {
    return tables;
  }
  for (unsigned long index = 0; index < items->card(); ++index)
  {
    DcmItem& item = *items->getItem(index);
    const Uint16* descriptor = nullptr;
    const Uint16* values = nullptr;
    unsigned long three = 0;
    unsigned long count = 0;
    if (item.findAndGetUint16Array(DCM_LUTDescriptor, descriptor, &three).good() && three == 3 &&
      item.findAndGetUint16Array(DCM_LUTData, values, &count).good() && count > 0)
    {
      DcmItem table;
      AddBytes(table, { 0x0028, 0x3002 }, EVR_US, descriptor, 3 * sizeof *descriptor);
      AddTexts(table, { { { 0x0028, 0x3003 }, EVR_LO, DicomText(item, DCM_LUTExplanation) } });
      if (const std::string type = DicomText(item, DCM_ModalityLUTType); !type.empty())
      {
        AddTexts(table, { { { 0x0028, 0x3004 }, EVR_LO, type } });
      }
      AddBytes(table, { 0x0028, 0x3006 }, EVR_OW, values, count * sizeof *values);
      tables.push_back(table);
    }
  }
  return tables;
}

/// What turns stored values to those shown: a presentation state replaces all that the image says.
void AddDisplay(DcmItem& data, DcmItem& image)
{
  if (const auto tables = Tables(image, DCM_ModalityLUTSequence); !tables.empty())
  {
    AddSequence(data, { 0x0028, 0x3000 }, { tables.front() });
  }
  else if (const std::string slope = DicomText(image, DCM_RescaleSlope); !slope.empty())
  {
    AddTexts(data,
      { { { 0x0028, 0x1052 }, EVR_DS, DicomText(image, DCM_RescaleIntercept) },
        { { 0x0028, 0x1053 }, EVR_DS, slope }, { { 0x0028, 0x1054 }, EVR_LO, "US" } });
  }
  DcmItem values;
  const std::string centre = DicomText(image, DCM_WindowCenter);
  const std::string width = DicomText(image, DCM_WindowWidth);
  const auto tables = Tables(image, DCM_VOILUTSequence);
  if (!centre.empty() && !width.empty())
  {
    AddTexts(values,
      { { { 0x0028, 0x1050 }, EVR_DS, centre }, { { 0x0028, 0x1051 }, EVR_DS, width } });
    if (const std::string shape = DicomText(image, DCM_VOILUTFunction); !shape.empty())
    {
      AddTexts(values, { { { 0x0028, 0x1056 }, EVR_CS, shape } });
    }
  }
  else if (!tables.empty())
  {
    AddSequence(values, { 0x0028, 0x3010 }, { tables.front() });
  }
  if (values.card() > 0)
  {
    AddSequence(data, { 0x0028, 0x3110 }, { values });
  }
  const bool inverse = DicomText(image, DCM_PhotometricInterpretation) == "MONOCHROME1";
  AddTexts(data, { { { 0x2050, 0x0020 }, EVR_CS, inverse ? "INVERSE" : "IDENTITY" } });
}

void AddArea(DcmItem& data, const DicomReference& image)
{
  const std::array<std::int32_t, 2> first{ 1, 1 };
  const std::array<std::int32_t, 2> last{ image.Columns, image.Rows };
  DcmItem area;
  AddBytes(area, { 0x0070, 0x0052 }, EVR_SL, first.data(), sizeof first);
  AddBytes(area, { 0x0070, 0x0053 }, EVR_SL, last.data(), sizeof last);
  AddTexts(area,
    { { { 0x0070, 0x0100 }, EVR_CS, "SCALE TO FIT" }, { { 0x0070, 0x0102 }, EVR_IS, "1\\1" } });
  AddSequence(data, { 0x0070, 0x005a }, { area });
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
  const DicomReference image = ReadDicomReference(mammogram);
  const DicomFile file(mammogram, "a DICOM mammogram", DicomExtent::Header);
  DcmItem data;
  AddCommon(data, "1.2.840.10008.5.1.4.1.1.11.1", "PR", "Found by registration with MRI",
    image.Identity);
  AddTexts(data,
    { { { 0x0070, 0x0080 }, EVR_CS, "REGISTERED" },
      { { 0x0070, 0x0081 }, EVR_LO, "Places of the MRI on the mammogram" },
      { { 0x0070, 0x0082 }, EVR_DA, DicomText(data, { 0x0008, 0x0023 }) },
      { { 0x0070, 0x0083 }, EVR_TM, DicomText(data, { 0x0008, 0x0033 }) },
      { { 0x0070, 0x0084 }, EVR_PN, "" } });
  data.findAndDeleteElement(DcmTagKey(0x0008, 0x0023)); // of images
  data.findAndDeleteElement(DcmTagKey(0x0008, 0x0033));
  AddTexts(data, { { { 0x0020, 0x0060 }, EVR_CS, DicomText(file.Data(), DCM_ImageLaterality) } });
  AddSequence(data, { 0x0008, 0x1115 }, { SeriesReference(image, { 0x0008, 0x1140 }) });
  AddArea(data, image);
  std::vector<DcmItem> annotations;
  for (std::size_t index = 0; index < findings.size(); ++index)
  {
    annotations.push_back(Annotation(findings[index], texts[index], image));
  }
  AddSequence(data, { 0x0070, 0x0001 }, annotations);
  DcmItem layer;
  AddTexts(layer, { { { 0x0070, 0x0002 }, EVR_CS, Layer }, { { 0x0070, 0x0062 }, EVR_IS, "1" } });
  AddShort(layer, { 0x0070, 0x0066 }, 65535);
  AddSequence(data, { 0x0070, 0x0060 }, { layer });
  AddDisplay(data, file.Data());
  WriteDicom(data, path);
}
}
