// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"
#include "Private/ReportParts.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
// Size of the drawing and of its margins, pixels.
constexpr double Width = 960;
constexpr double Height = 320;
constexpr double Left = 74;
constexpr double Right = 810;
constexpr double Top = 18;
constexpr double Bottom = 268;

struct Curve
{
  const char* Name;
  const char* Color;
  double RegistrationIteration::*Value;
};
constexpr Curve Curves[] = { { "Total", "#1f2937", &RegistrationIteration::Cost },
  { "Outline", "#d97706", &RegistrationIteration::OutlineCost },
  { "Intensity", "#0284c7", &RegistrationIteration::IntensityCost } };

/// What the axes span, and where a value lies on them.
struct PlotAxes
{
  int LastNumber = 1;
  bool Logarithmic = false;
  /// Ends of the ordinate and the distance of its ticks; decades if it is logarithmic.
  double Low = 0;
  double High = 0;
  double Step = 1;

  double X(double number) const { return Left + (Right - Left) * number / this->LastNumber; }
  double Y(double value) const
  {
    const double scaled =
      this->Logarithmic ? std::log10(std::max(value, std::pow(10.0, this->Low))) : value;
    return Bottom - (Bottom - Top) * (scaled - this->Low) / (this->High - this->Low);
  }
};

PlotAxes AxesOf(const std::vector<RegistrationIteration>& iterations)
{
  PlotAxes axes;
  double largest = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (const RegistrationIteration& iteration : iterations)
  {
    axes.LastNumber = std::max(axes.LastNumber, iteration.Number);
    for (const Curve& curve : Curves)
    {
      const double value = iteration.*curve.Value;
      largest = std::isfinite(value) ? std::max(largest, value) : largest;
      smallest = value > 0 ? std::min(smallest, value) : smallest;
    }
  }
  if (largest > 0)
  {
    axes.Logarithmic = largest / smallest > 20;
    axes.Step = axes.Logarithmic ? 1 : TickStep(largest, 5);
    axes.Low = axes.Logarithmic ? std::floor(std::log10(smallest)) : 0;
    axes.High = axes.Logarithmic ? std::ceil(std::log10(largest) + 1e-9)
                                 : axes.Step * std::ceil(largest / axes.Step);
  }
  return axes;
}

/// The begin of an SVG element with attributes that are numbers.
std::string Begin(const char* element,
  const std::vector<std::pair<const char*, double>>& attributes)
{
  std::string svg = element;
  for (const auto& [name, value] : attributes)
  {
    svg += name;
    svg += "=\"";
    svg += NumberText(value);
    svg += "\" ";
  }
  return svg;
}

std::string LineSvg(double x1, double x2, double y, const std::string& style)
{
  return Begin("<line ", { { "x1", x1 }, { "x2", x2 }, { "y1", y }, { "y2", y } }) + style + "/>\n";
}

std::string TextSvg(double x, double y, const char* anchor, const std::string& text)
{
  return Begin("<text ", { { "x", x }, { "y", y } }) + "text-anchor=\"" + anchor + "\">" + text +
    "</text>\n";
}

std::string AxesSvg(const PlotAxes& axes)
{
  std::string svg = "<g fill=\"#4b5563\">\n";
  for (double tick = axes.Low; tick <= axes.High + 1e-9 * axes.High; tick += axes.Step)
  {
    const double value = axes.Logarithmic ? std::pow(10.0, tick) : tick;
    svg += LineSvg(Left, Right, axes.Y(value), "stroke=\"#e5e7eb\"") +
      TextSvg(Left - 8, axes.Y(value) + 4, "end", NumberText(value));
  }
  const int every = std::max(1, static_cast<int>(TickStep(axes.LastNumber, 10)));
  for (int number = 0; number <= axes.LastNumber; number += every)
  {
    svg += TextSvg(axes.X(number), Bottom + 18, "middle", NumberText(number));
  }
  return svg + TextSvg(0.5 * (Left + Right), Height - 12, "middle", "Iteration") +
    "<g transform=\"translate(18 143) rotate(-90)\">" +
    TextSvg(0, 0, "middle", "Cost (half the sum of squared residuals)") + "</g>\n</g>\n" +
    LineSvg(Left, Right, Bottom, "stroke=\"#6b7280\"");
}

/// A curve with its dots, and its line of the legend at the height `legend`.
std::string CurveSvg(const Curve& curve, const std::vector<RegistrationIteration>& iterations,
  const PlotAxes& axes, double legend)
{
  std::string points;
  std::string dots;
  for (const RegistrationIteration& iteration : iterations)
  {
    const double value = iteration.*curve.Value;
    if (std::isfinite(value))
    {
      const double x = axes.X(iteration.Number);
      const double y = axes.Y(value);
      points += NumberText(x) + "," + NumberText(y) + " ";
      dots += Begin("<circle ", { { "cx", x }, { "cy", y }, { "r", 3 } }) + "/>\n";
    }
  }
  const std::string color = std::string("\"") + curve.Color + "\"";
  return "<g fill=" + color + ">\n<polyline fill=\"none\" stroke-width=\"2\" stroke=" + color +
    " points=\"" + points + "\"/>\n" + dots +
    LineSvg(Right + 20, Right + 42, legend, "stroke-width=\"2\" stroke=" + color) +
    TextSvg(Right + 50, legend + 4, "start", curve.Name) + "</g>\n";
}
}

std::string ConvergencePlot(const std::vector<RegistrationIteration>& iterations)
{
  std::string svg = Begin("<svg ", { { "width", Width }, { "height", Height } }) +
    "viewBox=\"0 0 960 320\" xmlns=\"http://www.w3.org/2000/svg\" "
    "font-family=\"system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif\" "
    "font-size=\"12\" role=\"img\" aria-label=\"Cost by iteration\">\n"
    "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  const PlotAxes axes = AxesOf(iterations);
  if (!(axes.High > axes.Low))
  {
    return svg + TextSvg(0.5 * Width, 0.5 * Height, "middle", "No iterations to show") + "</svg>\n";
  }
  svg += AxesSvg(axes);
  double legend = Top + 10;
  for (const Curve& curve : Curves)
  {
    svg += CurveSvg(curve, iterations, axes, legend);
    legend += 22;
  }
  return svg + "</svg>\n";
}
}
