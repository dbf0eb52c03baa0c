// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"

#include "Private/ReportParts.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include "vtkFreeTypeTools.h"
#include "vtkImageShrink3D.h"
#include "vtkPNGWriter.h"
#include "vtkStdString.h"
#include "vtkTextProperty.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr int TextDpi = 96;
constexpr int HaloPixels = 2;
constexpr double LeastStepPixels = 0.7;

/// A length to a tenth of a pixel.
std::string Tenths(double value)
{
  return NumberText(0.1 * std::round(10 * value));
}

/// A step of an SVG path to a place, rows counted downwards.
std::string Step(char command, double x, double y)
{
  return command + Tenths(x) + " " + Tenths(y);
}

std::string HexColor(const PictureColor& color)
{
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color[0], color[1], color[2]);
  return text;
}
}

PictureColor Grey(double brightness)
{
  const auto part = static_cast<unsigned char>(std::lround(255 * std::clamp(brightness, 0.0, 1.0)));
  return { part, part, part };
}

PictureColor Mixed(const PictureColor& from, const PictureColor& to, double share)
{
  PictureColor mixed;
  for (std::size_t part = 0; part < mixed.size(); ++part)
  {
    mixed[part] =
      static_cast<unsigned char>(std::lround(from[part] + share * (to[part] - from[part])));
  }
  return mixed;
}

