// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomFile.h"

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Error.h"

#include <dcmtk/dcmdata/dcistrmf.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <locale>
#include <mutex>
#include <sstream>

namespace mammoray
{
namespace
{
/// While one lives, DCMTK logs nothing; what the user needs is in our exceptions.
class QuietDcmtk
{
public:
  QuietDcmtk() { this->Logger.setLogLevel(OFLogger::OFF_LOG_LEVEL); }
  ~QuietDcmtk() { this->Logger.setLogLevel(this->Level); }
  QuietDcmtk(const QuietDcmtk&) = delete;
  QuietDcmtk& operator=(const QuietDcmtk&) = delete;

private:
  OFLogger Logger = OFLog::getLogger("dcmtk");
  const dcmtk::log4cplus::LogLevel Level = this->Logger.getLogLevel();
};

/// A file that ends where more was read of it than headers hold: a terabyte of nothing takes no
/// room on a disk, but hours as elements without values; a deflated value of gigabytes takes a
/// thousandth of them. Long values that are not deflated, the pixels among them, are passed over
/// and do not count. It ends, too, where sequences lie in one another so deep that DCMTK, which
/// reads them by recursion, would leave its stack.
class HeaderStream : public DcmInputFileStream
{
public:
  HeaderStream(const std::string& path, offile_off_t most)
    : DcmInputFileStream(path.c_str())
    , Most(most)
  {
  }
  /// The reason why this is no header; empty if it may be one.
  const char* Excess() const
  {
    return this->IsTooDeep ? "sequences nested too deep"
      : this->Count > Most ? "a header of more than 8 MiB"
                           : "";
  }
  OFBool eos() override { return this->Ends() || DcmInputFileStream::eos(); }
  offile_off_t avail() override { return this->Ends() ? 0 : DcmInputFileStream::avail(); }
  offile_off_t read(void* bytes, offile_off_t most) override
  {
    const auto depth = std::abs(this->Base - static_cast<const char*>(__builtin_frame_address(0)));
    this->IsTooDeep = this->IsTooDeep || depth > MostStack;
    if (this->Ends())
    {
      return 0;
    }
    const offile_off_t count =
      DcmInputFileStream::read(bytes, std::min(most, this->Most + 1 - this->Count));
    this->Count += count;
    return count;
  }

private:
  bool Ends() const { return this->IsTooDeep || this->Count > Most; }

