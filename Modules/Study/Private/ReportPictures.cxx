// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"
#include "Private/ReportParts.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Study/ContourLines.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
constexpr int LongerSidePixels = 900;
constexpr double HangingMarginMm = 8;
constexpr PictureColor ExcludedColor{ 191, 191, 199 };
constexpr PictureColor Paper{ 247, 247, 250 };
constexpr PictureColor Ink{ 38, 38, 51 };
constexpr double DifferenceRange = 2; // standard deviations
constexpr double OutlineWidth = 2.2;
constexpr int Margin = 12;

/**
 * How the receptor plane lies on a picture when mammograms are hung: the chest wall at the left for
 * the left breast, the lateral side (CC) or the head (oblique) up. Picture positions are pixels to
 * the right and up from the lower left corner.
 */
struct Hanging
{
  double PixelMm = 1;
  int Width = 0;
  int Height = 0;
  /// Whether gantry y grows to the right (+1) or to the left (-1), and x upwards or downwards.
  double Right = 1;
  double Up = 1;
  /// Gantry x and y of the picture's middle, mm.
  ReceptorPoint Centre{ 0, 0 };
  /// Patient directions at the left, right, upper and lower side.
  std::array<std::string, 4> Letters;

  PicturePoint ToPicture(const ReceptorPoint& gantry) const
  {
    return { 0.5 * this->Width + this->Right * (gantry[1] - this->Centre[1]) / this->PixelMm,
      0.5 * this->Height + this->Up * (gantry[0] - this->Centre[0]) / this->PixelMm };
  }
  ReceptorPoint ToGantry(double right, double up) const
  {
    return { this->Centre[0] + this->Up * (up - 0.5 * this->Height) * this->PixelMm,
      this->Centre[1] + this->Right * (right - 0.5 * this->Width) * this->PixelMm };
  }
};

/// Sets which way the picture is turned, and its letters.
void Orient(const Mammogram& mammogram, const ReceptorGrid& grid, Hanging& hanging)
{
  // Chest wall to nipple leads forward. An unknown side is taken from the target, whose preparation
  // warned: the chest wall is at the picture's right if y falls with the column.
  Mammogram known = mammogram;
  if (known.Laterality != 'L' && known.Laterality != 'R')
  {
    known.Laterality = grid.ColumnStep[1] < 0 || grid.RowStep[1] < 0 ? 'R' : 'L';
  }
  // Gantry x along patient left and head (MammographyGeometry.h).
  const double roll = NominalRollDeg(known).value_or(0) * std::numbers::pi / 180;
  const double left = std::cos(roll);
  const double head = -std::sin(roll);
  const bool oblique = std::abs(head) > 0.1;
  const double up = oblique ? head : known.Laterality == 'L' ? left : -left;
  hanging.Right = known.Laterality == 'R' ? -1 : 1;
  hanging.Up = up > 0 ? 1 : -1;
  const auto letters = [left, head](double along)
  {
    std::string text;
    text += std::abs(head) > 0.1 ? (along * head > 0 ? "H" : "F") : "";
    text += std::abs(left) > 0.1 ? (along * left > 0 ? "L" : "R") : "";
    return text;
  };
  hanging.Letters = { hanging.Right > 0 ? "P" : "A", hanging.Right > 0 ? "A" : "P",
    letters(hanging.Up), letters(-hanging.Up) };
}

