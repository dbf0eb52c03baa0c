// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportPictures.h"

#include "Private/Hanging.h"
#include "Private/Picture.h"
#include "Private/SvgLines.h"
#include "mammoray/Study/ContourLines.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr PictureColor ExcludedColor{ 191, 191, 199 };
constexpr PictureColor Black{ 0, 0, 0 };
constexpr PictureColor Paper{ 247, 247, 250 };
constexpr PictureColor Light{ 217, 222, 230 };
constexpr PictureColor Ink{ 38, 38, 51 };
constexpr double DifferenceRange = 2; // standard deviations
constexpr double OutlineWidth = 2.2;
constexpr int Margin = 12;

/// Both mammograms on the target's grid, comparable with each other.
struct ComparedImages
{
  /// z-scored over the pixels of both breasts that are compared; in the synthetic image finite.
  std::vector<float> Real;
  std::vector<float> Synthetic;
  /// 1 where the synthetic breast is, and where the real one is not compared.
  std::vector<float> InSynthetic;
  std::vector<float> Excluded;
  /// 1 in both breasts and compared, and in any of them.
  std::vector<unsigned char> Both;
  std::vector<unsigned char> Either;
  /// What air became in each image.
  double RealAir = 0;
  double SyntheticAir = 0;
};

/// Brings an image to mean 0 and standard deviation 1 over the pixels of both breasts and returns
/// what 0 (air) becomes.
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

ComparedImages ImagesOf(const RegistrationReport& report)
{
  const RegistrationTarget& target = *report.Target;
  ComparedImages images;
  images.Real = target.LogAttenuation;
  images.Synthetic = report.Result->Synthetic.LogAttenuation;
  for (std::size_t i = 0; i < images.Real.size(); ++i)
  {
    float& synthetic = images.Synthetic[i];
    synthetic = std::isfinite(synthetic) ? synthetic : 0;
    const bool inReal = target.BreastMask[i] != 0;
    const bool inSynthetic = synthetic > 1e-6F; // float noise of rays that meet nothing
    const bool excluded = inReal && IsExcluded(target, i);
    images.InSynthetic.push_back(inSynthetic ? 1 : 0);
    images.Excluded.push_back(excluded ? 1 : 0);
    images.Both.push_back(inReal && inSynthetic && !excluded ? 1 : 0);
    images.Either.push_back(inReal || inSynthetic ? 1 : 0);
  }
  images.RealAir = Standardise(images.Real, images.Both);
  images.SyntheticAir = Standardise(images.Synthetic, images.Both);
  return images;
}

/// The values that are black and white, in both pictures the same.
struct GreyWindow
{
  double Low = -3;
  double High = 2;

  double operator()(float value) const
  {
    return std::clamp((value - this->Low) / (this->High - this->Low), 0.0, 1.0);
  }
};

/// It reaches from below the thinner parts to the densest, and air is black in both.
GreyWindow WindowOf(const ComparedImages& images)
{
  std::vector<float> inside;
  for (std::size_t i = 0; i < images.Real.size(); ++i)
  {
    if (images.Both[i])
    {
      inside.push_back(images.Real[i]);
    }
  }
  GreyWindow window;
  if (inside.size() > 100)
  {
    std::sort(inside.begin(), inside.end());
    const double tenth = inside[inside.size() / 10];
    window.High = inside[inside.size() - 1 - inside.size() / 500];
    window.Low = tenth - (window.High - tenth);
    window.Low =
      std::min(std::max({ window.Low, images.RealAir, images.SyntheticAir }), window.High - 0.5);
  }
  return window;
}

/// What each picture's pixels show, row by row from below.
struct HungImages
{
  std::vector<float> Real;
  std::vector<float> Synthetic;
  /// Distance to the real outline, mm, negative inside.
  std::vector<float> Distance;
  /// Shares, [0, 1].
  std::vector<float> InSynthetic;
  std::vector<float> Excluded;
};

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

