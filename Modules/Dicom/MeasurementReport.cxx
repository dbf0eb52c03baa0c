// SPDX-License-Identifier: Apache-2.0
// Content items as PS3.3 section C.17.3 has them, arranged as templates 1500 and 1501 of PS3.16
// say.
#include "Private/DicomElements.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>

namespace mammoray
{
namespace
{
using Item = DcmItem;

Item Dcm(const char* value, const char* meaning)
{
  return DicomCode(value, meaning, "DCM");
}

/// An item with its relation to the one it stands in.
Item Content(const char* relation, const char* type, const Item& name)
{
  Item item;
  AddTexts(item,
    { { { 0x0040, 0xa010 }, EVR_CS, relation }, { { 0x0040, 0xa040 }, EVR_CS, type } });
  AddSequence(item, { 0x0040, 0xa043 }, { name });
  return item;
}

Item Code(const char* relation, const Item& name, const Item& value,
  const std::vector<Item>& content = {})
{
  Item item = Content(relation, "CODE", name);
  AddSequence(item, { 0x0040, 0xa168 }, { value });
  if (!content.empty())
  {
    AddSequence(item, { 0x0040, 0xa730 }, content);
  }
  return item;
}

/// What stands in the report whatever the patient's character set is.
std::string Ascii(std::string text)
{
  std::replace_if(
    text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e || c == '\\'; },
    '?');
  return text;
}

Item Text(const char* relation, const Item& name, const std::string& value)
{
  Item item = Content(relation, "TEXT", name);
  AddTexts(item, { { { 0x0040, 0xa160 }, EVR_UT, Ascii(value) } });
  return item;
}

Item Uid(const char* relation, const Item& name, const std::string& value)
{
  Item item = Content(relation, "UIDREF", name);
  AddTexts(item, { { { 0x0040, 0xa124 }, EVR_UI, value } });
  return item;
}

Item Container(const char* relation, const Item& name, const std::vector<Item>& content,
  const char* templateNumber = nullptr)
{
  Item item = Content(relation, "CONTAINER", name);
  AddTexts(item, { { { 0x0040, 0xa050 }, EVR_CS, "SEPARATE" } });
  if (templateNumber)
  {
    Item form;
    AddTexts(form,
      { { { 0x0008, 0x0105 }, EVR_CS, "DCMR" }, { { 0x0040, 0xdb00 }, EVR_CS, templateNumber } });
    AddSequence(item, { 0x0040, 0xa504 }, { form });
  }
  AddSequence(item, { 0x0040, 0xa730 }, content);
  return item;
}

Item Image(const char* relation, const DicomReference& image)
{
  Item item;
  AddTexts(item,
    { { { 0x0040, 0xa010 }, EVR_CS, relation }, { { 0x0040, 0xa040 }, EVR_CS, "IMAGE" } });
  AddSequence(item, { 0x0008, 0x1199 }, { ImageReference(image) });
  return item;
}

/// On the mammogram.
Item Region(const char* relation, const Item& name, const char* type,
  const std::vector<DicomFinding::Pixel>& pixels, const DicomReference& image)
{
  Item item = Content(relation, "SCOORD", name);
  std::vector<float> points;
  for (const DicomFinding::Pixel& pixel : pixels)
  {
    AppendPixel(points, pixel);
  }
  AddFloats(item, { 0x0070, 0x0022 }, points);
  AddTexts(item, { { { 0x0070, 0x0023 }, EVR_CS, type } });
  AddSequence(item, { 0x0040, 0xa730 }, { Image("SELECTED FROM", image) });
  return item;
}

Item VolumePoint(const DicomFinding& finding, const std::string& frameUid)
{
  Item item = Content("CONTAINS", "SCOORD3D", Dcm("111030", "Image Region"));
  const Vector3& point = finding.VolumePoint;
  AddFloats(item, { 0x0070, 0x0022 },
    { static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2]) });
  AddTexts(item,
    { { { 0x0070, 0x0023 }, EVR_CS, "POINT" }, { { 0x3006, 0x0024 }, EVR_UI, frameUid } });
  return item;
}

/// One standard deviation along an axis of the ellipse on the receptor.
Item Deviation(const Item& axis, double sigmaMm, const DicomFinding::Ellipse& ellipse,
  const DicomReference& image)
{
  Item number;
  AddTexts(number, { { { 0x0040, 0xa30a }, EVR_DS, DecimalString(sigmaMm) } });
  AddSequence(number, { 0x0040, 0x08ea }, { DicomCode("mm", "mm", "UCUM") });
  Item item = Content("CONTAINS", "NUM", axis);
  AddSequence(item, { 0x0040, 0xa300 }, { number });
  AddSequence(item, { 0x0040, 0xa730 },
    { Code("HAS CONCEPT MOD", Dcm("121401", "Derivation"),
        DicomCode("386136009", "Standard Deviation")),
      Region("INFERRED FROM", Dcm("121112", "Source of Measurement"), "ELLIPSE",
        { ellipse.Ends.begin(), ellipse.Ends.end() }, image) });
  return item;
}

