// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DicomPixels_h
#define mammoray_Private_DicomPixels_h

#include "Private/DicomFile.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// Stored values that mark pixels without a measurement: Pixel Padding Value and Pixel Padding
/// Range Limit, as the bits of a short. No pixel is marked if Value is absent.
struct PixelPadding
{
  std::optional<std::uint16_t> Value;
  std::optional<std::uint16_t> Limit;
};

/// The decoded pixels of an image or of a multi-frame object.
class DicomPixels
{
public:
  /**
   * Decodes the pixels of `file`, which was read whole and must outlive this object. They have one
   * value of 8, 16 or 32 bits. DCMTK decodes every transfer syntax but JPEG 2000; GDCM decodes
   * that, from the bytes that DCMTK has read. Throws InputError that names the file if the pixels
   * are missing, damaged, in colour or of another number than the header says.
   */
  explicit DicomPixels(const DicomFile& file);

  int Columns() const { return this->NumberOfColumns; }
  int Rows() const { return this->NumberOfRows; }
  std::size_t Frames() const { return this->NumberOfFrames; }
  int BitsStored() const { return this->Format.BitsStored; }

  /// The values of a frame, from 0, along rows first: slope * stored value + intercept, or NaN for
  /// padding.
  std::vector<float> Values(std::size_t frame, double slope, double intercept,
    const PixelPadding& padding = {}) const;

private:
  /// How a pixel is stored (PS3.5 8.1.1).
  struct PixelFormat
  {
    int BitsAllocated = 16;
    int BitsStored = 16;
    int HighBit = 15;
    bool IsSigned = false;
  };
  static PixelFormat ReadFormat(DcmItem& data);
  void CheckFormat() const;
  void Decode(DcmPixelData& pixels, const DcmXfer& syntax);
  void DecodeByGdcm(DcmPixelData& pixels, const DcmXfer& syntax);
  void FindBytes(bool isEncapsulated);
  [[noreturn]] void Refuse(const std::string& why) const;

  const std::string Path;
  DcmDataset& Data;
  int NumberOfColumns = 0;
  int NumberOfRows = 0;
  std::size_t NumberOfFrames = 1;
  PixelFormat Format;
  /// All frames, in the data set or in Decoded.
  const unsigned char* Bytes = nullptr;
  std::vector<char> Decoded;
};
}

#endif
