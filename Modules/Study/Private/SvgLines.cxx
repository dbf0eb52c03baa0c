// SPDX-License-Identifier: Apache-2.0
#include "Private/SvgLines.h"

#include "Private/ReportText.h"

#include <cmath>
#include <cstdio>

namespace mammoray
{
namespace
{
constexpr double LeastStepPixels = 0.7;

/// Numbers with a point whatever the locale.
std::string Plain(double value)
{
  const long tenths = std::lround(10 * value);
  std::string text = tenths < 0 ? "-" : "";
  text += std::to_string(std::labs(tenths) / 10);
  if (tenths % 10 != 0)
  {
    text += '.';
    text += std::to_string(std::labs(tenths) % 10);
  }
  return text;
}
}

std::string HexColor(const PictureColor& color)
{
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color[0], color[1], color[2]);
  return text;
}

void SvgLines::AddPath(const std::string& data, const PictureColor& color)
{
  const auto add = [&](const std::string& stroke, const char* width)
  {
    this->Text += "<path d=\"" + data + "\" stroke=\"" + stroke + "\" stroke-width=\"" + width +
      "\" fill=\"none\" vector-effect=\"non-scaling-stroke\"/>\n";
  };
  if (color == MarkColor) // lies on bright and on dark
  {
    add("#000", "3.4");
  }
  add(HexColor(color), "1.6");
}

void SvgLines::Path(const std::vector<PicturePoint>& points, bool closed, const PictureColor& color)
{
  std::string data;
  const PicturePoint* last = nullptr;
  for (const PicturePoint& point : points)
  {
    if (last && &point != &points.back() &&
      std::hypot(point.X - last->X, point.Y - last->Y) < LeastStepPixels)
    {
      continue;
    }
    data += last ? "L" : "M";
    data += Plain(point.X) + " " + Plain(this->Height - point.Y);
    last = &point;
  }
  if (!data.empty())
  {
    this->AddPath(data + (closed ? "Z" : ""), color);
  }
}

void SvgLines::Cross(const PicturePoint& at, const std::string& name, double size,
  const PictureColor& color)
{
  const double inner = 0.35 * size;
  const double y = this->Height - at.Y;
  std::string data;
  for (const auto& [right, down] :
    { std::array{ 1.0, 0.0 }, { -1.0, 0.0 }, { 0.0, 1.0 }, { 0.0, -1.0 } })
  {
    data += "M";
    data += Plain(at.X + inner * right) + " " + Plain(y + inner * down) + "L" +
      Plain(at.X + size * right) + " " + Plain(y + size * down);
  }
  this->AddPath(data, color);
  if (!name.empty())
  {
    this->Text += "<text x=\"" + Plain(at.X + 0.5 * size) + "\" y=\"" + Plain(y - 0.5 * size) +
      "\" font-size=\"" + Plain(1.1 * size) + "\" font-weight=\"600\" fill=\"" + HexColor(color) +
      "\" stroke=\"#000\" stroke-width=\"" + Plain(0.18 * size) + "\" paint-order=\"stroke\">" +
      Escape(name) + "</text>\n";
  }
}
}