/// Shows the pixels of `shown` with a margin within the mammogram, or all if there are none; the
/// longer side has 900 pixels.
Hanging Hang(const Mammogram& mammogram, const ReceptorGrid& grid,
  const std::vector<unsigned char>& shown)
{
  std::array<Extent, 2> all;
  std::array<Extent, 2> near;
  const auto add = [&grid](int column, int row, double marginMm, std::array<Extent, 2>& extents)
  {
    const ReceptorPoint place = grid.PositionOf(column, row);
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      const double half = 0.5 * (std::abs(grid.ColumnStep[axis]) + std::abs(grid.RowStep[axis]));
      extents[axis].Add(place[axis] - half - marginMm);
      extents[axis].Add(place[axis] + half + marginMm);
    }
  };
  for (const int row : { 0, grid.Rows - 1 })
  {
    add(0, row, 0, all);
    add(grid.Columns - 1, row, 0, all);
  }
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      if (shown[grid.Index(column, row)] != 0)
      {
        add(column, row, HangingMarginMm, near);
      }
    }
  }
  Hanging hanging;
  Orient(mammogram, grid, hanging);
  std::array<double, 2> lengths{};
  for (std::size_t axis = 0; axis < 2; ++axis)
  {
    Extent part = near[axis].Length() > 0 ? near[axis] : all[axis];
    part.Low = std::max(part.Low, all[axis].Low);
    part.High = std::min(part.High, all[axis].High);
    lengths[axis] = part.Length();
    hanging.Centre[axis] = part.Middle();
  }
  hanging.PixelMm = std::max(lengths[0], lengths[1]) / LongerSidePixels;
  hanging.Width = std::max(1, static_cast<int>(std::lround(lengths[1] / hanging.PixelMm)));
  hanging.Height = std::max(1, static_cast<int>(std::lround(lengths[0] / hanging.PixelMm)));
  return hanging;
}

/// An image at a point of the receptor, bilinear; the values of its border go on outside.
double ValueAt(const ReceptorGrid& grid, const std::vector<float>& image,
  const ReceptorPoint& point)
{
  const auto index = grid.IndexOf(point);
  const double column = std::clamp(index[0], 0.0, grid.Columns - 1.0);
  const double row = std::clamp(index[1], 0.0, grid.Rows - 1.0);
  const int column0 = std::min(static_cast<int>(column), std::max(0, grid.Columns - 2));
  const int row0 = std::min(static_cast<int>(row), std::max(0, grid.Rows - 2));
  const double u = column - column0;
  const double v = row - row0;
  const auto at = [&](int i, int j)
  { return image[grid.Index(std::min(i, grid.Columns - 1), std::min(j, grid.Rows - 1))]; };
  return (1 - v) * ((1 - u) * at(column0, row0) + u * at(column0 + 1, row0)) +
    v * ((1 - u) * at(column0, row0 + 1) + u * at(column0 + 1, row0 + 1));
}

/// An image at the picture's pixels, row by row from below: bilinear, averaged over the picture's
/// pixel if that is larger.
std::vector<float> Resample(const ReceptorGrid& grid, const std::vector<float>& image,
  const Hanging& hanging)
{
  const double step = std::min(grid.ColumnSpacingMm(), grid.RowSpacingMm());
  const int samples = std::clamp(static_cast<int>(std::ceil(hanging.PixelMm / step)), 1, 6);
  const auto width = static_cast<std::size_t>(hanging.Width);
  std::vector<float> result(width * static_cast<std::size_t>(hanging.Height));
  ParallelFor(static_cast<std::size_t>(hanging.Height),
    [&](std::size_t y)
    {
      for (std::size_t x = 0; x < width; ++x)
      {
        double sum = 0;
        for (int row = 0; row < samples; ++row)
        {
          for (int column = 0; column < samples; ++column)
          {
            sum += ValueAt(grid, image,
              hanging.ToGantry(static_cast<double>(x) + (column + 0.5) / samples,
                static_cast<double>(y) + (row + 0.5) / samples));
          }
        }
        result[y * width + x] = static_cast<float>(sum / (samples * samples));
      }
    });
  return result;
}

/// Both mammograms at the picture's pixels, row by row from below.
struct HungImages
{
  /// z-scored over the pixels of both breasts that are compared.
  std::vector<float> Real;
  std::vector<float> Synthetic;
  /// The values that are black and white in both, so that air is black.
  Extent Window{ -3, 2 };
  /// Distance to the real outline, mm, negative inside.
  std::vector<float> Distance;
  /// Shares, [0, 1], of the synthetic breast and of what is not compared.
  std::vector<float> InSynthetic;
  std::vector<float> Excluded;

