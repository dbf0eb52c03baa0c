// SPDX-License-Identifier: Apache-2.0
#include "DrawnSlices.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/Segmentation/BreastSegmentation.h"
#include "mammoray/Study/LandmarkEvaluation.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

namespace mammoray
{
namespace
{
constexpr double StepMm = 0.5;
/// Labels are also sampled around the judged part, so that its rim has neighbours.
constexpr double AroundMm = 20;
/// Beyond every patient, mm.
constexpr double FarMm = 1000;
/// A point this close to an uncertain piece lies on it, mm.
constexpr double OnLineMm = 0.3;

/// Axes of the slice's coordinates; the front is at small values of the axis 1 of LPS.
std::array<std::size_t, 2> AxesIn(const DrawnSlice& slice)
{
  return { slice.Normal == 0 ? 1U : 0U, slice.Normal == 2 ? 1U : 2U };
}

/// Even-odd rule.
bool IsInside(const DrawnLine& polygon, const DrawnPoint& point)
{
  bool inside = false;
  for (std::size_t at = 0; at < polygon.size(); ++at)
  {
    const DrawnPoint& a = polygon[at];
    const DrawnPoint& b = polygon[(at + 1) % polygon.size()];
    if ((a[1] > point[1]) != (b[1] > point[1]) &&
      point[0] < a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
    {
      inside = !inside;
    }
  }
  return inside;
}

bool IsInAny(const std::vector<DrawnLine>& polygons, const DrawnPoint& point)
{
  return std::any_of(polygons.begin(), polygons.end(),
    [&](const DrawnLine& polygon) { return IsInside(polygon, point); });
}

bool IsJudged(const DrawnSlice& slice, const DrawnPoint& point)
{
  const auto& [left, right, low, high] = slice.Judged;
  return point[0] >= left && point[0] <= right && point[1] >= low && point[1] <= high;
}

/// Infinite without lines.
double DistanceTo(const std::vector<DrawnLine>& lines, const DrawnPoint& point)
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const DrawnLine& line : lines)
  {
    for (std::size_t at = 0; at + 1 < line.size(); ++at)
    {
      const DrawnPoint along{ line[at + 1][0] - line[at][0], line[at + 1][1] - line[at][1] };
      const DrawnPoint to{ point[0] - line[at][0], point[1] - line[at][1] };
      const double squared = along[0] * along[0] + along[1] * along[1];
      const double share =
        squared > 0 ? std::clamp((to[0] * along[0] + to[1] * along[1]) / squared, 0.0, 1.0) : 0.0;
      nearest = std::min(nearest, std::hypot(to[0] - share * along[0], to[1] - share * along[1]));
    }
  }
  return nearest;
}

double DistanceTo(const DrawnLine& points, const DrawnPoint& point)
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const DrawnPoint& other : points)
  {
    nearest = std::min(nearest, std::hypot(other[0] - point[0], other[1] - point[1]));
  }
  return nearest;
}

/// Points of the lines at most a step apart.
DrawnLine PointsAlong(const std::vector<DrawnLine>& lines)
{
  DrawnLine points;
  for (const DrawnLine& line : lines)
  {
    for (std::size_t at = 0; at + 1 < line.size(); ++at)
    {
      const DrawnPoint& a = line[at];
      const DrawnPoint& b = line[at + 1];
      const int steps =
        std::max(1, static_cast<int>(std::ceil(std::hypot(b[0] - a[0], b[1] - a[1]) / StepMm)));
      for (int step = 0; step < steps; ++step)
      {
        const double share = static_cast<double>(step) / steps;
        points.push_back({ a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]) });
      }
    }
  }
  return points;
}

/// What outline and chest wall enclose.
std::vector<DrawnLine> BreastOf(const DrawnSlice& slice)
{
  std::vector<DrawnLine> breast = slice.Outline;
  for (const DrawnLine& wall : slice.ChestWall)
  {
    breast.front().insert(breast.front().end(), wall.rbegin(), wall.rend());
  }
  return breast;
}

