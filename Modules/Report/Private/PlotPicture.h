// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PlotPicture_h
#define mammoray_PlotPicture_h

#include "vtkImageData.h"
#include "vtkNew.h"

#include <array>
#include <string>
#include <vector>

namespace mammoray
{
using PlotColor = std::array<unsigned char, 3>;

/// Okabe and Ito's colours, which the colour-blind tell apart; further groups begin again.
PlotColor GroupColor(std::size_t group);
/// Of axes and text.
inline constexpr PlotColor PlotInk{ 40, 40, 40 };

struct PlotPoint
{
  double X = 0;
  double Y = 0;
};

/// 1, 2 or 5 times a power of ten, so that about `wanted` of them make `range` (positive).
double TickStep(double range, double wanted);

/// An RGB picture on white, in pixels from the lower left corner. No display is needed.
class PlotPicture
{
public:
  PlotPicture(int width, int height);

  int Width() const { return this->Size[0]; }
  int Height() const { return this->Size[1]; }

  /// What lies outside the picture is left out, here and below.
  void Box(double x0, double y0, double x1, double y1, const PlotColor& color);
  /// A convex polygon: the pixels whose middles lie in it.
  void Polygon(const std::vector<PlotPoint>& corners, const PlotColor& color);
  void Line(const PlotPoint& from, const PlotPoint& to, double width, const PlotColor& color);
  /// Text whose box has its left (0), middle (0.5) or right end (1) at x, and its middle at y.
  void Text(double x, double y, double anchor, const std::string& text);
  /// A group's color and its name beside each other; `row` 0 stands below the top left corner.
  void LegendEntry(double left, double top, std::size_t row, std::size_t group,
    const std::string& name);
  /// Another picture with its lower left corner at x, y, `factor` squared of its pixels averaged to
  /// one, so that steps are smooth.
  void PasteShrunk(int x, int y, int factor, const PlotPicture& picture);
  /// As .png; throws InputError when it cannot be written.
  void Write(const std::string& path);

private:
  /// Null outside.
  unsigned char* Pixel(int x, int y);

  std::array<int, 2> Size;
  vtkNew<vtkImageData> Image;
};
}

#endif
