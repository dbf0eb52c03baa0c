// SPDX-License-Identifier: Apache-2.0
#include "Private/ConvergencePlot.h"

#include "Private/Picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

namespace mammoray
{
namespace
{
// Size of the drawing and of its margins, pixels.
constexpr double Width = 960;
constexpr double Height = 320;
constexpr double Left = 74;
constexpr double Right = 150;
constexpr double Top = 18;
constexpr double Bottom = 52;

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
  /// Ends of the ordinate and the distance of its ticks; decades where it is logarithmic.
  double Low = 0;
  double High = 0;
  double Step = 1;

  double X(double number) const
  {
    return Left + (Width - Left - Right) * number / this->LastNumber;
  }
  double Y(double value) const
  {
    const double scaled =
      this->Logarithmic ? std::log10(std::max(value, std::pow(10.0, this->Low))) : value;
    return Height - Bottom -
      (Height - Top - Bottom) * (scaled - this->Low) / (this->High - this->Low);
  }
  bool Empty() const { return !(this->High > this->Low); }
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

/// A stream whose numbers have points whatever the locale.
std::ostringstream PlainStream()
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  return stream;
}

std::string AxesSvg(const PlotAxes& axes)
{
  std::ostringstream svg = PlainStream();
  std::ostringstream labels = PlainStream();
  svg << "<g stroke=\"#e5e7eb\">\n";
  for (double tick = axes.Low; tick <= axes.High + 1e-9 * axes.High; tick += axes.Step)
  {
    const double value = axes.Logarithmic ? std::pow(10.0, tick) : tick;
    const double y = axes.Y(value);
    svg << "<line x1=\"" << Left << "\" x2=\"" << Width - Right << "\" y1=\"" << y << "\" y2=\""
        << y << "\"/>\n";
    labels << "<text x=\"" << Left - 8 << "\" y=\"" << y + 4 << "\" text-anchor=\"end\">" << value
           << "</text>\n";
  }
  svg << "</g>\n<g fill=\"#4b5563\">\n" << labels.str();
  const int every = std::max(1, static_cast<int>(TickStep(axes.LastNumber, 10)));
  for (int number = 0; number <= axes.LastNumber; number += every)
  {
    svg << "<text x=\"" << axes.X(number) << "\" y=\"" << Height - Bottom + 18
        << "\" text-anchor=\"middle\">" << number << "</text>\n";
  }
  svg << "<text x=\"" << 0.5 * (Left + Width - Right) << "\" y=\"" << Height - 12
      << "\" text-anchor=\"middle\">Iteration</text>\n"
      << "<text transform=\"translate(18 " << 0.5 * (Top + Height - Bottom)
      << ") rotate(-90)\" text-anchor=\"middle\">Cost (half the sum of squared residuals)</text>\n"
      << "</g>\n<line x1=\"" << Left << "\" x2=\"" << Width - Right << "\" y1=\"" << Height - Bottom
      << "\" y2=\"" << Height - Bottom << "\" stroke=\"#6b7280\"/>\n";
  return svg.str();
}

/// A curve with its dots, and its line of the legend at the height `legend`.
std::string CurveSvg(const Curve& curve, const std::vector<RegistrationIteration>& iterations,
  const PlotAxes& axes, double legend)
{
  std::ostringstream svg = PlainStream();
  std::ostringstream dots = PlainStream();
  svg << "<g stroke=\"" << curve.Color << "\" fill=\"" << curve.Color
      << "\">\n<polyline fill=\"none\" stroke-width=\"2\" points=\"";
  for (const RegistrationIteration& iteration : iterations)
  {
    const double value = iteration.*curve.Value;
    if (std::isfinite(value))
    {
      svg << axes.X(iteration.Number) << ',' << axes.Y(value) << ' ';
      dots << "<circle cx=\"" << axes.X(iteration.Number) << "\" cy=\"" << axes.Y(value)
           << "\" r=\"3\"/>\n";
    }
  }
  const double x = Width - Right + 20;
  svg << "\"/>\n"
      << dots.str() << "<line x1=\"" << x << "\" x2=\"" << x + 22 << "\" y1=\"" << legend
      << "\" y2=\"" << legend << "\" stroke-width=\"2\"/>\n"
      << "<text x=\"" << x + 30 << "\" y=\"" << legend + 4 << "\" stroke=\"none\">" << curve.Name
      << "</text>\n</g>\n";
  return svg.str();
}
}

std::string ConvergencePlot(const std::vector<RegistrationIteration>& iterations)
{
  std::ostringstream svg = PlainStream();
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << Width << ' ' << Height
      << "\" width=\"" << Width << "\" height=\"" << Height
      << "\" font-family=\"system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif\" "
         "font-size=\"12\" role=\"img\" aria-label=\"Cost by iteration\">\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  const PlotAxes axes = AxesOf(iterations);
  if (axes.Empty())
  {
    svg << "<text x=\"" << Width / 2 << "\" y=\"" << Height / 2
        << "\" text-anchor=\"middle\" fill=\"#6b7280\">No iterations to show</text>\n</svg>\n";
    return svg.str();
  }
  svg << AxesSvg(axes);
  double legend = Top + 10;
  for (const Curve& curve : Curves)
  {
    svg << CurveSvg(curve, iterations, axes, legend);
    legend += 22;
  }
  svg << "</svg>\n";
  return svg.str();
}
}