double TickStep(double range, double wanted)
{
  const double rough = range / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double part = rough / power;
  return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

Picture::Picture(int width, int height, const PictureColor& background)
{
  this->Image->SetDimensions(width, height, 1);
  this->Image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  this->Box(0, 0, width, height, background);
}

unsigned char* Picture::Pixel(int x, int y)
{
  const bool inside = x >= 0 && y >= 0 && x < this->Width() && y < this->Height();
  return inside ? static_cast<unsigned char*>(this->Image->GetScalarPointer(x, y, 0)) : nullptr;
}

void Picture::Set(int x, int y, const PictureColor& color)
{
  if (unsigned char* pixel = this->Pixel(x, y))
  {
    std::copy(color.begin(), color.end(), pixel);
  }
}

void Picture::Blend(int x, int y, const PictureColor& color, double opacity)
{
  unsigned char* pixel = opacity > 0 ? this->Pixel(x, y) : nullptr;
  if (pixel)
  {
    const PictureColor below{ pixel[0], pixel[1], pixel[2] };
    this->Set(x, y, Mixed(below, color, std::min(opacity, 1.0)));
  }
}

void Picture::Box(double x0, double y0, double x1, double y1, const PictureColor& color)
{
  for (int y = static_cast<int>(std::lround(y0)); y < std::lround(y1); ++y)
  {
    for (int x = static_cast<int>(std::lround(x0)); x < std::lround(x1); ++x)
    {
      this->Set(x, y, color);
    }
  }
}

void Picture::Line(const PicturePoint& from, const PicturePoint& to, double width,
  const PictureColor& color)
{
  const double half = 0.5 * width;
  const double dx = to.X - from.X;
  const double dy = to.Y - from.Y;
  const double square = dx * dx + dy * dy;
  const auto first = [half](double a, double b, int most)
  { return static_cast<int>(std::floor(std::clamp(std::min(a, b) - half - 1, 0.0, 1.0 * most))); };
  const auto last = [half](double a, double b, int most)
  { return static_cast<int>(std::ceil(std::clamp(std::max(a, b) + half + 1, 0.0, 1.0 * most))); };
  for (int y = first(from.Y, to.Y, this->Height()); y < last(from.Y, to.Y, this->Height()); ++y)
  {
    for (int x = first(from.X, to.X, this->Width()); x < last(from.X, to.X, this->Width()); ++x)
    {
      const double right = x + 0.5 - from.X;
      const double up = y + 0.5 - from.Y;
      const double t = square > 0 ? std::clamp((right * dx + up * dy) / square, 0.0, 1.0) : 0.0;
      const double distance = std::hypot(right - t * dx, up - t * dy);
      this->Blend(x, y, color, half + 0.5 - distance);
    }
  }
}

void Picture::Lines(const PictureLine& points, double width, const PictureColor& color)
{
  for (std::size_t point = 1; point < points.size(); ++point)
  {
    this->Line(points[point - 1], points[point], width, color);
  }
}

void Picture::Text(double x, double y, double anchor, const std::string& text,
  const PictureText& style)
{
  vtkNew<vtkTextProperty> type;
  type->SetFontSize(style.Size);
  vtkNew<vtkImageData> drawn;
  int size[2] = { 0, 0 };
  if (!vtkFreeTypeTools::GetInstance()->RenderString(type, vtkStdString(text), TextDpi, drawn,
        size))
  {
    throw InputError("picture: the text '" + text + "' cannot be drawn");
  }
  const int* extent = drawn->GetExtent();
  const int left = static_cast<int>(std::lround(x - anchor * size[0]));
  const int low = static_cast<int>(std::lround(y - 0.5 * size[1]));
  const auto draw = [&](int right, int up, const PictureColor& color)
  {
    for (int j = 0; j < std::min(size[1], extent[3] - extent[2] + 1); ++j)
    {
      for (int i = 0; i < std::min(size[0], extent[1] - extent[0] + 1); ++i)
      {
        const auto* rgba = static_cast<unsigned char*>(
          drawn->GetScalarPointer(extent[0] + i, extent[2] + j, extent[4]));
        this->Blend(left + i + right, low + j + up, color, rgba[3] / 255.0);
      }
    }
  };
  for (int offset = 0; style.Halo && offset < 9; ++offset)
  {
    draw(HaloPixels * (offset % 3 - 1), HaloPixels * (offset / 3 - 1), *style.Halo);
  }
  draw(0, 0, style.Color);
}

void Picture::Legend(double left, double top, const PictureLegend& entries,
  const PictureText& style)
{
  for (const auto& [name, color] : entries)
  {
    const double y = top - 12;
    this->Box(left, y - 7, left + 14, y + 7, color);
    this->Text(left + 22, y, 0, name, style);
    top -= 24;
  }
}

void Picture::Letters(const PictureFrame& part, double inset,
  const std::array<std::string, 4>& letters, const PictureText& style)
{
  const double middleX = part.Left + 0.5 * part.Width;
  const double middleY = part.Low + 0.5 * part.Height;
  this->Text(part.Left + inset, middleY, 0.5, letters[0], style);
  this->Text(part.Left + part.Width - inset, middleY, 0.5, letters[1], style);
  this->Text(middleX, part.Low + part.Height - inset, 0.5, letters[2], style);
  this->Text(middleX, part.Low + inset, 0.5, letters[3], style);
}

void Picture::ScaleBar(double x, double y, double lengthMm, double pixelMm,
  const PictureText& style)
{
  const double length = std::round(lengthMm / pixelMm);
  this->Box(x - length, y, x, y + 3, style.Color);
  this->Text(x - 0.5 * length, y + 4 + style.Size, 0.5, NumberText(lengthMm) + " mm", style);
}

void Picture::Shrink(int factor)
{
  vtkNew<vtkImageShrink3D> shrink;
  shrink->SetInputData(this->Image);
  shrink->SetShrinkFactors(factor, factor, 1);
  shrink->MeanOn();
  shrink->Update();
  this->Image->DeepCopy(shrink->GetOutput());
}

std::string Picture::Png() const
{
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(this->Image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return { reinterpret_cast<const char*>(bytes->GetPointer(0)),
    static_cast<std::size_t>(bytes->GetNumberOfValues()) };
}

void SvgLines::AddPath(const std::string& data, const PictureColor& color)
{
  const auto add = [&](const std::string& stroke, const char* width)
  {
    this->Text += "<path d=\"" + data + "\" stroke=\"" + stroke + "\" stroke-width=\"" + width +
      "\" fill=\"none\" vector-effect=\"non-scaling-stroke\"/>\n";
  };
  if (color == MarkColor) // it lies on bright and on dark ground
  {
    add("#000", "3.4");
  }
  add(HexColor(color), "1.6");
}

void SvgLines::Path(const PictureLine& points, bool closed, const PictureColor& color)
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
    data += Step(last ? 'L' : 'M', point.X, this->Height - point.Y);
    last = &point;
  }
  if (!data.empty())
  {
    this->AddPath(data + (closed ? "Z" : ""), color);
  }
}

void SvgLines::Cross(const PicturePoint& at, const std::string& name, double scale)
{
  const double size = 16 * scale;
  const double inner = 0.35 * size;
  const double y = this->Height - at.Y;
  std::string data;
  for (const auto& [right, down] :
    { std::array{ 1.0, 0.0 }, { -1.0, 0.0 }, { 0.0, 1.0 }, { 0.0, -1.0 } })
  {
    data += Step('M', at.X + inner * right, y + inner * down) +
      Step('L', at.X + size * right, y + size * down);
  }
  this->AddPath(data, MarkColor);
  if (!name.empty())
  {
    this->Text += "<text x=\"" + Tenths(at.X + 0.5 * size) + "\" y=\"" + Tenths(y - 0.5 * size) +
      "\" font-size=\"" + Tenths(1.1 * size) + "\" font-weight=\"600\" fill=\"" +
      HexColor(MarkColor) + "\" stroke=\"#000\" stroke-width=\"" + Tenths(0.18 * size) +
      "\" paint-order=\"stroke\">" + Escape(name) + "</text>\n";
  }
}
}
