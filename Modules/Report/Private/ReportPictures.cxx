// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportPictures.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace mammoray
{
namespace
{
using Color = std::array<double, 3>; // red, green, blue, [0, 1]

// Orange and blue add up to white and are told apart by the colour-blind.
constexpr Color RealColor{ 1.0, 0.55, 0.1 };
constexpr Color SyntheticColor{ 0.1, 0.65, 1.0 };
constexpr Color ExcludedColor{ 0.75, 0.75, 0.78 };
constexpr int LongerSidePixels = 900;
constexpr double DifferenceRange = 2; // standard deviations

/**
 * Glyphs for letters and scales, five columns by seven rows, a row in the low five bits of each
 * entry. A font library would be a large dependency for a dozen characters.
 */
struct Glyph
{
  char Character;
  std::array<std::uint8_t, 7> Rows;
};
constexpr Glyph Glyphs[] = { { 'A', { 14, 17, 17, 31, 17, 17, 17 } },
  { 'P', { 30, 17, 17, 30, 16, 16, 16 } }, { 'L', { 16, 16, 16, 16, 16, 16, 31 } },
  { 'R', { 30, 17, 17, 30, 20, 18, 17 } }, { 'H', { 17, 17, 17, 31, 17, 17, 17 } },
  { 'F', { 31, 16, 16, 30, 16, 16, 16 } }, { '0', { 14, 17, 19, 21, 25, 17, 14 } },
  { '1', { 4, 12, 4, 4, 4, 4, 14 } }, { '2', { 14, 17, 1, 6, 8, 16, 31 } },
  { 'm', { 0, 0, 26, 21, 21, 21, 21 } }, { '+', { 0, 4, 4, 31, 4, 4, 0 } },
  { '-', { 0, 0, 0, 31, 0, 0, 0 } } };

class Canvas
{
public:
  Canvas(int width, int height, const Color& background)
    : Width(width)
    , Height(height)
    , Pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), background)
  {
  }

  Color& At(int x, int y)
  {
    return this->Pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(this->Width) +
      static_cast<std::size_t>(x)];
  }

  /// Lays a colour over a pixel with the given opacity, [0, 1]; nothing beside the canvas.
  void Blend(int x, int y, const Color& color, double opacity)
  {
    if (x < 0 || y < 0 || x >= this->Width || y >= this->Height || opacity <= 0)
    {
      return;
    }
    Color& pixel = this->At(x, y);
    for (int c = 0; c < 3; ++c)
    {
      pixel[c] += std::min(opacity, 1.0) * (color[c] - pixel[c]);
    }
  }

  void Box(int x0, int y0, int x1, int y1, const Color& color)
  {
    for (int y = y0; y < y1; ++y)
    {
      for (int x = x0; x < x1; ++x)
      {
        this->Blend(x, y, color, 1);
      }
    }
  }

  /// Text with its upper left corner at x, y; characters are 6 by 7 times `size` pixels. A halo
  /// keeps it readable on any ground.
  void HaloedText(int x, int y, const std::string& text, const Color& color, const Color& halo,
    int size)
  {
    for (int offset = 0; offset < 9; ++offset)
    {
      this->Text(x + 2 * (offset % 3 - 1), y + 2 * (offset / 3 - 1), text, halo, size);
    }
    this->Text(x, y, text, color, size);
  }
  void Text(int x, int y, const std::string& text, const Color& color, int size = 3)
  {
    for (const char character : text)
    {
      for (const Glyph& glyph : Glyphs)
      {
        for (int bit = 0; glyph.Character == character && bit < 35; ++bit)
        {
          const int column = bit % 5;
          const int row = bit / 5;
          if ((glyph.Rows[row] >> (4 - column) & 1) != 0)
          {
            this->Box(x + column * size, y + row * size, x + (column + 1) * size,
              y + (row + 1) * size, color);
          }
        }
      }
      x += 6 * size;
    }
  }
  static int TextWidth(const std::string& text, int size = 3)
  {
    return static_cast<int>(text.size()) * 6 * size - size;
  }

  /// A line of about two pixels' width without steps.
  void Line(double x0, double y0, double x1, double y1, const Color& color)
  {
    constexpr double HalfWidth = 1.1;
    const double dx = x1 - x0;
    const double dy = y1 - y0;
    const double square = dx * dx + dy * dy;
    const int left =
      static_cast<int>(std::floor(std::clamp(std::min(x0, x1) - 2, -2.0, this->Width + 2.0)));
    const int right =
      static_cast<int>(std::ceil(std::clamp(std::max(x0, x1) + 2, -2.0, this->Width + 2.0)));
    const int top =
      static_cast<int>(std::floor(std::clamp(std::min(y0, y1) - 2, -2.0, this->Height + 2.0)));
    const int bottom =
      static_cast<int>(std::ceil(std::clamp(std::max(y0, y1) + 2, -2.0, this->Height + 2.0)));
    for (int y = top; y <= bottom; ++y)
    {
      for (int x = left; x <= right; ++x)
      {
        const double t = square > 0
          ? std::clamp(((x + 0.5 - x0) * dx + (y + 0.5 - y0) * dy) / square, 0.0, 1.0)
          : 0.0;
        const double distance = std::hypot(x + 0.5 - x0 - t * dx, y + 0.5 - y0 - t * dy);
        this->Blend(x, y, color, HalfWidth + 0.5 - distance);
      }
    }
  }

  std::string Png() const
  {
    vtkNew<vtkImageData> image;
    image->SetDimensions(this->Width, this->Height, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int y = 0; y < this->Height; ++y)
    {
      // VTK counts rows from the bottom.
      auto* row = static_cast<unsigned char*>(image->GetScalarPointer(0, this->Height - 1 - y, 0));
      for (int x = 0; x < this->Width; ++x)
      {
        const Color& pixel =
          this->Pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(this->Width) +
            static_cast<std::size_t>(x)];
        for (int c = 0; c < 3; ++c)
        {
          row[3 * x + c] =
            static_cast<unsigned char>(std::lround(255 * std::clamp(pixel[c], 0.0, 1.0)));
        }
      }
    }
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputData(image);
    writer->WriteToMemoryOn();
    writer->Write();
    vtkUnsignedCharArray* bytes = writer->GetResult();
    return { reinterpret_cast<const char*>(bytes->GetPointer(0)),
      static_cast<std::size_t>(bytes->GetNumberOfValues()) };
  }

  const int Width;
  const int Height;