/// Everything in front of the chest wall, which goes on straight sideways; a closed line.
DrawnLine FrontOf(const DrawnLine& wall, std::size_t anterior)
{
  const std::size_t across = 1 - anterior;
  const double side = wall.front()[across] < wall.back()[across] ? FarMm : -FarMm;
  DrawnLine front = wall;
  const auto add = [&](double acrossMm, double anteriorMm)
  {
    DrawnPoint& corner = front.emplace_back();
    corner[across] = acrossMm;
    corner[anterior] = anteriorMm;
  };
  add(side, wall.back()[anterior]);
  add(side, -FarMm);
  add(-side, -FarMm);
  add(-side, wall.front()[anterior]);
  return front;
}

bool IsBreast(int label)
{
  return label != static_cast<int>(TissueLabel::Air) &&
    label != static_cast<int>(TissueLabel::ChestWall);
}

/// The labels in a slice.
class SampledSlice
{
public:
  SampledSlice(const LabelVolume& labels, const DrawnSlice& slice)
  {
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      this->Low[axis] = slice.Judged[2 * axis] - AroundMm;
      const double length = slice.Judged[2 * axis + 1] + AroundMm - this->Low[axis];
      this->Size[axis] = static_cast<std::size_t>(std::max(0.0, std::ceil(length / StepMm)));
    }
    const auto [first, second] = AxesIn(slice);
    for (std::size_t row = 0; row < this->Size[1]; ++row)
    {
      for (std::size_t column = 0; column < this->Size[0]; ++column)
      {
        Vector3 point;
        point[slice.Normal] = slice.PositionMm;
        point[first] = this->PointAt(column, row)[0];
        point[second] = this->PointAt(column, row)[1];
        this->Labels.push_back(labels.LabelAt(point));
      }
    }
  }

  /// Calls visit(point, label) for each sample.
  template <typename Visit>
  void ForEach(const Visit& visit) const
  {
    for (std::size_t at = 0; at < this->Labels.size(); ++at)
    {
      visit(this->PointAt(at % this->Size[0], at / this->Size[0]), this->Labels[at]);
    }
  }

  /// The middles between neighbours of which isBorder(label, other label) is true, either way.
  template <typename IsBorder>
  DrawnLine BorderPoints(const IsBorder& isBorder) const
  {
    DrawnLine points;
    const auto add = [&](std::size_t at, std::size_t next)
    {
      const int a = this->Labels[at];
      const int b = this->Labels[next];
      if (a != b && (isBorder(a, b) || isBorder(b, a)))
      {
        const DrawnPoint from = this->PointAt(at % this->Size[0], at / this->Size[0]);
        const DrawnPoint to = this->PointAt(next % this->Size[0], next / this->Size[0]);
        points.push_back({ 0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]) });
      }
    };
    for (std::size_t at = 0; at < this->Labels.size(); ++at)
    {
      if (at % this->Size[0] + 1 < this->Size[0])
      {
        add(at, at + 1);
      }
      if (at + this->Size[0] < this->Labels.size())
      {
        add(at, at + this->Size[0]);
      }
    }
    return points;
  }

private:
  DrawnPoint PointAt(std::size_t column, std::size_t row) const
  {
    return { this->Low[0] + StepMm * (static_cast<double>(column) + 0.5),
      this->Low[1] + StepMm * (static_cast<double>(row) + 0.5) };
  }

  DrawnPoint Low{ 0, 0 };
  std::array<std::size_t, 2> Size{ 0, 0 };
  std::vector<std::uint16_t> Labels;
};

/// Adds the distances between drawn lines and border points of the labels, both ways.
void AddDistances(const DrawnSlice& slice, const std::vector<DrawnLine>& drawn,
  const std::vector<DrawnLine>& uncertain, const DrawnLine& found, std::vector<double>& distances)
{
  for (const DrawnPoint& point : PointsAlong(drawn))
  {
    if (IsJudged(slice, point) && DistanceTo(uncertain, point) > OnLineMm)
    {
      distances.push_back(DistanceTo(found, point));
    }
  }
  for (const DrawnPoint& point : found)
  {
    if (IsJudged(slice, point))
    {
      const double distance = DistanceTo(drawn, point);
      if (DistanceTo(uncertain, point) > distance + 1e-6)
      {
        distances.push_back(distance);
      }
    }
  }
}

/// Twice what two regions have in common, and what they have in all; samples.
struct RegionOverlap
{
  double Common = 0;
  double Sum = 0;

  void Add(bool isFound, bool isTrue)
  {
    this->Common += isFound && isTrue ? 2 : 0;
    this->Sum += (isFound ? 1 : 0) + (isTrue ? 1 : 0);
  }
  double Dice() const { return this->Common / this->Sum; }
};

