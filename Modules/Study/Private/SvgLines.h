// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SvgLines_h
#define mammoray_SvgLines_h

#include "Private/Picture.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Orange and blue add up to white and are told apart by the colour-blind.
inline constexpr PictureColor RealColor{ 255, 140, 26 };
inline constexpr PictureColor SyntheticColor{ 26, 166, 255 };
/// What was asked for.
inline constexpr PictureColor MarkColor{ 25, 230, 115 };

/// "#ff8c1a" and the like.
std::string HexColor(const PictureColor& color);

/**
 * Lines over a picture, as SVG elements, from places in the picture's own frame: pixels from the
 * lower left corner. Their widths are those of the screen at any zoom.
 */
class SvgLines
{
public:
  /// `height`: the picture's, pixels.
  explicit SvgLines(int height)
    : Height(height)
  {
  }

  /// Points less than 0.7 pixels from the last one are left out.
  void Path(const std::vector<PicturePoint>& points, bool closed, const PictureColor& color);
  /// Four arms that leave the middle free, and a name beside it; `size`: of the picture, pixels.
  void Cross(const PicturePoint& at, const std::string& name, double size,
    const PictureColor& color);

  const std::string& Elements() const { return this->Text; }

private:
  void AddPath(const std::string& data, const PictureColor& color);

  int Height;
  std::string Text;
};
}

#endif