private:
  std::vector<Color> Pixels;
};

/// How the receptor plane lies on the canvas: gantry (x, y) to canvas (right, down) and back.
struct View
{
  double PixelMm = 1;
  int Width = 0;
  int Height = 0;
  double Right = 1; // gantry y grows to the right: +1, or to the left: -1
  double Up = 1;    // gantry x grows upwards: +1, or downwards: -1
  double CenterX = 0;
  double CenterY = 0;
  std::array<std::string, 4> Letters; // left, right, top, bottom

  std::array<double, 2> ToCanvas(double x, double y) const
  {
    return { 0.5 * this->Width + this->Right * (y - this->CenterY) / this->PixelMm,
      0.5 * this->Height - this->Up * (x - this->CenterX) / this->PixelMm };
  }
  std::array<double, 2> ToGantry(double right, double down) const
  {
    return { this->CenterX - this->Up * (down - 0.5 * this->Height) * this->PixelMm,
      this->CenterY + this->Right * (right - 0.5 * this->Width) * this->PixelMm };
  }
};

View MakeView(const Mammogram& mammogram, const RegistrationTarget& target,
  const std::vector<unsigned char>& shown)
{
  View view;
  // Patient directions: chest wall to nipple leads forward. Where the side is not known it is taken
  // from the target, whose preparation warned: chest wall at the picture's right (y falls with the
  // column).
  Mammogram known = mammogram;
  if (known.Laterality != 'L' && known.Laterality != 'R')
  {
    known.Laterality = target.ColumnStep[1] < 0 || target.RowStep[1] < 0 ? 'R' : 'L';
  }
  const double roll = NominalRollDeg(known).value_or(0) * std::numbers::pi / 180;
  const double left =
    std::cos(roll); // gantry x along patient left and head (MammographyGeometry.h)
  const double head = -std::sin(roll);
  const bool oblique = std::abs(head) > 0.1;
  const double up = oblique ? head : known.Laterality == 'L' ? left : -left;
  view.Right = known.Laterality == 'R' ? -1 : 1;
  view.Up = up > 0 ? 1 : -1;
  const auto letters = [left, head](double along)
  {
    std::string text;
    text += std::abs(head) > 0.1 ? (along * head > 0 ? "H" : "F") : "";
    text += std::abs(left) > 0.1 ? (along * left > 0 ? "L" : "R") : "";
    return text;
  };
  view.Letters = { view.Right > 0 ? "P" : "A", view.Right > 0 ? "A" : "P", letters(view.Up),
    letters(-view.Up) };

  // Both breasts with a margin, within the picture.
  constexpr double MarginMm = 8;
  std::array<std::array<double, 2>, 2> all{ { { 1e9, 1e9 }, { -1e9, -1e9 } } };
  std::array<double, 2> least{ 1e9, 1e9 };
  std::array<double, 2> most{ -1e9, -1e9 };
  for (int row = 0; row < target.Rows; ++row)
  {
    for (int column = 0; column < target.Columns; ++column)
    {
      const bool corner =
        (row == 0 || row == target.Rows - 1) && (column == 0 || column == target.Columns - 1);
      const std::size_t i = static_cast<std::size_t>(row) * target.Columns + column;
      for (int axis = 0; axis < 2; ++axis)
      {
        const double place =
          target.Origin[axis] + column * target.ColumnStep[axis] + row * target.RowStep[axis];
        const double half =
          0.5 * (std::abs(target.ColumnStep[axis]) + std::abs(target.RowStep[axis]));
        if (corner)
        {
          all[0][axis] = std::min(all[0][axis], place - half);
          all[1][axis] = std::max(all[1][axis], place + half);
        }
        if (shown[i])
        {
          least[axis] = std::min(least[axis], place - half - MarginMm);
          most[axis] = std::max(most[axis], place + half + MarginMm);
        }
      }
    }
  }
  for (int axis = 0; axis < 2; ++axis)
  {
    const bool any = least[axis] < most[axis];
    least[axis] = any ? std::max(least[axis], all[0][axis]) : all[0][axis];
    most[axis] = any ? std::min(most[axis], all[1][axis]) : all[1][axis];
  }
  const double extent[2] = { most[0] - least[0], most[1] - least[1] };
  view.CenterX = 0.5 * (least[0] + most[0]);
  view.CenterY = 0.5 * (least[1] + most[1]);
  view.PixelMm = std::max(extent[0], extent[1]) / LongerSidePixels;
  view.Width = std::max(1, static_cast<int>(std::lround(extent[1] / view.PixelMm)));
  view.Height = std::max(1, static_cast<int>(std::lround(extent[0] / view.PixelMm)));
  return view;
}