  bool IsCompared(std::size_t pixel) const
  {
    return this->Distance[pixel] < 0 && this->InSynthetic[pixel] > 0.5F &&
      this->Excluded[pixel] < 0.5F;
  }
};

/// Brings an image to mean 0 and standard deviation 1 over the compared pixels and returns what 0
/// (air) becomes.
double Standardise(const HungImages& images, std::vector<float>& image)
{
  double count = 0;
  double sum = 0;
  double squares = 0;
  for (std::size_t pixel = 0; pixel < image.size(); ++pixel)
  {
    const double value = images.IsCompared(pixel) ? image[pixel] : 0;
    count += images.IsCompared(pixel) ? 1 : 0;
    sum += value;
    squares += value * value;
  }
  const double mean = sum / std::max(count, 1.0);
  const double variance = squares / std::max(count, 1.0) - mean * mean;
  const double deviation = variance > 0 ? std::sqrt(variance) : 1;
  for (float& value : image)
  {
    value = static_cast<float>((value - mean) / deviation);
  }
  return -mean / deviation;
}

/// From below the thinner parts to the densest.
Extent WindowOf(const HungImages& images, double air)
{
  std::vector<float> inside;
  for (std::size_t pixel = 0; pixel < images.Real.size(); ++pixel)
  {
    if (images.IsCompared(pixel))
    {
      inside.push_back(images.Real[pixel]);
    }
  }
  if (inside.size() <= 100)
  {
    return { -3, 2 };
  }
  std::sort(inside.begin(), inside.end());
  const double tenth = inside[inside.size() / 10];
  const double high = inside[inside.size() - 1 - inside.size() / 500];
  return { std::min(std::max(tenth - (high - tenth), air), high - 0.5), high };
}

HungImages HangImages(const RegistrationTarget& target, const SyntheticMammogram& synthetic,
  const Mammogram& mammogram, Hanging& hanging)
{
  std::vector<float> finite;
  std::vector<float> inSynthetic;
  std::vector<float> excluded;
  std::vector<unsigned char> shown;
  for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
  {
    const float value = synthetic.LogAttenuation[pixel];
    finite.push_back(std::isfinite(value) ? value : 0);
    const bool inReal = target.BreastMask[pixel] != 0;
    const bool inside = finite.back() > 1e-6F; // float noise of rays that meet nothing
    inSynthetic.push_back(inside ? 1 : 0);
    excluded.push_back(inReal && IsExcluded(target, pixel) ? 1 : 0);
    shown.push_back(inReal || inside ? 1 : 0);
  }
  hanging = Hang(mammogram, target.Grid, shown);
  HungImages images;
  images.Real = Resample(target.Grid, target.LogAttenuation, hanging);
  images.Synthetic = Resample(target.Grid, finite, hanging);
  images.Distance = Resample(target.Grid, target.SignedDistanceMm, hanging);
  images.InSynthetic = Resample(target.Grid, inSynthetic, hanging);
  images.Excluded = Resample(target.Grid, excluded, hanging);
  const double realAir = Standardise(images, images.Real);
  const double syntheticAir = Standardise(images, images.Synthetic);
  images.Window = WindowOf(images, std::max(realAir, syntheticAir));
  return images;
}

/// Blue, white, red for -1, 0, +1.
PictureColor Diverging(double value)
{
  constexpr PictureColor White{ 255, 255, 255 };
  constexpr PictureColor Blue{ 33, 102, 171 };
  constexpr PictureColor Red{ 179, 23, 43 };
  return Mixed(White, value < 0 ? Blue : Red, std::min(std::abs(value), 1.0));
}

