// SPDX-License-Identifier: Apache-2.0
#include "Private/MammogramMask.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mammoray
{
namespace
{
/// The muscle's edge is looked for in pixels of this size, mm.
constexpr double SearchPixelMm = 1.0;

/// Sees a target from its corner at the chest wall and the head.
class Corner
{
public:
  Corner(const RegistrationTarget& target, int headward)
    : Target(target)
    , Headward(headward)
  {
    double top = -std::numeric_limits<double>::infinity();
    double bottom = -top;
    std::vector<double> values;
    for (int row = 0; row < target.Grid.Rows; ++row)
    {
      for (int column = 0; column < target.Grid.Columns; ++column)
      {
        const std::size_t pixel = target.Grid.Index(column, row);
        if (target.BreastMask[pixel] == 0)
        {
          continue;
        }
        const ReceptorPoint point = target.Grid.PositionOf(column, row);
        const double height = headward * point[0];
        values.push_back(target.LogAttenuation[pixel]);
        this->DepthMm = std::max(this->DepthMm, point[1]);
        constexpr double nearMm = 5;
        if (point[1] < nearMm)
        {
          top = std::max(top, height);
          bottom = std::min(bottom, height);
        }
      }
    }
    this->TopMm = top;
    this->HeightMm = top - bottom;
    double mean = 0;
    for (const double value : values)
    {
      mean += value / static_cast<double>(values.size());
    }
    for (const double value : values)
    {
      this->Deviation += (value - mean) * (value - mean) / static_cast<double>(values.size());
    }
    this->Deviation = std::sqrt(this->Deviation);
  }

  /// Log attenuation `down` from the top towards the feet and `out` from the chest wall, mm, if
  /// that is breast.
  std::optional<double> At(double down, double out) const
  {
    const std::array<double, 2> place =
      this->Target.Grid.IndexOf({ this->Headward * (this->TopMm - down), out });
    const long column = std::lround(place[0]);
    const long row = std::lround(place[1]);
    if (column < 0 || row < 0 || column >= this->Target.Grid.Columns ||
      row >= this->Target.Grid.Rows)
    {
      return std::nullopt;
    }
    const auto pixel =
      static_cast<std::size_t>(row) * this->Target.Grid.Columns + static_cast<std::size_t>(column);
    return this->Target.BreastMask[pixel] == 0
      ? std::nullopt
      : std::optional<double>(this->Target.LogAttenuation[pixel]);
  }

  const RegistrationTarget& Target;
  int Headward;
  /// Height of the breast's end at the chest wall towards the head, along headward x; how far it
  /// reaches from there towards the feet, and away from the chest wall, mm.
  double TopMm = 0;
  double HeightMm = 0;
  double DepthMm = 0;
  /// Standard deviation of log attenuation in the breast.
  double Deviation = 0;
};

/// How much like the muscle's edge a line is.
struct LineScore
{
  double Score = 0;
  double Contrast = 0;
};

/// The line from `out` away from the chest wall at the top to `down` at the chest wall, mm.
LineScore ScoreLine(const Corner& corner, double out, double down)
{
  const double length = std::hypot(out, down);
  // Away from the corner.
  const double normalDown = out / length;
  const double normalOut = down / length;
  int count = 0;
  int brighter = 0;
  double sum = 0;
  double capped = 0;
  for (double along = 0; along <= length; along += SearchPixelMm)
  {
    const double atDown = down * along / length;
    const double atOut = out * (1 - along / length);
    double step = 0;
    int pairs = 0;
    for (const double distance : { 1.0, 2.5, 4.0 })
    {
      const auto inner = corner.At(atDown - distance * normalDown, atOut - distance * normalOut);
      const auto outer = corner.At(atDown + distance * normalDown, atOut + distance * normalOut);
      if (inner && outer)
      {
        step += (*inner - *outer) / corner.Deviation;
        ++pairs;
      }
    }
    if (pairs > 0)
    {
      step /= pairs;
      ++count;
      brighter += step > 0 ? 1 : 0;
      sum += step;
      // A single bright place is no edge, a long weak step no muscle.
      capped += std::clamp(step, -1.5, 1.5);
    }
  }
  constexpr double shortestMm = 25;
  if (count * SearchPixelMm < std::max(shortestMm, 0.6 * length) || brighter < 0.75 * count)
  {
    return {};
  }
  return { capped / std::sqrt(static_cast<double>(count)), sum / count };
}

void AllowExclusion(RegistrationTarget& target)
{
  target.Excluded.resize(target.BreastMask.size(), 0);
}
}

std::optional<PectoralEdge> FindPectoralEdge(const RegistrationTarget& target, int headward)
{
  const RegistrationTarget coarse = CoarsenTo(target, SearchPixelMm);
  const Corner corner(coarse, headward);
  if (!(corner.HeightMm > 0) || !(corner.Deviation > 0))
  {
    return std::nullopt;
  }
  LineScore best;
  double bestOut = 0;
  double bestDown = 0;
  constexpr double stepMm = 2;
  constexpr double leastMm = 10;
  // The muscle runs steeply: it reaches at least as far down as out.
  for (double out = leastMm; out < 0.8 * corner.DepthMm; out += stepMm)
  {
    for (double down = out; down < 0.9 * corner.HeightMm; down += stepMm)
    {
      const LineScore line = ScoreLine(corner, out, down);
      if (line.Score > best.Score)
      {
        best = line;
        bestOut = out;
        bestDown = down;
      }
    }
  }
  // Muscles in real oblique views: 1.1 and 1.2; the best line where there is none: 0.2 and 0.3.
  constexpr double leastContrast = 0.6;
  if (best.Contrast < leastContrast)
  {
    return std::nullopt;
  }
  return PectoralEdge{ { headward * corner.TopMm, bestOut },
    { headward * (corner.TopMm - bestDown), 0 }, best.Contrast };
}

void ExcludePectoral(const PectoralEdge& edge, int headward, RegistrationTarget& target)
{
  AllowExclusion(target);
  constexpr double marginMm = 2;
  const double out = edge.Head[1];
  const double down = headward * (edge.Head[0] - edge.ChestWall[0]);
  const double length = std::hypot(out, down);
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      const ReceptorPoint point = target.Grid.PositionOf(column, row);
      const double fromHead = headward * (edge.Head[0] - point[0]);
      // Distance from the line, negative towards the corner and everything above it.
      const double distance = (fromHead * out + (point[1] - out) * down) / length;
      if (distance < marginMm)
      {
        target.Excluded[target.Grid.Index(column, row)] = 1;
      }
    }
  }
}

