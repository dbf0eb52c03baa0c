// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomPixels.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"

#include <dcmtk/dcmdata/dccodec.h>
#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>

#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>

namespace mammoray
{
namespace
{
void RegisterDecoders()
{
  [[maybe_unused]] static const bool once = []
  {
    DcmRLEDecoderRegistration::registerCodecs();
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
    return true;
  }();
}

/// DCMTK logs warnings while one of these lives. They are the only sign of some damage.
class LoudDcmtk
{
public:
  LoudDcmtk() { this->Logger.setLogLevel(OFLogger::WARN_LOG_LEVEL); }
  ~LoudDcmtk() { this->Logger.setLogLevel(OFLogger::OFF_LOG_LEVEL); }
  LoudDcmtk(const LoudDcmtk&) = delete;
  LoudDcmtk& operator=(const LoudDcmtk&) = delete;

private:
  OFLogger Logger = OFLog::getLogger("dcmtk");
};

/// From the smallest to the largest padding value. Empty if there are none.
std::pair<std::int64_t, std::int64_t> RangeOf(const PixelPadding& padding, bool isSigned)
{
  if (!padding.Value)
  {
    return { 1, 0 };
  }
  const auto typed = [isSigned](std::uint16_t bits) -> std::int64_t
  { return isSigned ? static_cast<std::int16_t>(bits) : static_cast<std::int64_t>(bits); };
  return std::minmax({ typed(*padding.Value), typed(padding.Limit.value_or(*padding.Value)) });
}
}

DicomPixels::DicomPixels(const DicomFile& file)
  : Path(file.Path())
  , Data(file.Data())
  , NumberOfColumns(DicomShort(this->Data, DCM_Columns).value_or(0))
  , NumberOfRows(DicomShort(this->Data, DCM_Rows).value_or(0))
  , Format(ReadFormat(this->Data))
{
  const double frames = DicomNumber(this->Data, DCM_NumberOfFrames).value_or(1);
  this->NumberOfFrames = frames > 1 && frames < 1e6 ? static_cast<std::size_t>(frames) : 1;
  this->CheckFormat();
  // Bounds of lossless compression. A single image may be mostly empty. Decoders keep copies.
  const std::uint64_t most =
    (this->NumberOfFrames == 1 ? 1000 : 50) * std::filesystem::file_size(this->Path);
  const std::uint64_t count =
    this->NumberOfFrames * static_cast<std::uint64_t>(this->NumberOfColumns) * this->NumberOfRows;
  AllowMemory(ReadLimits::Of({ this->Path }).MemoryBytes + 32 * std::min(count, most));

  DcmElement* element = nullptr;
  this->Data.findAndGetElement(DCM_PixelData, element);
  auto* const pixels = dynamic_cast<DcmPixelData*>(element);
  if (!pixels)
  {
    this->Refuse("expected pixel data that can be decoded, found none");
  }
  const DcmXfer syntax(this->Data.getOriginalXfer());
  if (IsEncapsulated(syntax))
  {
    this->Decode(*pixels, syntax);
  }
  if (!this->Bytes)
  {
    this->FindBytes(IsEncapsulated(syntax));
  }
}

void DicomPixels::Refuse(const std::string& why) const
{
  throw InputError(this->Path + ": " + why);
}

DicomPixels::PixelFormat DicomPixels::ReadFormat(DcmItem& data)
{
  PixelFormat format;
  format.BitsAllocated = DicomShort(data, DCM_BitsAllocated).value_or(0);
  format.BitsStored = DicomShort(data, DCM_BitsStored).value_or(0);
  format.BitsStored = format.BitsStored == 0 ? format.BitsAllocated : format.BitsStored;
  format.HighBit = DicomShort(data, DCM_HighBit).value_or(format.BitsStored - 1);
  format.IsSigned = DicomShort(data, DCM_PixelRepresentation).value_or(0) == 1;
  return format;
}

void DicomPixels::CheckFormat() const
{
  // A detector of 300 mm with pixels of 0.02 mm has 15000. Decoders allocate what a header says.
  constexpr int most = 16384;
  if (this->NumberOfColumns < 1 || this->NumberOfRows < 1 || this->NumberOfColumns > most ||
    this->NumberOfRows > most)
  {
    this->Refuse("expected 1 to " + std::to_string(most) + " columns and rows, found " +
      std::to_string(this->NumberOfColumns) + " x " + std::to_string(this->NumberOfRows));
  }
  const int samples = DicomShort(this->Data, DCM_SamplesPerPixel).value_or(1);
  const std::string photometric = DicomText(this->Data, DCM_PhotometricInterpretation);
  if (samples != 1 || photometric == "PALETTE COLOR")
  {
    this->Refuse("expected one value per pixel, found " + std::to_string(samples) + " (" +
      EscapeControls(photometric) + ")");
  }
  const int bits = this->Format.BitsAllocated;
  // DCMTK turns 16 bits of big endian, which a pixel of 32 bits has twice.
  const bool isKnown = bits == 8 || bits == 16 ||
    (bits == 32 && this->Data.getOriginalXfer() != EXS_BigEndianExplicit);
  if (!isKnown || this->Format.BitsStored > bits || this->Format.HighBit >= bits)
  {
    this->Refuse("expected 8, 16 or 32 bits per pixel, found " + std::to_string(bits) +
      ", of them " + std::to_string(this->Format.BitsStored) + " used");
  }
}

void DicomPixels::Decode(DcmPixelData& pixels, const DcmXfer& syntax)
{
  RegisterDecoders();
  const LoudDcmtk loud;
  bool decoded = true;
  if (DcmCodecList::canChangeCoding(syntax.getXfer(), EXS_LittleEndianExplicit))
  {
    DcmStack stack;
    stack.push(&this->Data);
    stack.push(&pixels);
    decoded = pixels.chooseRepresentation(EXS_LittleEndianExplicit, nullptr, stack).good();
    // Decoders of JPEG adapt it to what they found.
    this->Format = ReadFormat(this->Data);
    this->CheckFormat();
  }
  else
  {
    this->DecodeByGdcm(pixels, syntax);
    decoded = this->Bytes != nullptr;
  }
  if (!decoded)
  {
    this->Refuse(std::string("expected pixel data that can be decoded, found transfer syntax ") +
      syntax.getXferID() + " that could not (not supported, or damaged)");
  }
  // Decoders fill in what is damaged and only print a warning.
  if (const std::string said = SaidByLibraries(); said.find("orrupt") != std::string::npos ||
      said.find("remature") != std::string::npos || said.find("nsufficient") != std::string::npos)
  {
    this->Refuse("expected pixel data that can be decoded, found damaged data (" + said + ")");
  }
}

void DicomPixels::DecodeByGdcm(DcmPixelData& pixels, const DcmXfer& syntax)
{
  DcmPixelSequence* sequence = nullptr;
  if (pixels.getEncapsulatedRepresentation(syntax.getXfer(), nullptr, sequence).bad() || !sequence)
  {
    return;
  }
  const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = gdcm::SequenceOfFragments::New();
  // The first item is the offset table.
  for (unsigned long index = 1; index < sequence->card(); ++index)
  {
    DcmPixelItem* item = nullptr;
    Uint8* bytes = nullptr;
    if (sequence->getItem(item, index).bad() || item->getUint8Array(bytes).bad() || !bytes)
    {
      return;
    }
    gdcm::Fragment fragment;
    fragment.SetByteValue(reinterpret_cast<const char*>(bytes), gdcm::VL(item->getLength()));
    fragments->AddFragment(fragment);
  }
  gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
  element.SetVR(gdcm::VR::OB);
  element.SetValue(*fragments);
  gdcm::Trace::WarningOff(); // SaidByLibraries would take them for a sign of damage
  gdcm::Trace::ErrorOff();
  gdcm::Image image;
  image.SetNumberOfDimensions(this->NumberOfFrames > 1 ? 3 : 2);
  image.SetDimension(0, static_cast<unsigned>(this->NumberOfColumns));
  image.SetDimension(1, static_cast<unsigned>(this->NumberOfRows));
  if (this->NumberOfFrames > 1)
  {
    image.SetDimension(2, static_cast<unsigned>(this->NumberOfFrames));
  }
  image.SetPixelFormat(gdcm::PixelFormat(1, static_cast<unsigned short>(this->Format.BitsAllocated),
    static_cast<unsigned short>(this->Format.BitsStored),
    static_cast<unsigned short>(this->Format.HighBit), this->Format.IsSigned ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(gdcm::TransferSyntax::GetTSType(syntax.getXferID()));
  image.SetDataElement(element);
  this->Decoded.resize(image.GetBufferLength());
  if (image.GetBuffer(this->Decoded.data()) && image.GetBufferLength() == this->Decoded.size())
  {
    this->Format.BitsStored = image.GetPixelFormat().GetBitsStored();
    this->Format.HighBit = image.GetPixelFormat().GetHighBit();
    this->Format.IsSigned = image.GetPixelFormat().GetPixelRepresentation() == 1;
    this->Bytes = reinterpret_cast<const unsigned char*>(this->Decoded.data());
  }
}

void DicomPixels::FindBytes(bool isEncapsulated)
{
  unsigned long found = 0;
  const Uint16* words = nullptr;
  if (this->Format.BitsAllocated == 8)
  {
    this->Data.findAndGetUint8Array(DCM_PixelData, this->Bytes, &found);
  }
  else if (this->Data.findAndGetUint16Array(DCM_PixelData, words, &found).good())
  {
    this->Bytes = reinterpret_cast<const unsigned char*>(words);
    found *= sizeof *words;
  }
  const std::size_t needed = this->NumberOfFrames *
    static_cast<std::size_t>(this->NumberOfColumns) * this->NumberOfRows *
    (this->Format.BitsAllocated / 8);
  const std::string size =
    (this->NumberOfFrames > 1 ? std::to_string(this->NumberOfFrames) + " frames of "
                              : std::string()) +
    std::to_string(this->NumberOfColumns) + " x " + std::to_string(this->NumberOfRows) + " pixels";
  if (!this->Bytes || found < needed)
  {
    this->Refuse("expected " + size + ", found fewer (cut short)");
  }
  // A padding byte may follow. A row more means that the size in the header is wrong.
  if (!isEncapsulated && found >= needed + static_cast<std::size_t>(this->NumberOfColumns) + 1)
  {
    this->Refuse("expected " + size + " (" + std::to_string(needed) + " bytes), found " +
      std::to_string(found) + " bytes");
  }
}

std::vector<float> DicomPixels::Values(std::size_t frame, double slope, double intercept,
  const PixelPadding& padding) const
{
  const std::size_t count = static_cast<std::size_t>(this->NumberOfColumns) * this->NumberOfRows;
  const auto bytes = static_cast<std::size_t>(this->Format.BitsAllocated / 8);
  const int bits = this->Format.BitsStored;
  const int shift = std::max(0, this->Format.HighBit + 1 - bits);
  const auto [low, high] = RangeOf(padding, this->Format.IsSigned);
  const unsigned char* next = this->Bytes + frame * count * bytes;
  std::vector<float> values(count);
  for (float& value : values)
  {
    std::uint64_t raw = 0;
    std::memcpy(&raw, next, bytes);
    next += bytes;
    auto stored = static_cast<std::int64_t>((raw >> shift) & ((std::uint64_t{ 1 } << bits) - 1));
    if (this->Format.IsSigned && (stored >> (bits - 1)) != 0)
    {
      stored -= std::int64_t{ 1 } << bits;
    }
    value = stored >= low && stored <= high
      ? std::numeric_limits<float>::quiet_NaN()
      : static_cast<float>(slope * static_cast<double>(stored) + intercept);
  }
  return values;
}
}