PictureColor DifferenceColor(const HungImages& images, std::size_t pixel)
{
  const bool inReal = images.Distance[pixel] < 0;
  const bool inSynthetic = images.InSynthetic[pixel] > 0.5F;
  if (inReal && inSynthetic)
  {
    return images.Excluded[pixel] < 0.5F
      ? Diverging((images.Synthetic[pixel] - images.Real[pixel]) / DifferenceRange)
      : ExcludedColor;
  }
  return inReal ? RealColor : inSynthetic ? SyntheticColor : Paper;
}

/// Draws patient directions at the middles of the sides, and a scale bar.
void Annotate(Picture& picture, const Hanging& hanging, const PictureColor& color,
  const PictureColor& halo)
{
  picture.Letters({ 0, 0, 1.0 * picture.Width(), 1.0 * picture.Height() }, 2 * Margin,
    hanging.Letters, { color, 20, &halo });
  // On the nipple's side, where the picture is empty.
  const double lengthMm = picture.Width() * hanging.PixelMm > 60 ? 20 : 10;
  const double right =
    hanging.Right > 0 ? picture.Width() - Margin : Margin + lengthMm / hanging.PixelMm;
  picture.ScaleBar(right, Margin, lengthMm, hanging.PixelMm, { color, 14, &halo });
}

void DrawDifferenceScale(Picture& picture, const Hanging& hanging)
{
  constexpr int BarWidth = 18;
  constexpr double HalfText = 8;
  const bool barAtRight = hanging.Right > 0;
  const int height = picture.Height() / 4;
  const int left = barAtRight ? picture.Width() - Margin - BarWidth : Margin;
  const int low = picture.Height() - Margin - height;
  picture.Box(left - 1, low - 1, left + BarWidth + 1, low + height + 1, Ink);
  for (int y = 0; y < height; ++y)
  {
    picture.Box(left, low + y, left + BarWidth, low + y + 1, Diverging(2.0 * y / (height - 1) - 1));
  }
  const char* const ticks[] = { "-2", "0", "+2" };
  for (int tick = 0; tick < 3; ++tick)
  {
    picture.Text(barAtRight ? left - 8 : left + BarWidth + 8,
      low + HalfText + 0.5 * tick * (height - 2 * HalfText), barAtRight ? 1 : 0, ticks[tick],
      { Ink, 14 });
  }
}

/// A line of the receptor in the picture.
PictureLine LineOf(const std::vector<ReceptorPoint>& receptor, const Hanging& hanging)
{
  PictureLine line;
  for (const ReceptorPoint& point : receptor)
  {
    line.push_back(hanging.ToPicture(point));
  }
  return line;
}

/// Lines along which `distance` changes its sign.
std::vector<PictureLine> OutlineOf(const std::vector<float>& distance, const Hanging& hanging)
{
  std::vector<PictureLine> lines;
  for (const auto& line : ContourLines(distance.data(), hanging.Width, hanging.Height, 0))
  {
    PictureLine& points = lines.emplace_back();
    for (const auto& [x, y] : line)
    {
      points.push_back({ x + 0.5, y + 0.5 });
    }
  }
  return lines;
}

/// Crosses, ellipses and shadows of what was asked for.
std::string AnswerLines(const RegistrationReport& report, const ReceptorGrid& grid,
  const Hanging& hanging)
{
  SvgLines svg(hanging.Height);
  for (std::size_t index = 0; index < report.Places.size(); ++index)
  {
    const PlaceInMammogram& place = report.Places[index];
    if (!place.Problem.empty())
    {
      continue;
    }
    for (const auto& outline : place.Outlines)
    {
      std::vector<ReceptorPoint> receptor;
      receptor.reserve(outline.size());
      for (const auto& [column, row] : outline)
      {
        receptor.push_back(grid.PositionOf(column, row));
      }
      svg.Path(LineOf(receptor, hanging), true, MarkColor);
    }
    const ImagedPoint& imaged = place.Imaged;
    if (imaged.Uncertainty)
    {
      const auto ellipse =
        EllipsePoints(*imaged.Uncertainty, imaged.ReceptorMm, grid, Deviations95);
      svg.Path(LineOf(ellipse, hanging), true, MarkColor);
    }
    svg.Cross(hanging.ToPicture(imaged.ReceptorMm), report.Asked[index].ShortName, 1.6);
  }
  return svg.Elements();
}

