// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LayeredPicture_h
#define mammoray_LayeredPicture_h

#include <string>

namespace mammoray
{
/// A picture, and lines over it that a page can hide.
struct LayeredPicture
{
  /// Bytes of a PNG file; empty: none.
  std::string Png;
  /// Its size, pixels.
  int Width = 0;
  int Height = 0;
  /// SVG elements in its pixels, from the upper left corner.
  std::string Lines;
};
}

#endif