Item Group(const DicomFinding& finding, const DicomReportContext& context,
  const DicomReference& image)
{
  const Item side =
    context.Laterality == 'L' ? DicomCode("7771000", "Left") : DicomCode("24028007", "Right");
  std::vector<Item> content{ Text("HAS OBS CONTEXT", Dcm("112039", "Tracking Identifier"),
                               finding.Label),
    Uid("HAS OBS CONTEXT", Dcm("112040", "Tracking Unique Identifier"), NewUid()),
    Code("CONTAINS", Dcm("121071", "Finding"), DicomCode("52988006", "Lesion")),
    Code("HAS CONCEPT MOD", DicomCode("363698007", "Finding Site"), DicomCode("76752008", "Breast"),
      { Code("HAS CONCEPT MOD", DicomCode("272741003", "Laterality"), side) }) };
  if (!context.VolumeFrameUid.empty())
  {
    content.push_back(VolumePoint(finding, context.VolumeFrameUid));
  }
  content.push_back(
    Region("CONTAINS", Dcm("111030", "Image Region"), "POINT", { finding.Centre }, image));
  if (const auto& ellipse = finding.Uncertainty)
  {
    content.push_back(
      Deviation(DicomCode("103339001", "Long Axis"), ellipse->MajorSigmaMm, *ellipse, image));
    content.push_back(
      Deviation(DicomCode("103340004", "Short Axis"), ellipse->MinorSigmaMm, *ellipse, image));
  }
  content.push_back(Code("CONTAINS", DicomCode("trust", "Trust in the registration", OwnCodes),
    DicomCode(std::string("trust-").append(context.Trust), context.Trust, OwnCodes)));
  for (const std::string& reason : context.Reasons)
  {
    content.push_back(Text("CONTAINS", Dcm("121106", "Comment"), reason));
  }
  return Container("CONTAINS", Dcm("125007", "Measurement Group"), content, "1501");
}

/// This software as the observer (TID 1001, 1004).
std::vector<Item> Observer()
{
  const char* const context = "HAS OBS CONTEXT";
  return { Code(context, Dcm("121005", "Observer Type"), Dcm("121007", "Device")),
    Uid(context, Dcm("121012", "Device Observer UID"), NewUid()),
    Text(context, Dcm("121013", "Device Observer Name"), "mammoray"),
    Text(context, Dcm("121014", "Device Observer Manufacturer"), "MammoRay"),
    Text(context, Dcm("121015", "Device Observer Model Name"), "mammoray " MAMMORAY_VERSION) };
}

void AddDocument(DcmItem& data, const DicomReference& image)
{
  AddTexts(data,
    { { { 0x0040, 0xa491 }, EVR_CS, "COMPLETE" }, { { 0x0040, 0xa493 }, EVR_CS, "UNVERIFIED" } });
  AddSequence(data, { 0x0008, 0x1111 }, {}); // performed procedure step
  AddSequence(data, { 0x0040, 0xa372 }, {}); // performed procedure code
  DcmItem evidence;
  AddSequence(evidence, { 0x0008, 0x1115 }, { SeriesReference(image, { 0x0008, 0x1199 }) });
  AddTexts(evidence, { { { 0x0020, 0x000d }, EVR_UI, image.Identity.StudyInstanceUid } });
  AddSequence(data, { 0x0040, 0xa375 }, { evidence });
}
}

void WriteMeasurementReport(const std::vector<DicomFinding>& findings,
  const DicomReportContext& context, const DicomReference& mammogram, const std::string& path)
{
  if (findings.empty())
  {
    throw InputError("report: expected findings, found none");
  }
  std::vector<Item> content{ Code("HAS CONCEPT MOD",
    Dcm("121049", "Language of Content Item and Descendants"),
    DicomCode("en", "English", "RFC5646")) };
  const std::vector<Item> observer = Observer();
  content.insert(content.end(), observer.begin(), observer.end());
  content.push_back(Code("HAS CONCEPT MOD", Dcm("121058", "Procedure reported"),
    DicomCode("71651007", "Mammography")));
  content.push_back(Container("CONTAINS", Dcm("111028", "Image Library"),
    { Container("CONTAINS", Dcm("126200", "Image Library Group"),
      { Image("CONTAINS", mammogram) }) },
    "1600"));
  std::vector<Item> groups;
  groups.reserve(findings.size());
  for (const DicomFinding& finding : findings)
  {
    CheckDicomText(finding.Label, "finding's label");
    groups.push_back(Group(finding, context, mammogram));
  }
  content.push_back(Container("CONTAINS", Dcm("126010", "Imaging Measurements"), groups));

  DcmItem data = Container("", Dcm("126000", "Imaging Measurement Report"), content, "1500");
  data.findAndDeleteElement(DcmTagKey(0x0040, 0xa010)); // the root stands in none
  AddCommon(data, "1.2.840.10008.5.1.4.1.1.88.34", "SR", "Found by registration with MRI",
    mammogram.Identity);
  AddDocument(data, mammogram);
  WriteDicom(data, path);
}
}