double ExcludeSaturated(RegistrationTarget& target)
{
  const std::size_t count = target.BreastMask.size();
  float brightest = -std::numeric_limits<float>::infinity();
  std::size_t breast = 0;
  for (std::size_t pixel = 0; pixel < count; ++pixel)
  {
    brightest = std::max(brightest, target.LogAttenuation[pixel]);
    breast += target.BreastMask[pixel];
  }
  std::vector<std::size_t> saturated;
  for (std::size_t pixel = 0; pixel < count; ++pixel)
  {
    if (target.BreastMask[pixel] != 0 && target.LogAttenuation[pixel] >= brightest)
    {
      saturated.push_back(pixel);
    }
  }
  const double pixelMm2 = std::abs(target.Grid.ColumnStep[0] * target.Grid.RowStep[1] -
    target.Grid.ColumnStep[1] * target.Grid.RowStep[0]);
  constexpr double leastMm2 = 0.5;
  const double area = static_cast<double>(saturated.size()) * pixelMm2;
  if (area < leastMm2 || saturated.size() >= breast / 20)
  {
    return 0;
  }
  AllowExclusion(target);
  const double pixelMm = std::sqrt(pixelMm2);
  const int reach = std::max(1, static_cast<int>(std::lround(0.5 / pixelMm)));
  for (const std::size_t pixel : saturated)
  {
    const int column = static_cast<int>(pixel % target.Grid.Columns);
    const int row = static_cast<int>(pixel / target.Grid.Columns);
    for (int y = std::max(0, row - reach); y <= std::min(target.Grid.Rows - 1, row + reach); ++y)
    {
      for (int x = std::max(0, column - reach);
           x <= std::min(target.Grid.Columns - 1, column + reach); ++x)
      {
        target.Excluded[static_cast<std::size_t>(y) * target.Grid.Columns + x] = 1;
      }
    }
  }
  return area;
}
}
