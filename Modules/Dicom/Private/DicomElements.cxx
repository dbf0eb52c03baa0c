// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"

#include "Private/QuietGdcm.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <gdcmSequenceOfItems.h>
#include <gdcmUIDGenerator.h>
#include <gdcmWriter.h>

#include <cstdio>
#include <cstring>
#include <ctime>
#include <sstream>

namespace mammoray
{
std::string DicomText(const gdcm::DataSet& data, const gdcm::Tag& tag)
{
  if (!data.FindDataElement(tag))
  {
    return {};
  }
  const gdcm::ByteValue* bytes = data.GetDataElement(tag).GetByteValue();
  std::string text = bytes ? std::string(bytes->GetPointer(), bytes->GetLength()) : std::string();
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0'))
  {
    text.pop_back();
  }
  return text;
}

void AddTexts(gdcm::DataSet& data, const std::vector<DicomTextElement>& elements)
{
  for (const DicomTextElement& element : elements)
  {
    std::string value = element.Value;
    if (value.size() % 2 != 0)
    {
      value.push_back(element.Representation == gdcm::VR::UI ? '\0' : ' ');
    }
    AddBytes(data, element.Tag, element.Representation, value.data(), value.size());
  }
}

void AddBytes(gdcm::DataSet& data, const gdcm::Tag& tag, gdcm::VR::VRType representation,
  const void* bytes, std::size_t count)
{
  if (count > 0xfffffffe)
  {
    throw InputError(
      "DICOM: expected at most 4294967294 bytes in a value, found " + std::to_string(count));
  }
  std::vector<char> value(count + count % 2, '\0');
  if (count > 0)
  {
    std::memcpy(value.data(), bytes, count);
  }
  gdcm::DataElement element(tag);
  element.SetVR(representation);
  element.SetByteValue(value.data(), gdcm::VL(static_cast<std::uint32_t>(value.size())));
  data.Replace(element);
}

void AddFloats(gdcm::DataSet& data, const gdcm::Tag& tag, const std::vector<float>& values)
{
  AddBytes(data, tag, gdcm::VR::FL, values.data(), sizeof(float) * values.size());
}

void AddDoubles(gdcm::DataSet& data, const gdcm::Tag& tag, const std::vector<double>& values)
{
  AddBytes(data, tag, gdcm::VR::FD, values.data(), sizeof(double) * values.size());
}

void AddShort(gdcm::DataSet& data, const gdcm::Tag& tag, std::uint16_t value)
{
  AddBytes(data, tag, gdcm::VR::US, &value, sizeof value);
}

void AddSequence(gdcm::DataSet& data, const gdcm::Tag& tag, const std::vector<gdcm::DataSet>& items)
{
  const gdcm::SmartPointer<gdcm::SequenceOfItems> sequence = new gdcm::SequenceOfItems;
  sequence->SetLengthToUndefined();
  for (const gdcm::DataSet& content : items)
  {
    gdcm::Item item;
    item.SetVLToUndefined();
    item.SetNestedDataSet(content);
    sequence->AddItem(item);
  }
  gdcm::DataElement element(tag);
  element.SetVR(gdcm::VR::SQ);
  element.SetValue(*sequence);
  element.SetVLToUndefined();
  data.Replace(element);
}

gdcm::DataSet DicomCode(const std::string& value, const std::string& meaning,
  const std::string& scheme)
{
  gdcm::DataSet code;
  AddTexts(code,
    { { { 0x0008, 0x0100 }, gdcm::VR::SH, value }, { { 0x0008, 0x0102 }, gdcm::VR::SH, scheme },
      { { 0x0008, 0x0104 }, gdcm::VR::LO, meaning } });
  return code;
}

void AddCommon(gdcm::DataSet& data, const std::string& sopClassUid, const std::string& modality,
  const std::string& seriesDescription, const DicomIdentity& identity)
{
  using gdcm::VR;
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char date[16];
  char time[16];
  std::strftime(date, sizeof date, "%Y%m%d", &local);
  std::strftime(time, sizeof time, "%H%M%S", &local);
  const bool newStudy = identity.StudyInstanceUid.empty();
  AddTexts(data,
    { { { 0x0008, 0x0016 }, VR::UI, sopClassUid }, { { 0x0008, 0x0018 }, VR::UI, NewUid() },
      { { 0x0008, 0x0020 }, VR::DA, newStudy ? date : identity.StudyDate },
      { { 0x0008, 0x0023 }, VR::DA, date },
      { { 0x0008, 0x0030 }, VR::TM, newStudy ? time : identity.StudyTime },
      { { 0x0008, 0x0033 }, VR::TM, time },
      { { 0x0008, 0x0050 }, VR::SH, identity.AccessionNumber },
      { { 0x0008, 0x0060 }, VR::CS, modality }, { { 0x0008, 0x0070 }, VR::LO, "MammoRay" },
      { { 0x0008, 0x0090 }, VR::PN, identity.ReferringPhysicianName },
      { { 0x0008, 0x103e }, VR::LO, seriesDescription }, { { 0x0008, 0x1090 }, VR::LO, "mammoray" },
      { { 0x0010, 0x0010 }, VR::PN, identity.PatientName },
      { { 0x0010, 0x0020 }, VR::LO, identity.PatientId },
      { { 0x0010, 0x0030 }, VR::DA, identity.PatientBirthDate },
      { { 0x0010, 0x0040 }, VR::CS, identity.PatientSex },
      // Software has no serial number; enhanced objects want a value.
      { { 0x0018, 0x1000 }, VR::LO, "none" }, { { 0x0018, 0x1020 }, VR::LO, MAMMORAY_VERSION },
      { { 0x0020, 0x000d }, VR::UI, newStudy ? NewUid() : identity.StudyInstanceUid },
      { { 0x0020, 0x000e }, VR::UI, NewUid() }, { { 0x0020, 0x0010 }, VR::SH, identity.StudyId },
      { { 0x0020, 0x0011 }, VR::IS, "1" }, { { 0x0020, 0x0013 }, VR::IS, "1" } });
  if (!identity.CharacterSet.empty())
  {
    AddTexts(data, { { { 0x0008, 0x0005 }, VR::CS, identity.CharacterSet } });
  }
}

gdcm::DataSet ImageReference(const DicomReference& image)
{
  gdcm::DataSet item;
  AddTexts(item,
    { { { 0x0008, 0x1150 }, gdcm::VR::UI, image.SopClassUid },
      { { 0x0008, 0x1155 }, gdcm::VR::UI, image.SopInstanceUid } });
  return item;
}

void AppendPixel(std::vector<float>& points, const std::array<double, 2>& pixel)
{
  points.push_back(static_cast<float>(pixel[0] + 0.5));
  points.push_back(static_cast<float>(pixel[1] + 0.5));
}

gdcm::DataSet SeriesReference(const DicomReference& image, const gdcm::Tag& images)
{
  gdcm::DataSet series;
  AddSequence(series, images, { ImageReference(image) });
  AddTexts(series, { { { 0x0020, 0x000e }, gdcm::VR::UI, image.SeriesInstanceUid } });
  return series;
}

std::string DecimalString(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

std::string NewUid()
{
  gdcm::UIDGenerator generator;
  return generator.Generate();
}

void WriteDicom(const gdcm::DataSet& data, const std::string& path)
{
  const QuietGdcm quiet;
  gdcm::Writer writer;
  writer.GetFile().SetDataSet(data);
  writer.GetFile().GetHeader().SetDataSetTransferSyntax(
    gdcm::TransferSyntax::ExplicitVRLittleEndian);
  // To a file, GDCM asserts where it cannot be opened or is full.
  std::ostringstream file;
  writer.SetStream(file);
  if (!writer.Write())
  {
    throw InputError(path + ": cannot be written");
  }
  WriteAtomicFile(path, file.str());
}
}
