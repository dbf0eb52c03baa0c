// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Picture_h
#define mammoray_Picture_h

#include "mammorayStudyModule.h"

#include "vtkImageData.h"
#include "vtkNew.h"

#include <array>
#include <string>
#include <vector>

namespace mammoray
{
/// Red, green and blue.
using PictureColor = std::array<unsigned char, 3>;

/// Okabe and Ito's colours, which the colour-blind tell apart; further groups begin again.
MAMMORAYSTUDY_EXPORT PictureColor GroupColor(std::size_t group);
/// The colour of axes and text.
inline constexpr PictureColor PictureInk{ 40, 40, 40 };

/// A grey between 0 (black) and 1 (white), clamped.
MAMMORAYSTUDY_EXPORT PictureColor Grey(double brightness);
/// The colour a share of the way from one to another.
MAMMORAYSTUDY_EXPORT PictureColor Mixed(const PictureColor& from, const PictureColor& to,
  double share);

struct PicturePoint
{
  double X = 0;
  double Y = 0;
};

/// 1, 2 or 5 times a power of ten, so that about `wanted` of them make `range` (positive).
MAMMORAYSTUDY_EXPORT double TickStep(double range, double wanted);

/// How a text is drawn; sizes are those of type, points at 96 to the inch.
struct PictureText
{
  PictureColor Color = PictureInk;
  int Size = 12;
  /// A rim of this colour keeps the text readable on any ground.
  const PictureColor* Halo = nullptr;
};

/**
 * An RGB picture in pixels from the lower left corner. What lies outside it is left out. Its plots
 * are drawn here and not by VTK's charts, because Debian's VTK 9.1 draws a chart only in a window
 * that OpenGL has rendered, which needs an X server, and these pictures are made without one.
 */
class MAMMORAYSTUDY_EXPORT Picture
{
public:
  Picture(int width, int height, const PictureColor& background = { 255, 255, 255 });

  int Width() const { return this->Size[0]; }
  int Height() const { return this->Size[1]; }

  void Set(int x, int y, const PictureColor& color);
  /// Lays a colour over a pixel with the given opacity, clamped to [0, 1].
  void Blend(int x, int y, const PictureColor& color, double opacity);
  void Box(double x0, double y0, double x1, double y1, const PictureColor& color);
  /// A convex polygon: the pixels whose middles lie in it.
  void Polygon(const std::vector<PicturePoint>& corners, const PictureColor& color);
  /// A line with round ends and no stairs.
  void Line(const PicturePoint& from, const PicturePoint& to, double width,
    const PictureColor& color);
  /// Text whose box has its left (0), middle (0.5) or right end (1) at x, and its middle at y.
  void Text(double x, double y, double anchor, const std::string& text,
    const PictureText& style = {});
  /// A group's color and its name beside each other; `row` 0 stands below the top left corner.
  void LegendEntry(double left, double top, std::size_t row, std::size_t group,
    const std::string& name);
  /// Another picture with its lower left corner at x, y, `factor` squared of its pixels averaged to
  /// one, so that steps are smooth.
  void PasteShrunk(int x, int y, int factor, const Picture& picture);
  /// Returns the bytes of a PNG file.
  std::string Png();
  /// Writes a .png; throws InputError when it cannot be written.
  void Write(const std::string& path);

private:
  /// Null outside.
  unsigned char* Pixel(int x, int y);

  std::array<int, 2> Size;
  vtkNew<vtkImageData> Image;
};
}

#endif