/// Completes a picture: outlines are lines over the page's picture and part of the file's.
void Outline(Picture& picture, const std::vector<std::pair<PictureLine, PictureColor>>& outlines,
  LayeredPicture& layered, std::string& file)
{
  SvgLines svg(picture.Height());
  layered = { picture.Png(), picture.Width(), picture.Height(), {} };
  for (const auto& [line, color] : outlines)
  {
    svg.Path(line, false, color);
    picture.Lines(line, OutlineWidth, color);
  }
  layered.Lines = svg.Elements();
  file = picture.Png();
}
}

ReportPictures DrawPictures(const RegistrationReport& report)
{
  const RegistrationTarget& target = report.Registered->View.Target;
  const SyntheticMammogram& found = report.Registered->Registration.Synthetic;
  Hanging hanging;
  const HungImages hung = HangImages(target, found, report.Registered->Mammogram, hanging);
  const Extent& window = hung.Window;

  Picture real(hanging.Width, hanging.Height);
  Picture synthetic(hanging.Width, hanging.Height);
  Picture overlay(hanging.Width, hanging.Height);
  Picture difference(hanging.Width, hanging.Height);
  for (int y = 0; y < hanging.Height; ++y)
  {
    for (int x = 0; x < hanging.Width; ++x)
    {
      const std::size_t pixel = static_cast<std::size_t>(y) * hanging.Width + x;
      const auto grey = [&](float value) { return Grey((value - window.Low) / window.Length()); };
      const PictureColor a = grey(hung.Real[pixel]);
      const PictureColor b = grey(hung.Synthetic[pixel]);
      constexpr PictureColor ExcludedTint{ 170, 0, 213 };
      real.Set(x, y, hung.Excluded[pixel] < 0.5F ? a : Mixed(a, ExcludedTint, 0.3));
      synthetic.Set(x, y, b);
      // Complementary: where both agree the sum is grey.
      overlay.Set(x, y, { a[0], Mixed(a, b, 0.5)[0], b[0] });
      difference.Set(x, y, DifferenceColor(hung, pixel));
    }
  }
  DrawDifferenceScale(difference, hanging);
  for (Picture* picture : { &real, &synthetic, &overlay })
  {
    Annotate(*picture, hanging, LightInk, Black);
  }
  Annotate(difference, hanging, Ink, Paper);

  std::vector<std::pair<PictureLine, PictureColor>> ofReal;
  for (const PictureLine& line : OutlineOf(hung.Distance, hanging))
  {
    ofReal.emplace_back(line, RealColor);
  }
  auto ofBoth = ofReal;
  ofBoth.emplace_back(LineOf(found.Outline, hanging), SyntheticColor);
  ReportPictures pictures;
  Outline(real, ofReal, pictures.Real, pictures.Files[0]);
  Outline(synthetic, { ofBoth.back() }, pictures.Synthetic, pictures.Files[1]);
  Outline(overlay, ofBoth, pictures.Overlay, pictures.Files[2]);
  Outline(difference, ofBoth, pictures.Difference, pictures.Files[3]);
  if (!report.Places.empty())
  {
    pictures.Answer = pictures.Real;
    pictures.Answer.Lines = AnswerLines(report, target.Grid, hanging);
  }
  pictures.Wide = hanging.Width > 0.95 * hanging.Height;
  pictures.Letters = hanging.Letters;
  pictures.Up = hanging.Up;
  return pictures;
}
}
