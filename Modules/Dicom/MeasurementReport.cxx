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
DcmItem Dcm(const char* value, const char* meaning)
{
  return DicomCode(value, meaning, "DCM");
}

/// A content item with its relation to the item that contains it, and the elements of its type.
DcmItem Content(const char* relation, const char* type, const DcmItem& name,
  std::initializer_list<DicomElement> values)
{
  DcmItem item = Item({ { DCM_RelationshipType, relation }, { DCM_ValueType, type },
    { DCM_ConceptNameCodeSequence, name } });
  Add(item, values);
  return item;
}

DcmItem Code(const char* relation, const DcmItem& name, const DcmItem& value)
{
  return Content(relation, "CODE", name, { { DCM_ConceptCodeSequence, value } });
}

/// A text in ASCII, which is part of every character set that a patient's name may need.
DcmItem Text(const char* relation, const DcmItem& name, std::string value)
{
  std::replace_if(
    value.begin(), value.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e || c == '\\'; },
    '?');
  return Content(relation, "TEXT", name, { { DCM_TextValue, value } });
}

DcmItem Uid(const char* relation, const DcmItem& name, const std::string& value)
{
  return Content(relation, "UIDREF", name, { { DCM_UID, value } });
}

DcmItem Container(const char* relation, const DcmItem& name, const std::vector<DcmItem>& content,
  const char* templateNumber = nullptr)
{
  DcmItem item = Content(relation, "CONTAINER", name,
    { { DCM_ContinuityOfContent, "SEPARATE" }, { DCM_ContentSequence, content } });
  if (templateNumber)
  {
    Add(item,
      { { DCM_ContentTemplateSequence,
        Item({ { DCM_MappingResource, "DCMR" }, { DCM_TemplateIdentifier, templateNumber } }) } });
  }
  return item;
}

DcmItem Image(const char* relation, const DicomHeader& image)
{
  return Item({ { DCM_RelationshipType, relation }, { DCM_ValueType, "IMAGE" },
    { DCM_ReferencedSOPSequence, ImageReference(image) } });
}

/// On the mammogram.
DcmItem Region(const char* relation, const DcmItem& name, const char* type,
  const std::vector<DicomFinding::Pixel>& pixels, const DicomHeader& image)
{
  std::vector<double> points;
  for (const DicomFinding::Pixel& pixel : pixels)
  {
    AppendPixel(points, pixel);
  }
  return Content(relation, "SCOORD", name,
    { { DCM_GraphicData, points }, { DCM_GraphicType, type },
      { DCM_ContentSequence, Image("SELECTED FROM", image) } });
}

/// One standard deviation along an axis of the ellipse on the receptor.
DcmItem Deviation(const DcmItem& axis, double sigmaMm, const DicomFinding::Ellipse& ellipse,
  const DicomHeader& image)
{
  return Content("CONTAINS", "NUM", axis,
    { { DCM_MeasuredValueSequence,
        Item({ { DCM_NumericValue, sigmaMm },
          { DCM_MeasurementUnitsCodeSequence, DicomCode("mm", "mm", "UCUM") } }) },
      { DCM_ContentSequence,
        std::vector<DcmItem>{ Code("HAS CONCEPT MOD", Dcm("121401", "Derivation"),
                                DicomCode("386136009", "Standard Deviation")),
          Region("INFERRED FROM", Dcm("121112", "Source of Measurement"), "ELLIPSE",
            { ellipse.Ends.begin(), ellipse.Ends.end() }, image) } } });
}

DcmItem Group(const DicomFinding& finding, const DicomReportContext& context,
  const DicomHeader& image)
{
  const DcmItem side =
    context.Laterality == 'L' ? DicomCode("7771000", "Left") : DicomCode("24028007", "Right");
  DcmItem site = Code("HAS CONCEPT MOD", DicomCode("363698007", "Finding Site"),
    DicomCode("76752008", "Breast"));
  Add(site,
    { { DCM_ContentSequence,
      Code("HAS CONCEPT MOD", DicomCode("272741003", "Laterality"), side) } });
  const DcmItem region = Dcm("111030", "Image Region");
  std::vector<DcmItem> content{ Text("HAS OBS CONTEXT", Dcm("112039", "Tracking Identifier"),
                                  finding.Label),
    Uid("HAS OBS CONTEXT", Dcm("112040", "Tracking Unique Identifier"), NewUid()),
    Code("CONTAINS", Dcm("121071", "Finding"), DicomCode("52988006", "Lesion")), site };
  if (!context.VolumeFrameUid.empty())
  {
    content.push_back(Content("CONTAINS", "SCOORD3D", region,
      { { DCM_GraphicData, finding.VolumePoint }, { DCM_GraphicType, "POINT" },
        { DCM_ReferencedFrameOfReferenceUID, context.VolumeFrameUid } }));
  }
  content.push_back(Region("CONTAINS", region, "POINT", { finding.Centre }, image));
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
}

void WriteMeasurementReport(const std::vector<DicomFinding>& findings,
  const DicomReportContext& context, const DicomHeader& mammogram, const std::string& path)
{
  if (findings.empty())
  {
    throw InputError("report: expected findings, found none");
  }
  std::vector<DcmItem> groups;
  for (const DicomFinding& finding : findings)
  {
    CheckDicomText(finding.Label, "finding's label");
    groups.push_back(Group(finding, context, mammogram));
  }
  const char* const observer = "HAS OBS CONTEXT"; // this software (TID 1001, 1004)
  DcmItem data = Container("", Dcm("126000", "Imaging Measurement Report"),
    { Code("HAS CONCEPT MOD", Dcm("121049", "Language of Content Item and Descendants"),
        DicomCode("en", "English", "RFC5646")),
      Code(observer, Dcm("121005", "Observer Type"), Dcm("121007", "Device")),
      Uid(observer, Dcm("121012", "Device Observer UID"), NewUid()),
      Text(observer, Dcm("121013", "Device Observer Name"), "mammoray"),
      Text(observer, Dcm("121014", "Device Observer Manufacturer"), "MammoRay"),
      Text(observer, Dcm("121015", "Device Observer Model Name"), "mammoray " MAMMORAY_VERSION),
      Code("HAS CONCEPT MOD", Dcm("121058", "Procedure reported"),
        DicomCode("71651007", "Mammography")),
      Container("CONTAINS", Dcm("111028", "Image Library"),
        { Container("CONTAINS", Dcm("126200", "Image Library Group"),
          { Image("CONTAINS", mammogram) }) },
        "1600"),
      Container("CONTAINS", Dcm("126010", "Imaging Measurements"), groups) },
    "1500");
  data.findAndDeleteElement(DCM_RelationshipType); // the root stands in none
  AddCommon(data, UID_Comprehensive3DSRStorage, "SR", "Found by registration with MRI",
    mammogram.Identity);
  Add(data,
    { { DCM_CompletionFlag, "COMPLETE" }, { DCM_VerificationFlag, "UNVERIFIED" },
      { DCM_ReferencedPerformedProcedureStepSequence, NoItems },
      { DCM_PerformedProcedureCodeSequence, NoItems },
      { DCM_CurrentRequestedProcedureEvidenceSequence,
        Item(
          { { DCM_ReferencedSeriesSequence, SeriesReference(mammogram, DCM_ReferencedSOPSequence) },
            { DCM_StudyInstanceUID, mammogram.Identity.StudyInstanceUid } }) } });
  WriteDicom(data, path);
}
}