/// A target-sized image on the canvas grid: bilinear, averaged over the canvas pixel where it is
/// larger.
std::vector<float> Resample(const RegistrationTarget& target, const std::vector<float>& image,
  const View& view)
{
  const auto& c = target.ColumnStep;
  const auto& r = target.RowStep;
  const double determinant = c[0] * r[1] - c[1] * r[0];
  const double step = std::min(std::hypot(c[0], c[1]), std::hypot(r[0], r[1]));
  const int samples = std::clamp(static_cast<int>(std::ceil(view.PixelMm / step)), 1, 6);
  const auto sample = [&](double x, double y)
  {
    const double dx = x - target.Origin[0];
    const double dy = y - target.Origin[1];
    const double column =
      std::clamp((dx * r[1] - dy * r[0]) / determinant, 0.0, target.Columns - 1.0);
    const double row = std::clamp((dy * c[0] - dx * c[1]) / determinant, 0.0, target.Rows - 1.0);
    const int column0 = std::min(static_cast<int>(column), std::max(0, target.Columns - 2));
    const int row0 = std::min(static_cast<int>(row), std::max(0, target.Rows - 2));
    const double u = column - column0;
    const double v = row - row0;
    const auto at = [&](int i, int j)
    {
      return image[static_cast<std::size_t>(std::min(j, target.Rows - 1)) *
          static_cast<std::size_t>(target.Columns) +
        static_cast<std::size_t>(std::min(i, target.Columns - 1))];
    };
    return (1 - v) * ((1 - u) * at(column0, row0) + u * at(column0 + 1, row0)) +
      v * ((1 - u) * at(column0, row0 + 1) + u * at(column0 + 1, row0 + 1));
  };
  std::vector<float> result;
  result.reserve(static_cast<std::size_t>(view.Width) * static_cast<std::size_t>(view.Height));
  for (int y = 0; y < view.Height; ++y)
  {
    for (int x = 0; x < view.Width; ++x)
    {
      double sum = 0;
      for (int s = 0; s < samples * samples; ++s)
      {
        const auto point =
          view.ToGantry(x + (s % samples + 0.5) / samples, y + (s / samples + 0.5) / samples);
        sum += sample(point[0], point[1]);
      }
      result.push_back(static_cast<float>(sum / (samples * samples)));
    }
  }
  return result;
}