LineDistance SummaryOf(const std::vector<double>& distances)
{
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (std::count(distances.begin(), distances.end(), infinite) > 0)
  {
    return { infinite, infinite };
  }
  return { std::accumulate(distances.begin(), distances.end(), 0.0) /
      static_cast<double>(distances.size()),
    Quantile(distances, 0.95) };
}

DrawnSlice SliceOf(const nlohmann::json& json)
{
  const std::array<std::string, 3> planes{ "sagittal", "coronal", "axial" };
  const std::string plane = json.at("plane").get<std::string>();
  const auto normal = std::find(planes.begin(), planes.end(), plane);
  const auto lines = [&](const char* key)
  { return json.value(key, nlohmann::json::array()).get<std::vector<DrawnLine>>(); };
  DrawnSlice slice;
  slice.Normal = static_cast<std::size_t>(normal - planes.begin());
  slice.PositionMm = json.at("position").get<double>();
  slice.Judged = json.at("judged").get<std::array<double, 4>>();
  slice.Outline = lines("outline");
  slice.ChestWall = lines("chestWall");
  slice.Gland = lines("gland");
  slice.OutlineUncertain = lines("outlineUncertain");
  slice.ChestWallUncertain = lines("chestWallUncertain");
  if (normal == planes.end())
  {
    throw InputError("expected a plane axial, coronal or sagittal, found '" + plane + "'");
  }
  if (slice.Outline.empty() || slice.ChestWall.size() > 1 ||
    (slice.ChestWall.size() == 1 && (slice.Outline.size() != 1 || slice.ChestWall[0].empty())))
  {
    throw InputError("expected one outline and one chest wall, or outlines without a chest wall");
  }
  return slice;
}
}

std::vector<DrawnSlice> ReadDrawnSlices(const std::string& path)
{
  std::ifstream file(path);
  try
  {
    const nlohmann::json json = nlohmann::json::parse(file, JsonNestingLimit{ path });
    std::vector<DrawnSlice> slices;
    for (const nlohmann::json& slice : json.at("slices"))
    {
      slices.push_back(SliceOf(slice));
    }
    return slices;
  }
  catch (const std::exception& error)
  {
    throw InputError(path + ": not a file of drawn slices: " + error.what());
  }
}

DrawnAgreement CompareWithDrawn(const LabelVolume& labels, const std::vector<DrawnSlice>& slices)
{
  RegionOverlap breast;
  RegionOverlap gland;
  std::vector<double> outlineMm;
  std::vector<double> chestWallMm;
  for (const DrawnSlice& slice : slices)
  {
    const SampledSlice sampled(labels, slice);
    const std::vector<DrawnLine> drawn = BreastOf(slice);
    sampled.ForEach(
      [&](const DrawnPoint& point, int label)
      {
        if (IsJudged(slice, point))
        {
          breast.Add(IsBreast(label), IsInAny(drawn, point));
          if (!slice.Gland.empty())
          {
            gland.Add(label == static_cast<int>(TissueLabel::Gland), IsInAny(slice.Gland, point));
          }
        }
      });

    DrawnLine skin = sampled.BorderPoints([](int air, int) { return air == 0; });
    std::vector<DrawnLine> outline = slice.Outline;
    for (const DrawnLine& wall : slice.ChestWall)
    {
      const DrawnLine front = FrontOf(wall, slice.Normal == 0 ? 0 : 1);
      std::erase_if(skin, [&](const DrawnPoint& point) { return !IsInside(front, point); });
    }
    if (slice.ChestWall.empty())
    {
      for (DrawnLine& closed : outline)
      {
        closed.push_back(closed.front());
      }
    }
    AddDistances(slice, outline, slice.OutlineUncertain, skin, outlineMm);
    if (!slice.ChestWall.empty())
    {
      const DrawnLine wall = sampled.BorderPoints([](int chest, int other)
        { return chest == static_cast<int>(TissueLabel::ChestWall) && IsBreast(other); });
      AddDistances(slice, slice.ChestWall, slice.ChestWallUncertain, wall, chestWallMm);
    }
  }
  return { breast.Dice(), gland.Dice(), SummaryOf(outlineMm), SummaryOf(chestWallMm) };
}
}