/// Patient directions at the middles of the sides, and a scale bar.
void Annotate(Picture& picture, const Hanging& hanging, const PictureColor& color,
  const PictureColor& halo)
{
  const double middleX = 0.5 * picture.Width();
  const double middleY = 0.5 * picture.Height();
  const PictureText letters{ color, 20, &halo };
  constexpr double HalfLetter = 12;
  picture.Text(Margin, middleY, 0, hanging.Letters[0], letters);
  picture.Text(picture.Width() - Margin, middleY, 1, hanging.Letters[1], letters);
  picture.Text(middleX, picture.Height() - Margin - HalfLetter, 0.5, hanging.Letters[2], letters);
  picture.Text(middleX, Margin + HalfLetter, 0.5, hanging.Letters[3], letters);

  // On the nipple's side, where the picture is empty.
  const double lengthMm = picture.Width() * hanging.PixelMm > 60 ? 20 : 10;
  const double length = std::lround(lengthMm / hanging.PixelMm);
  const double right = hanging.Right > 0 ? picture.Width() - Margin : Margin + length;
  picture.Box(right - length, Margin, right, Margin + 4, color);
  picture.Box(right - length, Margin, right - length + 3, Margin + 10, color);
  picture.Box(right - 3, Margin, right, Margin + 10, color);
  picture.Text(right - 0.5 * length, Margin + 22, 0.5, lengthMm == 20 ? "20 mm" : "10 mm",
    { color, 14, &halo });
}

void DrawDifferenceScale(Picture& picture, const Hanging& hanging)
{
  constexpr int BarWidth = 18;
  const int height = picture.Height() / 4;
  const int left = hanging.Right > 0 ? picture.Width() - Margin - BarWidth : Margin;
  const int low = picture.Height() - Margin - height;
  picture.Box(left - 1, low - 1, left + BarWidth + 1, low + height + 1, Ink);
  for (int y = 0; y < height; ++y)
  {
    picture.Box(left, low + y, left + BarWidth, low + y + 1, Diverging(2.0 * y / (height - 1) - 1));
  }
  for (const int tick : { -1, 0, 1 })
  {
    const bool barAtRight = hanging.Right > 0;
    constexpr double HalfText = 8;
    picture.Text(barAtRight ? left - 8 : left + BarWidth + 8,
      low + HalfText + 0.5 * (tick + 1) * (height - 2 * HalfText), barAtRight ? 1 : 0,
      tick < 0      ? "-2"
        : tick == 0 ? "0"
                    : "+2",
      { Ink, 14 });
  }
}

/// Lines of a picture, pixels from its lower left corner.
using PictureLines = std::vector<std::vector<PicturePoint>>;

PictureLines LinesOf(const std::vector<std::vector<std::array<double, 2>>>& receptor,
  const Hanging& hanging)
{
  PictureLines lines;
  for (const auto& line : receptor)
  {
    std::vector<PicturePoint>& points = lines.emplace_back();
    points.reserve(line.size());
    for (const auto& [x, y] : line)
    {
      const auto at = hanging.ToPicture(x, y);
      points.push_back({ at[0], at[1] });
    }
  }
  return lines;
}

/// Where `distance` changes its sign.
PictureLines OutlineOf(const std::vector<float>& distance, const Hanging& hanging)
{
  PictureLines lines;
  for (const auto& line : ContourLines(distance.data(), hanging.Width, hanging.Height, 0))
  {
    std::vector<PicturePoint>& points = lines.emplace_back();
    points.reserve(line.size());
    for (const auto& [x, y] : line)
    {
      points.push_back({ x + 0.5, y + 0.5 });
    }
  }
  return lines;
}

void DrawLines(Picture& picture, const PictureLines& lines, const PictureColor& color)
{
  for (const auto& line : lines)
  {
    for (std::size_t point = 1; point < line.size(); ++point)
    {
      picture.Line(line[point - 1], line[point], OutlineWidth, color);
    }
  }
}

std::string SvgOf(const Hanging& hanging,
  const std::vector<std::pair<const PictureLines*, PictureColor>>& parts)
{
  SvgLines svg(hanging.Height);
  for (const auto& [lines, color] : parts)
  {
    for (const auto& line : *lines)
    {
      svg.Path(line, false, color);
    }
  }
  return svg.Elements();
}

