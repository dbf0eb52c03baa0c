// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Hanging_h
#define mammoray_Hanging_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammorayStudyModule.h"

#include <array>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * How the receptor plane lies on a picture when mammograms are hung: the chest wall at the left for
 * the left breast, the lateral side (CC) or the head (oblique) up. Picture positions are pixels to
 * the right and up from the lower left corner.
 */
struct MAMMORAYSTUDY_EXPORT Hanging
{
  double PixelMm = 1;
  int Width = 0;
  int Height = 0;
  /// Whether gantry y grows to the right (+1) or to the left (-1), and x upwards or downwards.
  double Right = 1;
  double Up = 1;
  /// Gantry x and y of the picture's middle, mm.
  std::array<double, 2> Centre{ 0, 0 };
  /// Patient directions at the left, right, upper and lower side.
  std::array<std::string, 4> Letters;

  /// A gantry point in the picture.
  std::array<double, 2> ToPicture(double x, double y) const;
  /// A picture position in the gantry frame: x and y.
  std::array<double, 2> ToGantry(double right, double up) const;
};

/// Shows both breasts, the pixels of `shown`, with a margin, the longer side 900 pixels.
MAMMORAYSTUDY_EXPORT Hanging Hang(const Mammogram& mammogram, const ReceptorGrid& grid,
  const std::vector<unsigned char>& shown);

/// An image on a grid at the picture's pixels, row by row from below: bilinear, averaged
/// over the picture's pixel where that is larger.
MAMMORAYSTUDY_EXPORT std::vector<float> Resample(const ReceptorGrid& grid,
  const std::vector<float>& image, const Hanging& hanging);
}

#endif
