// SPDX-License-Identifier: Apache-2.0
#include "Private/PlotPicture.h"

#include "mammoray/Foundation/Error.h"

#include "vtkFreeTypeTools.h"
#include "vtkImageShrink3D.h"
#include "vtkPNGWriter.h"
#include "vtkStdString.h"
#include "vtkTextProperty.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace mammoray
{
namespace
{
constexpr PlotColor Palette[] = { { 230, 159, 0 }, { 86, 180, 233 }, { 0, 158, 115 },
  { 240, 228, 66 }, { 0, 114, 178 }, { 213, 94, 0 }, { 204, 121, 167 }, { 120, 120, 120 } };
constexpr int TextDpi = 96;
}

PlotColor GroupColor(std::size_t group)
{
  return Palette[group % std::size(Palette)];
}

double TickStep(double range, double wanted)
{
  const double rough = range / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double part = rough / power;
  return power * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
}

PlotPicture::PlotPicture(int width, int height)
  : Size{ width, height }
{
  this->Image->SetDimensions(width, height, 1);
  this->Image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  auto* bytes = static_cast<unsigned char*>(this->Image->GetScalarPointer());
  std::fill_n(bytes, 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 255);
}

unsigned char* PlotPicture::Pixel(int x, int y)
{
  const bool inside = x >= 0 && y >= 0 && x < this->Size[0] && y < this->Size[1];
  return inside ? static_cast<unsigned char*>(this->Image->GetScalarPointer(x, y, 0)) : nullptr;
}

void PlotPicture::Box(double x0, double y0, double x1, double y1, const PlotColor& color)
{
  for (int y = static_cast<int>(std::lround(y0)); y < std::lround(y1); ++y)
  {
    for (int x = static_cast<int>(std::lround(x0)); x < std::lround(x1); ++x)
    {
      if (unsigned char* pixel = this->Pixel(x, y))
      {
        std::copy(color.begin(), color.end(), pixel);
      }
    }
  }
}

void PlotPicture::Polygon(const std::vector<PlotPoint>& corners, const PlotColor& color)
{
  const auto [lowest, highest] = std::minmax_element(corners.begin(), corners.end(),
    [](const PlotPoint& a, const PlotPoint& b) { return a.Y < b.Y; });
  const int last = std::min(this->Size[1] - 1, static_cast<int>(std::floor(highest->Y - 0.5)));
  for (int y = std::max(0, static_cast<int>(std::ceil(lowest->Y - 0.5))); y <= last; ++y)
  {
    double left = this->Size[0];
    double right = 0;
    for (std::size_t corner = 0; corner < corners.size(); ++corner)
    {
      const PlotPoint& a = corners[corner];
      const PlotPoint& b = corners[(corner + 1) % corners.size()];
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

void PlotPicture::Line(const PlotPoint& from, const PlotPoint& to, double width,
  const PlotColor& color)
{
  const double length = std::hypot(to.X - from.X, to.Y - from.Y);
  if (length > 0)
  {
    const double x = 0.5 * width * (from.Y - to.Y) / length;
    const double y = 0.5 * width * (to.X - from.X) / length;
    this->Polygon({ { from.X + x, from.Y + y }, { from.X - x, from.Y - y }, { to.X - x, to.Y - y },
                    { to.X + x, to.Y + y } },
      color);
  }
}

void PlotPicture::Text(double x, double y, double anchor, const std::string& text)
{
  vtkNew<vtkTextProperty> style;
  style->SetFontSize(12);
  style->SetColor(PlotInk[0] / 255.0, PlotInk[1] / 255.0, PlotInk[2] / 255.0);
  vtkNew<vtkImageData> drawn;
  int size[2] = { 0, 0 };
  if (!vtkFreeTypeTools::GetInstance()->RenderString(style, vtkStdString(text), TextDpi, drawn,
        size))
  {
    throw InputError("picture: the text '" + text + "' cannot be drawn");
  }
  const int* extent = drawn->GetExtent();
  const int left = static_cast<int>(std::lround(x - anchor * size[0]));
  const int low = static_cast<int>(std::lround(y - 0.5 * size[1]));
  for (int j = 0; j < std::min(size[1], extent[3] - extent[2] + 1); ++j)
  {
    for (int i = 0; i < std::min(size[0], extent[1] - extent[0] + 1); ++i)
    {
      const auto* rgba = static_cast<unsigned char*>(
        drawn->GetScalarPointer(extent[0] + i, extent[2] + j, extent[4]));
      unsigned char* pixel = this->Pixel(left + i, low + j);
      for (int c = 0; pixel && c < 3; ++c)
      {
        pixel[c] =
          static_cast<unsigned char>((rgba[3] * rgba[c] + (255 - rgba[3]) * pixel[c]) / 255);
      }
    }
  }
}

void PlotPicture::LegendEntry(double left, double top, std::size_t row, std::size_t group,
  const std::string& name)
{
  const double y = top - 12 - 24.0 * static_cast<double>(row);
  this->Box(left, y - 7, left + 14, y + 7, GroupColor(group));
  this->Text(left + 22, y, 0, name);
}

void PlotPicture::PasteShrunk(int x, int y, int factor, const PlotPicture& picture)
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
      if (unsigned char* pixel = this->Pixel(x + i, y + j))
      {
        std::copy_n(static_cast<unsigned char*>(small->GetScalarPointer(i, j, 0)), 3, pixel);
      }
    }
  }
}

void PlotPicture::Write(const std::string& path)
{
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(this->Image);
  writer->SetFileName(path.c_str());
  writer->Write();
  if (writer->GetErrorCode() != 0 || !std::filesystem::exists(path))
  {
    throw InputError(path + ": cannot be written");
  }
}
}