  /// Bytes, of a hundred sequences at least; standard objects have six in one another.
  static constexpr std::ptrdiff_t MostStack = 512 << 10;
  const char* const Base = static_cast<const char*>(__builtin_frame_address(0));
  const offile_off_t Most;
  offile_off_t Count = 0;
  bool IsTooDeep = false;
};
}

std::shared_ptr<void> SilenceDcmtk()
{
  static std::mutex access;
  static std::weak_ptr<QuietDcmtk> living;
  const std::lock_guard<std::mutex> alone(access);
  std::shared_ptr<QuietDcmtk> quiet = living.lock();
  if (!quiet)
  {
    quiet = std::make_shared<QuietDcmtk>();
    living = quiet;
  }
  return quiet;
}

namespace
{
bool IsPreamble(const std::string& bytes)
{
  return bytes.size() == 132 && bytes.compare(128, 4, "DICM") == 0;
}

/// The first 132 bytes, fewer of a shorter file.
std::string Beginning(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::string bytes(132, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

/// True if the first element is of group 2 or 8 and has a short value.
bool IsDataSet(const std::string& bytes)
{
  if (bytes.size() < 132)
  {
    return false;
  }
  const auto at = [&bytes](std::size_t n) { return static_cast<unsigned char>(bytes[n]); };
  const bool isGroup = (at(0) == 2 || at(0) == 8) && at(1) == 0;
  const bool isElement = at(2) <= 0x60 && at(3) == 0;
  const std::string vr = bytes.substr(4, 2);
  const bool isExplicit = vr == "UL" || vr == "CS" || vr == "UI" || vr == "DA" || vr == "SH" ||
    vr == "LO" || vr == "TM" || vr == "DT" || vr == "OB";
  const bool isImplicit = at(4) > 0 && at(4) <= 64 && at(5) == 0 && at(6) == 0 && at(7) == 0;
  return isGroup && isElement && (isExplicit || isImplicit);
}
}

bool HasDicomPreamble(const std::string& path)
{
  return IsPreamble(Beginning(path));
}

bool HasDicomHeader(const std::string& path)
{
  const std::string bytes = Beginning(path);
  return IsPreamble(bytes) || IsDataSet(bytes);
}

DicomFile::DicomFile(const std::string& path, const std::string& what, DicomExtent extent)
  : Name(path)
  , Quiet(SilenceDcmtk())
  , File(std::make_unique<DcmFileFormat>())
  , Preamble(HasDicomPreamble(path))
{
  if (!HasDicomHeader(path))
  {
    throw InputError(path + ": expected " + what + ", found no DICOM header");
  }
  const bool whole = extent == DicomExtent::Whole;
  // Headers of a thousand slices in one object have a few MiB.
  const offile_off_t most =
    extent == DicomExtent::Elements ? std::numeric_limits<offile_off_t>::max() - 1 : 8 << 20;
  HeaderStream stream(path, most);
  this->File->setReadMode(this->Preamble ? ERM_fileOnly : ERM_autoDetect);
  this->File->transferInit();
  const OFCondition read = this->File->readUntilTag(stream, EXS_Unknown, EGL_noChange,
    DCM_MaxReadLength, extent == DicomExtent::Header ? DCM_PixelData : DCM_UndefinedTagKey);
  this->File->transferEnd();
  if (*stream.Excess() != '\0')
  {
    throw InputError(path + ": expected " + what + ", found " + stream.Excess());
  }
  if (read.bad() || (whole && this->File->loadAllDataIntoMemory().bad()) ||
    this->File->getDataset()->card() == 0)
  {
    throw InputError(
      path + ": expected " + what + ", found a DICOM file that is cut short or damaged");
  }
}

std::unique_ptr<DicomFile> DicomFile::OpenIfDicom(const std::string& path, DicomExtent extent)
{
  if (!HasDicomHeader(path))
  {
    return nullptr;
  }
  try
  {
    auto file = std::make_unique<DicomFile>(path, "DICOM", extent);
    return file->Preamble || file->Data().tagExists(DCM_Modality) ? std::move(file) : nullptr;
  }
  catch (const InputError&)
  {
    if (!HasDicomPreamble(path))
    {
      return nullptr;
    }
    throw;
  }
}

void CheckDicomElements(const std::string& path)
{
  DicomFile(path, "DICOM", DicomExtent::Elements);
}

std::string DicomFile::StorageClass() const
{
  return this->File->getMetaInfo()
    ? DicomText(*this->File->getMetaInfo(), DCM_MediaStorageSOPClassUID)
    : std::string();
}

std::string DicomText(DcmItem& data, const DcmTagKey& tag, unsigned long index)
{
  OFString text;
  data.findAndGetOFString(tag, text, index);
  const auto first = text.find_first_not_of(' ');
  const auto last = text.find_last_not_of(' ');
  return first == OFString_npos ? std::string()
                                : std::string(text.c_str() + first, last - first + 1);
}

std::string DicomTexts(DcmItem& data, const DcmTagKey& tag)
{
  OFString text;
  data.findAndGetOFStringArray(tag, text);
  const auto last = text.find_last_not_of(' ');
  return last == OFString_npos ? std::string() : std::string(text.c_str(), last + 1);
}

std::optional<double> DicomNumber(DcmItem& data, const DcmTagKey& tag, unsigned long index)
{
  // Not DCMTK's own conversion, which is not the nearest double.
  std::istringstream stream(DicomText(data, tag, index));
  stream.imbue(std::locale::classic());
  double value = 0;
  if (!(stream >> value) || !std::isfinite(value) || !(stream >> std::ws).eof())
  {
    return std::nullopt;
  }
  return value;
}

std::vector<double> DicomNumbers(DcmItem& data, const DcmTagKey& tag, unsigned long count)
{
  std::vector<double> numbers;
  for (unsigned long index = 0; index < count; ++index)
  {
    if (const std::optional<double> number = DicomNumber(data, tag, index))
    {
      numbers.push_back(*number);
    }
  }
  return numbers.size() == count ? numbers : std::vector<double>{};
}

std::optional<std::uint16_t> DicomShort(DcmItem& data, const DcmTagKey& tag)
{
  Uint16 bits = 0;
  Sint16 number = 0;
  if (data.findAndGetUint16(tag, bits).good())
  {
    return bits;
  }
  if (data.findAndGetSint16(tag, number).good())
  {
    return static_cast<std::uint16_t>(number);
  }
  return std::nullopt;
}

std::optional<std::uint32_t> DicomUnsigned(DcmItem& data, const DcmTagKey& tag)
{
  Uint32 value = 0;
  return data.findAndGetUint32(tag, value).good() ? std::optional<std::uint32_t>(value)
                                                  : std::nullopt;
}

SlicePlace ReadSlicePlace(DcmItem& data)
{
  const std::vector<double> at = DicomNumbers(data, DCM_ImagePositionPatient, 3);
  const std::vector<double> axes = DicomNumbers(data, DCM_ImageOrientationPatient, 6);
  const std::vector<double> spacing = DicomNumbers(data, DCM_PixelSpacing, 2);
  if (at.empty() || axes.empty() || spacing.empty() || !(spacing[0] > 0) || !(spacing[1] > 0))
  {
    return {};
  }
  const double between = DicomNumber(data, DCM_SpacingBetweenSlices).value_or(0);
  const double thickness = DicomNumber(data, DCM_SliceThickness).value_or(0);
  return { Vector3{ at[0], at[1], at[2] }, { axes[0], axes[1], axes[2] },
    { axes[3], axes[4], axes[5] }, spacing[0], spacing[1],
    between > 0 ? between : std::max(thickness, 0.0) };
}

std::string MissingOfPlace(DcmItem& data)
{
  const std::vector<double> spacing = DicomNumbers(data, DCM_PixelSpacing, 2);
  std::string missing;
  for (const auto& [isThere, name] :
    { std::pair{ !DicomNumbers(data, DCM_ImagePositionPatient, 3).empty(),
        "Image Position (0020,0032)" },
      { !DicomNumbers(data, DCM_ImageOrientationPatient, 6).empty(),
        "Image Orientation (0020,0037)" },
      { !spacing.empty() && spacing[0] > 0 && spacing[1] > 0, "Pixel Spacing (0028,0030)" } })
  {
    missing += isThere ? "" : (missing.empty() ? "" : ", ") + std::string(name);
  }
  return missing;
}

DicomIdentity ReadIdentity(DcmItem& data)
{
  DicomIdentity identity;
  identity.PatientName = DicomTexts(data, DCM_PatientName);
  identity.PatientId = DicomTexts(data, DCM_PatientID);
  identity.PatientBirthDate = DicomText(data, DCM_PatientBirthDate);
  identity.PatientSex = DicomText(data, DCM_PatientSex);
  identity.StudyInstanceUid = DicomText(data, DCM_StudyInstanceUID);
  identity.StudyDate = EscapeControls(DicomText(data, DCM_StudyDate)); // which is shown, too
  identity.StudyTime = DicomText(data, DCM_StudyTime);
  identity.StudyId = DicomTexts(data, DCM_StudyID);
  identity.AccessionNumber = DicomTexts(data, DCM_AccessionNumber);
  identity.ReferringPhysicianName = DicomTexts(data, DCM_ReferringPhysicianName);
  identity.CharacterSet = DicomTexts(data, DCM_SpecificCharacterSet);
  return identity;
}

DcmItem* DicomFirstItem(DcmItem& data, const DcmTagKey& sequence)
{
  DcmItem* item = nullptr;
  return data.findAndGetSequenceItem(sequence, item).good() ? item : nullptr;
}
}
