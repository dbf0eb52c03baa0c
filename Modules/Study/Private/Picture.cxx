// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

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
constexpr PictureColor Palette[] = { { 230, 159, 0 }, { 86, 180, 233 }, { 0, 158, 115 },
  { 240, 228, 66 }, { 0, 114, 178 }, { 213, 94, 0 }, { 204, 121, 167 }, { 120, 120, 120 } };
constexpr int TextDpi = 96;
constexpr int HaloPixels = 2;
}

PictureColor GroupColor(std::size_t group)
{
  return Palette[group % std::size(Palette)];
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
  : Size{ width, height }
{
  this->Image->SetDimensions(width, height, 1);
  this->Image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  this->Box(0, 0, width, height, background);
}

unsigned char* Picture::Pixel(int x, int y)
{
  const bool inside = x >= 0 && y >= 0 && x < this->Size[0] && y < this->Size[1];
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

void Picture::Polygon(const std::vector<PicturePoint>& corners, const PictureColor& color)
{
  const auto [lowest, highest] = std::minmax_element(corners.begin(), corners.end(),
    [](const PicturePoint& a, const PicturePoint& b) { return a.Y < b.Y; });
  const int last = std::min(this->Size[1] - 1, static_cast<int>(std::floor(highest->Y - 0.5)));
  for (int y = std::max(0, static_cast<int>(std::ceil(lowest->Y - 0.5))); y <= last; ++y)
  {
    double left = this->Size[0];
    double right = 0;
    for (std::size_t corner = 0; corner < corners.size(); ++corner)
    {
      const PicturePoint& a = corners[corner];
      const PicturePoint& b = corners[(corner + 1) % corners.size()];
      if ((a.Y <= y + 0.5) != (b.Y <= y + 0.5))
      {
        const double x = a.X + (y + 0.5 - a.Y) / (b.Y - a.Y) * (b.X - a.X);
        left = std::min(left, x);
        right = std::max(right, x);
      }
    }
    this->Box(std::ceil(std::max(0.0, left) - 0.5), y, std::floor(right + 0.5), y + 1, color);
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
  for (int y = first(from.Y, to.Y, this->Size[1]); y < last(from.Y, to.Y, this->Size[1]); ++y)
  {
    for (int x = first(from.X, to.X, this->Size[0]); x < last(from.X, to.X, this->Size[0]); ++x)
    {
      const double right = x + 0.5 - from.X;
      const double up = y + 0.5 - from.Y;
      const double t = square > 0 ? std::clamp((right * dx + up * dy) / square, 0.0, 1.0) : 0.0;
      const double distance = std::hypot(right - t * dx, up - t * dy);
      this->Blend(x, y, color, half + 0.5 - distance);
    }
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

void Picture::LegendEntry(double left, double top, std::size_t row, std::size_t group,
  const std::string& name)
{
  const double y = top - 12 - 24.0 * static_cast<double>(row);
  this->Box(left, y - 7, left + 14, y + 7, GroupColor(group));
  this->Text(left + 22, y, 0, name);
}

void Picture::PasteShrunk(int x, int y, int factor, const Picture& picture)
{
  vtkNew<vtkImageShrink3D> shrink;
  shrink->SetInputData(picture.Image);
  shrink->SetShrinkFactors(factor, factor, 1);
  shrink->MeanOn();
  shrink->Update();
  vtkImageData* small = shrink->GetOutput();
  for (int j = 0; j < small->GetDimensions()[1]; ++j)
  {
    for (int i = 0; i < small->GetDimensions()[0]; ++i)
    {
      const auto* rgb = static_cast<unsigned char*>(small->GetScalarPointer(i, j, 0));
      this->Set(x + i, y + j, { rgb[0], rgb[1], rgb[2] });
    }
  }
}

std::string Picture::Png()
{
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(this->Image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return { reinterpret_cast<const char*>(bytes->GetPointer(0)),
    static_cast<std::size_t>(bytes->GetNumberOfValues()) };
}

void Picture::Write(const std::string& path)
{
  WriteAtomicFile(path, this->Png());
}
}
