// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"

#include "Private/DicomFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <cstdio>
#include <ctime>
#include <memory>

namespace mammoray
{
namespace
{
DcmElement& AddElement(DcmItem& data, const DcmTagKey& tag, DcmEVR representation)
{
  DcmElement* element = nullptr;
  DcmItem::newDicomElementWithVR(element, DcmTag(tag, DcmVR(representation)));
  if (!element || data.insert(element, OFTrue).bad())
  {
    delete element;
    throw Error("DICOM: an element cannot be made");
  }
  return *element;
}
}

void AddTexts(DcmItem& data, const std::vector<DicomTextElement>& elements)
{
  for (const DicomTextElement& element : elements)
  {
    AddElement(data, element.Tag, element.Representation).putString(element.Value.c_str());
  }
}

void AddBytes(DcmItem& data, const DcmTagKey& tag, DcmEVR representation, const void* bytes,
  std::size_t count)
{
  if (count > 0xfffffffe)
  {
    throw InputError(
      "DICOM: expected at most 4294967294 bytes in a value, found " + std::to_string(count));
  }
  DcmElement& element = AddElement(data, tag, representation);
  const auto number = static_cast<unsigned long>(count);
  OFCondition put;
  switch (representation)
  {
    case EVR_AT:
      for (unsigned long index = 0; index < number / 4; ++index)
      {
        const auto* words = static_cast<const Uint16*>(bytes) + 2 * index;
        put = element.putTagVal(DcmTagKey(words[0], words[1]), index);
      }
      break;
    case EVR_FL:
    case EVR_OF:
      put = element.putFloat32Array(static_cast<const Float32*>(bytes), number / 4);
      break;
    case EVR_FD:
      put = element.putFloat64Array(static_cast<const Float64*>(bytes), number / 8);
      break;
    case EVR_SL:
      put = element.putSint32Array(static_cast<const Sint32*>(bytes), number / 4);
      break;
    case EVR_UL:
      put = element.putUint32Array(static_cast<const Uint32*>(bytes), number / 4);
      break;
    case EVR_SS:
      put = element.putSint16Array(static_cast<const Sint16*>(bytes), number / 2);
      break;
    case EVR_OB:
      put = element.putUint8Array(static_cast<const Uint8*>(bytes), number);
      break;
    default:
      put = element.putUint16Array(static_cast<const Uint16*>(bytes), number / 2);
  }
  if (put.bad())
  {
    throw InputError(std::string("DICOM: a value cannot be stored (") + put.text() + ")");
  }
}

void AddFloats(DcmItem& data, const DcmTagKey& tag, const std::vector<float>& values)
{
  AddBytes(data, tag, EVR_FL, values.data(), sizeof(float) * values.size());
}

void AddDoubles(DcmItem& data, const DcmTagKey& tag, const std::vector<double>& values)
{
  AddBytes(data, tag, EVR_FD, values.data(), sizeof(double) * values.size());
}

void AddShort(DcmItem& data, const DcmTagKey& tag, std::uint16_t value)
{
  AddBytes(data, tag, EVR_US, &value, sizeof value);
}

void AddSequence(DcmItem& data, const DcmTagKey& tag, const std::vector<DcmItem>& items)
{
  auto sequence = std::make_unique<DcmSequenceOfItems>(DcmTag(tag, DcmVR(EVR_SQ)));
  for (const DcmItem& item : items)
  {
    sequence->insert(new DcmItem(item));
  }
  if (data.insert(sequence.get(), OFTrue).bad())
  {
    throw Error("DICOM: a sequence cannot be made");
  }
  static_cast<void>(sequence.release()); // the data set's now
}

DcmItem DicomCode(const std::string& value, const std::string& meaning, const std::string& scheme)
{
  DcmItem code;
  AddTexts(code,
    { { { 0x0008, 0x0100 }, EVR_SH, value }, { { 0x0008, 0x0102 }, EVR_SH, scheme },
      { { 0x0008, 0x0104 }, EVR_LO, meaning } });
  return code;
}

void AddCommon(DcmItem& data, const std::string& sopClassUid, const std::string& modality,
  const std::string& seriesDescription, const DicomIdentity& identity)
{
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char date[16];
  char time[16];
  std::strftime(date, sizeof date, "%Y%m%d", &local);
  std::strftime(time, sizeof time, "%H%M%S", &local);
  const bool newStudy = identity.StudyInstanceUid.empty();
  AddTexts(data,
    { { { 0x0008, 0x0016 }, EVR_UI, sopClassUid }, { { 0x0008, 0x0018 }, EVR_UI, NewUid() },
      { { 0x0008, 0x0020 }, EVR_DA, newStudy ? date : identity.StudyDate },
      { { 0x0008, 0x0023 }, EVR_DA, date },
      { { 0x0008, 0x0030 }, EVR_TM, newStudy ? time : identity.StudyTime },
      { { 0x0008, 0x0033 }, EVR_TM, time },
      { { 0x0008, 0x0050 }, EVR_SH, identity.AccessionNumber },
      { { 0x0008, 0x0060 }, EVR_CS, modality }, { { 0x0008, 0x0070 }, EVR_LO, "MammoRay" },
      { { 0x0008, 0x0090 }, EVR_PN, identity.ReferringPhysicianName },
      { { 0x0008, 0x103e }, EVR_LO, seriesDescription }, { { 0x0008, 0x1090 }, EVR_LO, "mammoray" },
      { { 0x0010, 0x0010 }, EVR_PN, identity.PatientName },
      { { 0x0010, 0x0020 }, EVR_LO, identity.PatientId },
      { { 0x0010, 0x0030 }, EVR_DA, identity.PatientBirthDate },
      { { 0x0010, 0x0040 }, EVR_CS, identity.PatientSex },
      // Software has no serial number; enhanced objects want a value.
      { { 0x0018, 0x1000 }, EVR_LO, "none" }, { { 0x0018, 0x1020 }, EVR_LO, MAMMORAY_VERSION },
      { { 0x0020, 0x000d }, EVR_UI, newStudy ? NewUid() : identity.StudyInstanceUid },
      { { 0x0020, 0x000e }, EVR_UI, NewUid() }, { { 0x0020, 0x0010 }, EVR_SH, identity.StudyId },
      { { 0x0020, 0x0011 }, EVR_IS, "1" }, { { 0x0020, 0x0013 }, EVR_IS, "1" } });
  if (!identity.CharacterSet.empty())
  {
    AddTexts(data, { { { 0x0008, 0x0005 }, EVR_CS, identity.CharacterSet } });
  }
}

DcmItem ImageReference(const DicomReference& image)
{
  DcmItem item;
  AddTexts(item,
    { { { 0x0008, 0x1150 }, EVR_UI, image.SopClassUid },
      { { 0x0008, 0x1155 }, EVR_UI, image.SopInstanceUid } });
  return item;
}

void AppendPixel(std::vector<float>& points, const std::array<double, 2>& pixel)
{
  points.push_back(static_cast<float>(pixel[0] + 0.5));
  points.push_back(static_cast<float>(pixel[1] + 0.5));
}

DcmItem SeriesReference(const DicomReference& image, const DcmTagKey& images)
{
  DcmItem series;
  AddSequence(series, images, { ImageReference(image) });
  AddTexts(series, { { { 0x0020, 0x000e }, EVR_UI, image.SeriesInstanceUid } });
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
  char uid[100];
  return dcmGenerateUniqueIdentifier(uid);
}

void WriteDicom(DcmItem& data, const std::string& path)
{
  const std::shared_ptr<void> quiet = SilenceDcmtk();
  DcmFileFormat file;
  for (unsigned long index = 0; index < data.card(); ++index)
  {
    file.getDataset()->insert(static_cast<DcmElement*>(data.getElement(index)->clone()), OFTrue);
  }
  WriteAtomicFile(path,
    [&](const std::string& staged)
    {
      const OFCondition saved = file.saveFile(staged.c_str(), EXS_LittleEndianExplicit,
        EET_UndefinedLength, EGL_withoutGL, EPD_withoutPadding);
      if (saved.bad())
      {
        throw InputError(path + ": cannot be written (" + saved.text() + ")");
      }
    });
}
}