/// To mean 0 and standard deviation 1 over the pixels of both breasts; returns what 0 (air)
/// becomes.
double Standardise(std::vector<float>& image, const std::vector<unsigned char>& both)
{
  double count = 0;
  double mean = 0;
  double square = 0;
  for (std::size_t i = 0; i < image.size(); ++i)
  {
    if (both[i])
    {
      // Welford (1962)
      count += 1;
      const double before = image[i] - mean;
      mean += before / count;
      square += before * (image[i] - mean);
    }
  }
  const double deviation = count > 1 && square > 0 ? std::sqrt(square / count) : 1;
  for (float& value : image)
  {
    value = static_cast<float>((value - mean) / deviation);
  }
  return -mean / deviation;
}

/// Patient directions at the middles of the sides, and a scale bar.
void Annotate(Canvas& canvas, const View& view, const Color& color, const Color& halo)
{
  constexpr int Margin = 12;
  constexpr int Size = 3;
  const int middleX = canvas.Width / 2;
  const int middleY = canvas.Height / 2;
  const auto width = [&](int i) { return Canvas::TextWidth(view.Letters[i], Size); };
  canvas.HaloedText(Margin, middleY - 10, view.Letters[0], color, halo, Size);
  canvas.HaloedText(canvas.Width - Margin - width(1), middleY - 10, view.Letters[1], color, halo,
    Size);
  canvas.HaloedText(middleX - width(2) / 2, Margin, view.Letters[2], color, halo, Size);
  canvas.HaloedText(middleX - width(3) / 2, canvas.Height - Margin - 7 * Size, view.Letters[3],
    color, halo, Size);

  // On the nipple's side, where the picture is empty.
  const double lengthMm = canvas.Width * view.PixelMm > 60 ? 20 : 10;
  const int length = static_cast<int>(std::lround(lengthMm / view.PixelMm));
  const int right = view.Right > 0 ? canvas.Width - Margin : Margin + length;
  const int bottom = canvas.Height - Margin;
  canvas.Box(right - length, bottom - 4, right, bottom, color);
  canvas.Box(right - length, bottom - 10, right - length + 3, bottom, color);
  canvas.Box(right - 3, bottom - 10, right, bottom, color);
  const std::string text = lengthMm == 20 ? "20 mm" : "10 mm";
  canvas.HaloedText(right - length / 2 - Canvas::TextWidth(text, 2) / 2, bottom - 28, text, color,
    halo, 2);
}

