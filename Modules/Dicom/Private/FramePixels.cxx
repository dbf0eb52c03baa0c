// SPDX-License-Identifier: Apache-2.0
#include "Private/FramePixels.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>

namespace mammoray
{
FramePixels::FramePixels(const std::string& path, std::size_t frames, std::size_t pixelsPerFrame)
  : PixelsPerFrame(pixelsPerFrame)
{
  // The file, what it decodes to and the slices; without loss nothing shrinks to a fiftieth.
  const std::uint64_t pixels =
    std::min<std::uint64_t>(frames * pixelsPerFrame, 50 * std::filesystem::file_size(path));
  AllowMemory(ReadLimits::Of({ path }).MemoryBytes + 16 * pixels);
  this->Reader.SetFileName(path.c_str());
  if (!this->Reader.Read())
  {
    throw InputError(
      path + ": expected frames that can be decoded, found none (cut short or damaged)");
  }
  const gdcm::Image& image = this->Reader.GetImage();
  const gdcm::PixelFormat& format = image.GetPixelFormat();
  const std::size_t needed = frames * pixelsPerFrame * format.GetPixelSize();
  if (format.GetSamplesPerPixel() != 1 || format.GetPixelSize() > 4 || needed == 0 ||
    image.GetBufferLength() != needed)
  {
    throw InputError(path + ": expected " + std::to_string(frames) + " frames of " +
      std::to_string(pixelsPerFrame) + " pixels of 8, 16 or 32 bits, found " +
      std::to_string(image.GetBufferLength()) + " bytes");
  }
  this->Buffer.resize(needed);
  if (!image.GetBuffer(this->Buffer.data()))
  {
    throw InputError(path + ": expected frames that can be decoded, found transfer syntax " +
      this->Reader.GetFile().GetHeader().GetDataSetTransferSyntax().GetString() +
      " that could not (not supported, or damaged)");
  }
}

int FramePixels::BitsStored() const
{
  return this->Reader.GetImage().GetPixelFormat().GetBitsStored();
}

std::vector<float> FramePixels::Values(std::size_t frame, double slope, double intercept,
  const PixelPadding& padding) const
{
  const gdcm::PixelFormat& format = this->Reader.GetImage().GetPixelFormat();
  const StoredPixel stored(format);
  const auto [low, high] = padding.Range(stored.IsSigned);
  const std::size_t bytes = format.GetPixelSize();
  std::vector<float> values(this->PixelsPerFrame);
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    std::uint64_t raw = 0;
    std::memcpy(&raw, this->Buffer.data() + (frame * this->PixelsPerFrame + pixel) * bytes, bytes);
    const std::int64_t value = stored.ValueOf(raw);
    values[pixel] = value >= low && value <= high
      ? std::numeric_limits<float>::quiet_NaN()
      : static_cast<float>(slope * static_cast<double>(value) + intercept);
  }
  return values;
}
}
