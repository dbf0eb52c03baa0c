// SPDX-License-Identifier: Apache-2.0
#include "HistogramPicture.h"

#include "Error.h"

#include "vtkFreeTypeTools.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
#include "vtkStdString.h"
#include "vtkTextProperty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace mammoray
{
namespace
{
using Color = std::array<unsigned char, 3>;
// Okabe and Ito's colours, which the colour-blind tell apart; further groups begin again.
constexpr Color Palette[] = { { 230, 159, 0 }, { 86, 180, 233 }, { 0, 158, 115 }, { 240, 228, 66 },
  { 0, 114, 178 }, { 213, 94, 0 }, { 204, 121, 167 }, { 120, 120, 120 } };
constexpr Color Ink{ 40, 40, 40 };
constexpr int PanelWidth = 560;
constexpr int Height = 420;
constexpr int Left = 80;
constexpr int Right = 20;
constexpr int Top = 20;
constexpr int Bottom = 70;
constexpr int LegendWidth = 190;
constexpr int TextDpi = 96;

/// An RGB picture, rows from the bottom as VTK counts them.
class Picture
{
public:
  explicit Picture(int width)
    : Width(width)
  {
    this->Image->SetDimensions(width, Height, 1);
    this->Image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    auto* bytes = static_cast<unsigned char*>(this->Image->GetScalarPointer());
    std::fill_n(bytes, 3 * static_cast<std::size_t>(width) * Height, 255);
  }

  void Box(double x0, double y0, double x1, double y1, const Color& color)
  {
    for (int y = std::max(0, static_cast<int>(std::lround(y0)));
         y < std::min<int>(Height, std::lround(y1)); ++y)
    {
      for (int x = std::max(0, static_cast<int>(std::lround(x0)));
           x < std::min<int>(this->Width, std::lround(x1)); ++x)
      {
        std::copy(color.begin(), color.end(), this->Pixel(x, y));
      }
    }
  }

  /// Text whose box has its left (0), middle (0.5) or right end (1) at x, and its middle at y.
  void Text(double x, double y, double anchor, const std::string& text)
  {
    vtkNew<vtkTextProperty> style;
    style->SetFontSize(12);
    style->SetColor(Ink[0] / 255.0, Ink[1] / 255.0, Ink[2] / 255.0);
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
        const int at[2] = { left + i, low + j };
        if (at[0] >= 0 && at[0] < this->Width && at[1] >= 0 && at[1] < Height)
        {
          unsigned char* pixel = this->Pixel(at[0], at[1]);
          for (int c = 0; c < 3; ++c)
          {
            pixel[c] =
              static_cast<unsigned char>((rgba[3] * rgba[c] + (255 - rgba[3]) * pixel[c]) / 255);
          }
        }
      }
    }
  }

  void Write(const std::string& path)
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

private:
  unsigned char* Pixel(int x, int y)
  {
    return static_cast<unsigned char*>(this->Image->GetScalarPointer(x, y, 0));
  }

  int Width;
  vtkNew<vtkImageData> Image;
};

/// 1, 2 or 5 times a power of ten, so that about `count` of them make `range`.
double NiceStep(double range, double count)
{
  const double rough = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  return rough <= power  ? power
    : rough <= 2 * power ? 2 * power
    : rough <= 5 * power ? 5 * power
                         : 10 * power;
}

std::string Number(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

void DrawPanel(Picture& picture, const HistogramPanel& panel, int offset)
{
  const std::size_t bins = panel.Groups.front().Counts.size();
  std::vector<double> totals(bins, 0.0);
  for (const HistogramPanel::Group& group : panel.Groups)
  {
    for (std::size_t bin = 0; bin < bins; ++bin)
    {
      totals[bin] += static_cast<double>(group.Counts[bin]);
    }
  }
  const double most = std::max(1.0, *std::max_element(totals.begin(), totals.end()));
  const int x0 = offset + Left;
  const double width = PanelWidth - Left - Right;
  const double height = Height - Top - Bottom;
  const auto up = [&](double count) { return Bottom + height * std::sqrt(count / most); };
  for (std::size_t bin = 0; bin < bins; ++bin)
  {
    double below = 0;
    for (std::size_t group = 0; group < panel.Groups.size(); ++group)
    {
      const double above = below + static_cast<double>(panel.Groups[group].Counts[bin]);
      picture.Box(x0 + width * static_cast<double>(bin) / bins + 1, up(below),
        x0 + width * static_cast<double>(bin + 1) / bins - 1, up(above),
        Palette[group % std::size(Palette)]);
      below = above;
    }
  }
  picture.Box(x0 - 2, Bottom - 2, x0 + width, Bottom, Ink);
  picture.Box(x0 - 2, Bottom - 2, x0, Bottom + height, Ink);
  const double range = panel.Step * static_cast<double>(bins);
  const double step = NiceStep(range, 8);
  for (double value = 0; value <= range * (1 + 1e-9); value += step)
  {
    const double x = x0 + width * value / range;
    picture.Box(x - 1, Bottom - 7, x + 1, Bottom, Ink);
    picture.Text(x, Bottom - 18, 0.5, Number(value));
  }
  for (const double share : { 0.01, 0.1, 0.5, 1.0 })
  {
    const double count = std::floor(share * most);
    if (count >= 1 && (share == 1 || up(most) - up(count) > 20))
    {
      picture.Box(x0 - 7, up(count) - 1, x0, up(count) + 1, Ink);
      picture.Text(x0 - 12, up(count), 1, Number(count));
    }
  }
  picture.Text(x0 + width / 2, 18, 0.5, panel.Title);
}
}

void WriteHistogramPicture(const std::vector<HistogramPanel>& panels, const std::string& path)
{
  if (panels.empty() || panels.front().Groups.empty() ||
    panels.front().Groups.front().Counts.empty())
  {
    throw InputError(path + ": expected cells to draw a histogram of, found none");
  }
  Picture picture(static_cast<int>(panels.size()) * PanelWidth + LegendWidth);
  for (std::size_t index = 0; index < panels.size(); ++index)
  {
    DrawPanel(picture, panels[index], static_cast<int>(index) * PanelWidth);
  }
  const std::vector<HistogramPanel::Group>& groups = panels.front().Groups;
  for (std::size_t group = 0; group < groups.size(); ++group)
  {
    const double x = static_cast<double>(panels.size()) * PanelWidth;
    const double y = Height - Top - 12 - 24.0 * static_cast<double>(group);
    picture.Box(x, y - 7, x + 14, y + 7, Palette[group % std::size(Palette)]);
    picture.Text(x + 22, y, 0, groups[group].Name);
  }
  picture.Write(path);
}
}
