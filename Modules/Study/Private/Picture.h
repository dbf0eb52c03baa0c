// SPDX-License-Identifier: Apache-2.0
// The canvas of all pictures: pixels, and SVG lines over them.
#ifndef mammoray_Picture_h
#define mammoray_Picture_h

#include "mammorayStudyModule.h"

#include "vtkImageData.h"
#include "vtkNew.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// Red, green and blue.
using PictureColor = std::array<unsigned char, 3>;

/// The colour of axes and text.
inline constexpr PictureColor PictureInk{ 40, 40, 40 };
/// Orange and blue add up to white and are told apart by the colour-blind.
inline constexpr PictureColor RealColor{ 255, 140, 26 };
inline constexpr PictureColor SyntheticColor{ 26, 166, 255 };
/// The colour of points and lesions that the user asked for.
inline constexpr PictureColor MarkColor{ 25, 230, 115 };
/// Text on dark pictures.
inline constexpr PictureColor LightInk{ 217, 222, 230 };
inline constexpr PictureColor Black{ 0, 0, 0 };

/// A grey between 0 (black) and 1 (white), clamped.
MAMMORAYSTUDY_EXPORT PictureColor Grey(double brightness);
/// The colour a share of the way from one to another.
MAMMORAYSTUDY_EXPORT PictureColor Mixed(const PictureColor& from, const PictureColor& to,
  double share);

/// Pixels from the lower left corner.
struct PicturePoint
{
  double X = 0;
  double Y = 0;
};
using PictureLine = std::vector<PicturePoint>;

/// 1, 2 or 5 times a power of ten, so that about `wanted` of them make `range` (positive).
MAMMORAYSTUDY_EXPORT double TickStep(double range, double wanted);

/// How a text is drawn; the size is in points at 96 to the inch.
struct PictureText
{
  PictureColor Color = PictureInk;
  int Size = 12;
  /// A rim of this colour keeps the text readable on any ground; null: no rim.
  const PictureColor* Halo = nullptr;
};

/// Names and colours of a legend, from top to bottom.
using PictureLegend = std::vector<std::pair<std::string, PictureColor>>;

/// Part of a picture, pixels.
struct PictureFrame
{
  double Left = 0;
  double Low = 0;
  double Width = 0;
  double Height = 0;
};

/**
 * An RGB picture in pixels from the lower left corner; what lies outside it is left out. VTK's
 * charts are not used because Debian's VTK 9.1 draws them only in a window that OpenGL has
 * rendered, which needs an X server.
 */
class MAMMORAYSTUDY_EXPORT Picture
{
public:
  Picture(int width, int height, const PictureColor& background = { 255, 255, 255 });

  int Width() const { return this->Image->GetDimensions()[0]; }
  int Height() const { return this->Image->GetDimensions()[1]; }

  void Set(int x, int y, const PictureColor& color);
  void Box(double x0, double y0, double x1, double y1, const PictureColor& color);
  /// A smooth line with round ends.
  void Line(const PicturePoint& from, const PicturePoint& to, double width,
    const PictureColor& color);
  void Lines(const PictureLine& points, double width, const PictureColor& color);
  /// Text whose box has its left (0), middle (0.5) or right end (1) at x, and its middle at y.
  void Text(double x, double y, double anchor, const std::string& text,
    const PictureText& style = {});
  /// Coloured boxes with names beside them; the first one stands below `top`.
  void Legend(double left, double top, const PictureLegend& entries, const PictureText& style = {});
  /// Texts at the middles of the left, right, upper and lower side of a part, so far inside.
  void Letters(const PictureFrame& part, double inset, const std::array<std::string, 4>& letters,
    const PictureText& style);
  /// A bar of `lengthMm` with its length above it; its lower right corner is at x, y.
  void ScaleBar(double x, double y, double lengthMm, double pixelMm, const PictureText& style = {});
  /// Averages `factor` squared pixels to one.
  void Shrink(int factor);
  /// Returns the bytes of a PNG file.
  std::string Png() const;

private:
  /// Lays a colour over a pixel with the given opacity, clamped to [0, 1].
  void Blend(int x, int y, const PictureColor& color, double opacity);
  /// Null outside.
  unsigned char* Pixel(int x, int y);

  vtkNew<vtkImageData> Image;
};

/**
 * Lines over a picture as SVG elements. Places are pixels from the lower left corner, and widths
 * are those of the screen at any zoom.
 */
class SvgLines
{
public:
  /// `height`: the picture's, pixels.
  explicit SvgLines(int height)
    : Height(height)
  {
  }

  /// Leaves out points less than 0.7 pixels from the last one.
  void Path(const PictureLine& points, bool closed, const PictureColor& color);
  /// Four arms of 16 x `scale` pixels that leave the middle free, in MarkColor, and a name beside.
  void Cross(const PicturePoint& at, const std::string& name, double scale = 1);

  const std::string& Elements() const { return this->Text; }

private:
  /// Adds a path of lines, each from its first point on, as x and y downwards.
  void AddPath(const std::string& data, const PictureColor& color);

  int Height;
  std::string Text;
};
}

#endif
