// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_FramePixels_h
#define mammoray_Private_FramePixels_h

#include "Private/QuietGdcm.h"
#include "Private/StoredPixel.h"

#include <gdcmImageReader.h>

#include <cstddef>
#include <string>
#include <vector>

namespace mammoray
{
/// The decoded pixels of a multi-frame object of one value per pixel, by GDCM.
class FramePixels
{
public:
  /// Throws InputError that names the file where it does not hold so many frames of so many pixels,
  /// or they cannot be decoded.
  FramePixels(const std::string& path, std::size_t frames, std::size_t pixelsPerFrame);

  /// Those of a frame, from 0, rescaled; NaN for stored values of the padding.
  std::vector<float> Values(std::size_t frame, double slope, double intercept,
    const PixelPadding& padding = {}) const;
  int BitsStored() const;

private:
  const QuietGdcm Quiet;
  gdcm::ImageReader Reader;
  std::size_t PixelsPerFrame;
  std::vector<char> Buffer;
};
}

#endif