/// Blue, white, red for -1, 0, +1.
Color Diverging(double value)
{
  constexpr Color Blue{ 0.13, 0.40, 0.67 };
  constexpr Color Red{ 0.70, 0.09, 0.17 };
  const double size = std::min(std::abs(value), 1.0);
  const Color& end = value < 0 ? Blue : Red;
  return { 1 + size * (end[0] - 1), 1 + size * (end[1] - 1), 1 + size * (end[2] - 1) };
}

void DrawDifferenceScale(Canvas& canvas, const View& view)
{
  constexpr int Margin = 12;
  constexpr int BarWidth = 18;
  constexpr Color Ink{ 0.15, 0.15, 0.2 };
  const int height = canvas.Height / 4;
  const int left = view.Right > 0 ? canvas.Width - Margin - BarWidth : Margin;
  const int top = Margin;
  canvas.Box(left - 1, top - 1, left + BarWidth + 1, top + height + 1, Ink);
  for (int y = 0; y < height; ++y)
  {
    canvas.Box(left, top + y, left + BarWidth, top + y + 1, Diverging(1 - 2.0 * y / (height - 1)));
  }
  for (const int tick : { -1, 0, 1 })
  {
    const std::string text = tick < 0 ? "-2" : tick == 0 ? "0" : "+2";
    const int y = top + static_cast<int>(std::lround(0.5 * (1 - tick) * (height - 14)));
    const int x = view.Right > 0 ? left - 8 - Canvas::TextWidth(text, 2) : left + BarWidth + 8;
    canvas.Text(x, y, text, Ink, 2);
  }
}

/// Where `distance` (mm) changes its sign.
void DrawLevel(Canvas& canvas, const std::vector<float>& distance, const View& view,
  const Color& color)
{
  for (int y = 0; y < canvas.Height; ++y)
  {
    for (int x = 0; x < canvas.Width; ++x)
    {
      const double pixels =
        std::abs(distance[static_cast<std::size_t>(y) * static_cast<std::size_t>(canvas.Width) +
          static_cast<std::size_t>(x)]) /
        view.PixelMm;
      canvas.Blend(x, y, color, 1.6 - pixels);
    }
  }
}

void DrawOutline(Canvas& canvas, const RegistrationReport& report, const View& view)
{
  for (const auto& line : report.SyntheticOutline)
  {
    for (std::size_t i = 1; i < line.size(); ++i)
    {
      const auto a = view.ToCanvas(line[i - 1][0], line[i - 1][1]);
      const auto b = view.ToCanvas(line[i][0], line[i][1]);
      canvas.Line(a[0], a[1], b[0], b[1], SyntheticColor);
    }
  }
}
}