/// Crosses, ellipses and shadows of what was asked for, and the breast's outline.
std::string AnswerLines(const RegistrationReport& report, const Hanging& hanging)
{
  SvgLines svg(hanging.Height);
  for (std::size_t index = 0; index < report.Places.size(); ++index)
  {
    const PlaceInMammogram& place = report.Places[index];
    if (!place.Problem.empty())
    {
      continue;
    }
    for (const auto& outline : LinesOf(place.Outlines, hanging))
    {
      svg.Path(outline, true, MarkColor);
    }
    for (const auto& ellipse : LinesOf({ place.Ellipse }, hanging))
    {
      svg.Path(ellipse, true, MarkColor);
    }
    const auto at = hanging.ToPicture(place.ReceptorMm[0], place.ReceptorMm[1]);
    svg.Cross({ at[0], at[1] }, report.Asked[index].ShortName, 26, MarkColor);
  }
  return svg.Elements();
}
}

ReportPictures DrawPictures(const RegistrationReport& report)
{
  const RegistrationTarget& target = *report.Target;
  const ComparedImages images = ImagesOf(report);
  const GreyWindow window = WindowOf(images);
  const Hanging hanging = Hang(*report.RealMammogram, target.Grid, images.Either);
  const HungImages hung{ Resample(target.Grid, images.Real, hanging),
    Resample(target.Grid, images.Synthetic, hanging),
    Resample(target.Grid, target.SignedDistanceMm, hanging),
    Resample(target.Grid, images.InSynthetic, hanging),
    Resample(target.Grid, images.Excluded, hanging) };

  Picture real(hanging.Width, hanging.Height, Black);
  Picture synthetic(hanging.Width, hanging.Height, Black);
  Picture overlay(hanging.Width, hanging.Height, Black);
  Picture difference(hanging.Width, hanging.Height, Paper);
  for (int y = 0; y < hanging.Height; ++y)
  {
    for (int x = 0; x < hanging.Width; ++x)
    {
      const std::size_t pixel = static_cast<std::size_t>(y) * hanging.Width + x;
      const PictureColor a = Grey(window(hung.Real[pixel]));
      const PictureColor b = Grey(window(hung.Synthetic[pixel]));
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
    Annotate(*picture, hanging, Light, Black);
  }
  Annotate(difference, hanging, Ink, Paper);

  const PictureLines realOutline = OutlineOf(hung.Distance, hanging);
  const PictureLines syntheticOutline = LinesOf({ report.Result->Synthetic.Outline }, hanging);
  const std::pair<const PictureLines*, PictureColor> ofReal{ &realOutline, RealColor };
  const std::pair<const PictureLines*, PictureColor> ofSynthetic{ &syntheticOutline,
    SyntheticColor };
  const auto layered = [&](Picture& picture, const std::string& lines) {
    return LayeredPicture{ picture.Png(), hanging.Width, hanging.Height, lines };
  };
  ReportPictures pictures;
  pictures.Real = layered(real, SvgOf(hanging, { ofReal }));
  pictures.Synthetic = layered(synthetic, SvgOf(hanging, { ofSynthetic }));
  pictures.Overlay = layered(overlay, SvgOf(hanging, { ofReal, ofSynthetic }));
  pictures.Difference = layered(difference, SvgOf(hanging, { ofReal, ofSynthetic }));
  if (!report.Places.empty())
  {
    pictures.Answer = layered(real, AnswerLines(report, hanging));
  }
  for (Picture* picture : { &real, &overlay, &difference })
  {
    DrawLines(*picture, realOutline, RealColor);
  }
  for (Picture* picture : { &synthetic, &overlay, &difference })
  {
    DrawLines(*picture, syntheticOutline, SyntheticColor);
  }
  pictures.Files = { real.Png(), synthetic.Png(), overlay.Png(), difference.Png() };
  pictures.Wide = hanging.Width > 0.95 * hanging.Height;
  pictures.Letters = hanging.Letters;
  pictures.Up = hanging.Up;
  return pictures;
}
}
