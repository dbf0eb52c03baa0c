// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"

#include "Private/DicomFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>

namespace mammoray
{
namespace
{
DcmElement& AddElement(DcmItem& data, const DcmTag& tag)
{
  DcmElement* element = nullptr;
  DcmItem::newDicomElementWithVR(element, tag);
  if (!element || data.insert(element, OFTrue).bad())
  {
    delete element;
    throw Error("DICOM: an element cannot be made");
  }
  return *element;
}

void Require(const OFCondition& done)
{
  if (done.bad())
  {
    throw InputError(std::string("DICOM: a value cannot be stored (") + done.text() + ")");
  }
}

std::string DecimalStrings(const std::vector<double>& numbers)
{
  std::string text;
  for (const double number : numbers)
  {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.10g", number);
    text.append(text.empty() ? "" : "\\").append(digits);
  }
  return text;
}

template <typename T>
std::vector<T> Rounded(const std::vector<double>& numbers)
{
  std::vector<T> rounded;
  rounded.reserve(numbers.size());
  for (const double number : numbers)
  {
    rounded.push_back(static_cast<T>(std::lround(number)));
  }
  return rounded;
}

OFCondition PutNumbers(DcmElement& element, const std::vector<double>& numbers)
{
  const auto count = static_cast<unsigned long>(numbers.size());
  switch (element.getVR())
  {
    case EVR_FL:
      return element.putFloat32Array(std::vector<Float32>(numbers.begin(), numbers.end()).data(),
        count);
    case EVR_FD:
      return element.putFloat64Array(numbers.data(), count);
    case EVR_SL:
      return element.putSint32Array(Rounded<Sint32>(numbers).data(), count);
    case EVR_UL:
      return element.putUint32Array(Rounded<Uint32>(numbers).data(), count);
    case EVR_SS:
      return element.putSint16Array(Rounded<Sint16>(numbers).data(), count);
    case EVR_US:
      return element.putUint16Array(Rounded<Uint16>(numbers).data(), count);
    default:
      return element.putString(DecimalStrings(numbers).c_str());
  }
}

void AddItems(DcmItem& data, const DcmTag& tag, const std::vector<DcmItem>& items)
{
  auto sequence = std::make_unique<DcmSequenceOfItems>(tag);
  for (const DcmItem& item : items)
  {
    sequence->insert(new DcmItem(item));
  }
  if (data.insert(sequence.get(), OFTrue).bad())
  {
    throw Error("DICOM: a sequence cannot be made");
  }
  static_cast<void>(sequence.release()); // the data set owns it now
}

/// Adds an element for values that are `bytes` long.
DcmElement& AddLong(DcmItem& data, const DcmTagKey& tag, DcmEVR representation, std::size_t bytes)
{
  if (bytes > 0xfffffffe)
  {
    throw InputError(
      "DICOM: expected at most 4294967294 bytes in a value, found " + std::to_string(bytes));
  }
  return AddElement(data, DcmTag(tag, DcmVR(representation)));
}
}

void Add(DcmItem& data, std::initializer_list<DicomElement> elements)
{
  for (const DicomElement& element : elements)
  {
    if (const auto* items = std::get_if<std::vector<DcmItem>>(&element.Value))
    {
      AddItems(data, element.Tag, *items);
    }
    else if (const auto* text = std::get_if<std::string>(&element.Value))
    {
      Require(AddElement(data, element.Tag).putString(text->c_str()));
    }
    else if (const auto& numbers = std::get<std::vector<double>>(element.Value); !numbers.empty())
    {
      Require(PutNumbers(AddElement(data, element.Tag), numbers));
    }
  }
}

DcmItem Item(std::initializer_list<DicomElement> elements)
{
  DcmItem item;
  Add(item, elements);
  return item;
}

void AddBulk(DcmItem& data, const DcmTagKey& tag, const std::vector<std::uint8_t>& values)
{
  Require(AddLong(data, tag, EVR_OB, values.size()).putUint8Array(values.data(), values.size()));
}

void AddBulk(DcmItem& data, const DcmTagKey& tag, const std::vector<std::uint16_t>& values)
{
  Require(
    AddLong(data, tag, EVR_OW, 2 * values.size()).putUint16Array(values.data(), values.size()));
}

void AddBulk(DcmItem& data, const DcmTagKey& tag, const std::vector<float>& values)
{
  Require(
    AddLong(data, tag, EVR_OF, 4 * values.size()).putFloat32Array(values.data(), values.size()));
}

void AddPixelDescription(DcmItem& data, int columns, int rows, int bits,
  const std::string& photometric)
{
  Add(data,
    { { DCM_SamplesPerPixel, 1 }, { DCM_PhotometricInterpretation, photometric },
      { DCM_Rows, rows }, { DCM_Columns, columns }, { DCM_BitsAllocated, bits },
      { DCM_BitsStored, bits }, { DCM_HighBit, bits - 1 }, { DCM_PixelRepresentation, 0 } });
}

DcmItem DicomCode(const std::string& value, const std::string& meaning, const std::string& scheme)
{
  return Item({ { DCM_CodeValue, value }, { DCM_CodingSchemeDesignator, scheme },
    { DCM_CodeMeaning, meaning } });
}

void AddCommon(DcmItem& data, const std::string& sopClassUid, const std::string& modality,
  const std::string& seriesDescription, const DicomIdentity& identity)
{
  const std::string now = TimeNow("%Y%m%d%H%M%S");
  const std::string date = now.substr(0, 8);
  const std::string time = now.substr(8);
  const bool newStudy = identity.StudyInstanceUid.empty();
  Add(data,
    { { DCM_SOPClassUID, sopClassUid }, { DCM_SOPInstanceUID, NewUid() },
      { DCM_StudyDate, newStudy ? date : identity.StudyDate }, { DCM_ContentDate, date },
      { DCM_StudyTime, newStudy ? time : identity.StudyTime }, { DCM_ContentTime, time },
      { DCM_AccessionNumber, identity.AccessionNumber }, { DCM_Modality, modality },
      { DCM_Manufacturer, "MammoRay" },
      { DCM_ReferringPhysicianName, identity.ReferringPhysicianName },
      { DCM_SeriesDescription, seriesDescription }, { DCM_ManufacturerModelName, "mammoray" },
      { DCM_PatientName, identity.PatientName }, { DCM_PatientID, identity.PatientId },
      { DCM_PatientBirthDate, identity.PatientBirthDate }, { DCM_PatientSex, identity.PatientSex },
      // Software has no serial number; enhanced objects want a value.
      { DCM_DeviceSerialNumber, "none" }, { DCM_SoftwareVersions, MAMMORAY_VERSION },
      { DCM_StudyInstanceUID, newStudy ? NewUid() : identity.StudyInstanceUid },
      { DCM_SeriesInstanceUID, NewUid() }, { DCM_StudyID, identity.StudyId },
      { DCM_SeriesNumber, 1 }, { DCM_InstanceNumber, 1 } });
  if (!identity.CharacterSet.empty())
  {
    Add(data, { { DCM_SpecificCharacterSet, identity.CharacterSet } });
  }
}

DcmItem ImageReference(const DicomHeader& image)
{
  return Item({ { DCM_ReferencedSOPClassUID, image.SopClassUid },
    { DCM_ReferencedSOPInstanceUID, image.SopInstanceUid } });
}

void AppendPixel(std::vector<double>& points, const std::array<double, 2>& pixel)
{
  points.push_back(pixel[0] + 0.5);
  points.push_back(pixel[1] + 0.5);
}

DcmItem SeriesReference(const DicomHeader& image, const DcmTagKey& images)
{
  return Item(
    { { images, ImageReference(image) }, { DCM_SeriesInstanceUID, image.SeriesInstanceUid } });
}

std::string NewUid()
{
  char uid[100];
  return dcmGenerateUniqueIdentifier(uid);
}

std::string TimeNow(const char* format)
{
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[24];
  std::strftime(text, sizeof text, format, &local);
  return text;
}

void WriteDicom(DcmItem& data, const std::string& path)
{
  if (!dcmDataDict.isDictionaryLoaded())
  {
    throw Error("DICOM: expected DCMTK's data dictionary (dicom.dic), found none");
  }
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