ReportPictures DrawPictures(const RegistrationReport& report)
{
  const RegistrationTarget& target = *report.Target;
  const std::size_t count = target.LogAttenuation.size();
  std::vector<float> real = target.LogAttenuation;
  std::vector<float> synthetic = report.Synthetic;
  std::vector<unsigned char> both(count);
  std::vector<unsigned char> either(count);
  std::vector<float> inSynthetic(count);
  std::vector<float> excluded(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    synthetic[i] = std::isfinite(synthetic[i]) ? synthetic[i] : 0;
    inSynthetic[i] = synthetic[i] > 1e-6F ? 1 : 0; // float noise of rays that meet nothing
    excluded[i] = target.BreastMask[i] && IsExcluded(target, i) ? 1 : 0;
    both[i] = target.BreastMask[i] && inSynthetic[i] > 0 && excluded[i] == 0 ? 1 : 0;
    either[i] = target.BreastMask[i] || inSynthetic[i] > 0 ? 1 : 0;
  }
  const double realAir = Standardise(real, both);
  const double syntheticAir = Standardise(synthetic, both);
  std::vector<float> inside;
  for (std::size_t i = 0; i < count; ++i)
  {
    if (both[i])
    {
      inside.push_back(real[i]);
    }
  }
  // From below the thinner parts to the densest, air black in both.
  double low = -3;
  double high = 2;
  if (inside.size() > 100)
  {
    std::sort(inside.begin(), inside.end());
    const double tenth = inside[inside.size() / 10];
    high = inside[inside.size() - 1 - inside.size() / 500];
    low = tenth - (high - tenth);
    low = std::min(std::max({ low, realAir, syntheticAir }), high - 0.5);
  }
  const auto grey = [low, high](float value)
  { return std::clamp((value - low) / (high - low), 0.0, 1.0); };

  const View view = MakeView(*report.RealMammogram, target, either);
  const std::vector<float> realView = Resample(target, real, view);
  const std::vector<float> syntheticView = Resample(target, synthetic, view);
  const std::vector<float> distance = Resample(target, target.SignedDistanceMm, view);
  const std::vector<float> coverage = Resample(target, inSynthetic, view);
  const std::vector<float> left = Resample(target, excluded, view);

  constexpr Color Black{ 0, 0, 0 };
  constexpr Color Paper{ 0.97, 0.97, 0.98 };
  constexpr Color Light{ 0.85, 0.87, 0.9 };
  constexpr Color Ink{ 0.15, 0.15, 0.2 };
  Canvas realCanvas(view.Width, view.Height, Black);
  Canvas syntheticCanvas(view.Width, view.Height, Black);
  Canvas overlay(view.Width, view.Height, Black);
  Canvas difference(view.Width, view.Height, Paper);
  for (int y = 0; y < view.Height; ++y)
  {
    for (int x = 0; x < view.Width; ++x)
    {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.Width) +
        static_cast<std::size_t>(x);
      const double a = grey(realView[i]);
      const double b = grey(syntheticView[i]);
      const bool compared = left[i] < 0.5F;
      realCanvas.At(x, y) =
        compared ? Color{ a, a, a } : Color{ 0.7 * a + 0.2, 0.7 * a, 0.7 * a + 0.25 };
      syntheticCanvas.At(x, y) = { b, b, b };
      // Complementary: where both agree the sum is grey.
      overlay.At(x, y) = { a, 0.5 * (a + b), b };
      const bool inReal = distance[i] < 0;
      const bool inOther = coverage[i] > 0.5F;
      Color& pixel = difference.At(x, y);
      if (inReal && inOther && !compared)
      {
        pixel = ExcludedColor;
      }
      else if (inReal && inOther)
      {
        pixel = Diverging((syntheticView[i] - realView[i]) / DifferenceRange);
      }
      else if (inReal || inOther)
      {
        pixel = inReal ? RealColor : SyntheticColor;
      }
    }
  }
  DrawLevel(realCanvas, distance, view, RealColor);
  DrawOutline(syntheticCanvas, report, view);
  for (Canvas* canvas : { &overlay, &difference })
  {
    DrawLevel(*canvas, distance, view, RealColor);
    DrawOutline(*canvas, report, view);
  }
  DrawDifferenceScale(difference, view);
  Annotate(realCanvas, view, Light, Black);
  Annotate(syntheticCanvas, view, Light, Black);
  Annotate(overlay, view, Light, Black);
  Annotate(difference, view, Ink, Paper);
  return { realCanvas.Png(), syntheticCanvas.Png(), overlay.Png(), difference.Png(),
    view.Width > 0.95 * view.Height };
}
}
