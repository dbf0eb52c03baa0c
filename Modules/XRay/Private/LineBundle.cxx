// SPDX-License-Identifier: Apache-2.0
#include "Private/LineBundle.h"

#include "mammoray/Foundation/FaceTable.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/Foundation/SurfaceOverlap.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numeric>

namespace mammoray
{
namespace
{
using Place = std::array<double, 2>;

/// Triangles that a thread is worth.
constexpr std::size_t Grain = 4096;

Vector3 PointOf(const SurfaceMesh& surface, std::size_t point)
{
  return { surface.Points[3 * point], surface.Points[3 * point + 1],
    surface.Points[3 * point + 2] };
}

/// Where things are seen from the source, in coordinates in which its lines are points.
class Shadows
{
public:
  Shadows(const SurfaceMesh& surface, const XRaySource& source)
    : IsPoint(source.Type == XRaySource::Kind::Point)
    , Origin(this->IsPoint ? source.Position : Vector3{ 0, 0, 0 })
  {
    Vector3 way = source.Direction;
    if (this->IsPoint)
    {
      const auto axes =
        ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, surface.Points);
      way = Vector3{ axes[0].Middle(), axes[1].Middle(), axes[2].Middle() } - source.Position;
    }
    this->Forward = (1 / Norm(way)) * way;
    const CrossingLine axis(this->Origin, this->Forward);
    this->U = axis.AcrossDirections()[0];
    this->V = axis.AcrossDirections()[1];
  }

  /// Whether the surface lies before the source, not so near that shadows lose their digits.
  bool Exist(const SurfaceMesh& surface) const
  {
    if (!this->IsPoint)
    {
      return true;
    }
    Extent depth;
    for (std::size_t point = 0; point < surface.NumberOfPoints(); ++point)
    {
      depth.Add(Dot(PointOf(surface, point) - this->Origin, this->Forward));
    }
    return depth.Low > 1e-3 * depth.High;
  }

  Place Of(const Vector3& point) const
  {
    const Vector3 from = point - this->Origin;
    const double depth = this->IsPoint ? Dot(from, this->Forward) : 1;
    return { Dot(from, this->U) / depth, Dot(from, this->V) / depth };
  }
  Place Of(const CrossingLine& line) const
  {
    return this->Of(this->IsPoint ? this->Origin + line.Direction() : line.Begin());
  }

private:
  bool IsPoint;
  Vector3 Origin;
  Vector3 Forward{};
  Vector3 U{};
  Vector3 V{};
};

/// Lines as points in the cells of a grid over the surface's shadow.
class LineGrid
{
public:
  LineGrid(const std::array<Extent, 2>& shadow, const std::vector<Place>& lines)
    : Shadow(shadow)
    , Lines(lines)
    , Across(std::max<std::size_t>(1, static_cast<std::size_t>(std::sqrt(lines.size()))))
    , Begins(this->Across * this->Across + 1, 0)
  {
    std::vector<std::size_t> cells(lines.size(), this->Begins.size());
    for (std::size_t line = 0; line < lines.size(); ++line)
    {
      if (this->IsInside(lines[line]))
      {
        cells[line] =
          this->CellAt(1, lines[line][1]) * this->Across + this->CellAt(0, lines[line][0]);
        this->Begins[cells[line] + 1] += 1;
      }
    }
    std::partial_sum(this->Begins.begin(), this->Begins.end(), this->Begins.begin());
    this->Order.resize(this->Begins.back());
    std::vector<std::uint32_t> next = this->Begins;
    for (std::size_t line = 0; line < lines.size(); ++line)
    {
      if (cells[line] < this->Begins.size())
      {
        this->Order[next[cells[line]]++] = static_cast<std::uint32_t>(line);
      }
    }
  }

  /// Calls visit(line) for those whose points lie in a rectangle.
  template <typename Visit>
  void ForEachIn(const std::array<Extent, 2>& where, const Visit& visit) const
  {
    const std::size_t first = this->CellAt(0, where[0].Low);
    const std::size_t last = this->CellAt(0, where[0].High);
    const std::size_t lastRow = this->CellAt(1, where[1].High);
    for (std::size_t row = this->CellAt(1, where[1].Low); row <= lastRow; ++row)
    {
      const std::uint32_t end = this->Begins[row * this->Across + last + 1];
      for (std::uint32_t n = this->Begins[row * this->Across + first]; n < end; ++n)
      {
        const Place& place = this->Lines[this->Order[n]];
        if (where[0].Low <= place[0] && place[0] <= where[0].High && where[1].Low <= place[1] &&
          place[1] <= where[1].High)
        {
          visit(this->Order[n]);
        }
      }
    }
  }

private:
  /// False of a line across all others, which is nowhere.
  bool IsInside(const Place& place) const
  {
    return this->Shadow[0].Low <= place[0] && place[0] <= this->Shadow[0].High &&
      this->Shadow[1].Low <= place[1] && place[1] <= this->Shadow[1].High;
  }
  /// Column (axis 0) or row of a place, of one outside the nearest.
  std::size_t CellAt(std::size_t axis, double place) const
  {
    const double length = this->Shadow[axis].Length();
    const double part = length > 0 ? (place - this->Shadow[axis].Low) / length : 0;
    const auto cells = static_cast<double>(this->Across);
    return static_cast<std::size_t>(std::clamp(part * cells, 0.0, cells - 1));
  }

  std::array<Extent, 2> Shadow;
  const std::vector<Place>& Lines;
  std::size_t Across;
  /// Of each cell in Order.
  std::vector<std::uint32_t> Begins;
  std::vector<std::uint32_t> Order;
};

/// A line and a triangle that it crosses.
using Crossing = std::array<std::uint32_t, 2>;

std::vector<Crossing> FindCrossings(const SurfaceMesh& surface, const Shadows& shadows,
  const std::vector<CrossingLine>& lines)
{
  std::vector<Place> points(surface.NumberOfPoints());
  ParallelRanges(points.size(), Grain,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t point = begin; point < end; ++point)
      {
        points[point] = shadows.Of(PointOf(surface, point));
      }
    });
  std::array<Extent, 2> whole;
  for (const Place& point : points)
  {
    whole[0].Add(point[0]);
    whole[1].Add(point[1]);
  }
  const double slack = 1e-9 * std::max(whole[0].Length(), whole[1].Length());
  std::vector<Place> places;
  places.reserve(lines.size());
  for (const CrossingLine& line : lines)
  {
    places.push_back(shadows.Of(line));
  }
  const LineGrid grid(whole, places);
  std::vector<Crossing> crossings;
  std::mutex guard;
  ParallelRanges(surface.NumberOfTriangles(), Grain,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<Crossing> found;
      LineHit hit;
      for (std::size_t triangle = begin; triangle < end; ++triangle)
      {
        std::array<Extent, 2> where;
        for (std::size_t corner = 0; corner < 3; ++corner)
        {
          const Place& at = points[surface.Triangles[3 * triangle + corner]];
          where[0].Add(at[0]);
          where[1].Add(at[1]);
        }
        for (Extent& extent : where)
        {
          extent = { extent.Low - slack, extent.High + slack };
        }
        grid.ForEachIn(where,
          [&](std::uint32_t line)
          {
            if (lines[line].Cross(surface, static_cast<std::uint32_t>(triangle), hit))
            {
              found.push_back({ line, static_cast<std::uint32_t>(triangle) });
            }
          });
      }
      const std::scoped_lock lock(guard);
      crossings.insert(crossings.end(), found.begin(), found.end());
    });
  return crossings;
}
}

CrossingLine LineThrough(const XRaySource& source, const Vector3& place)
{
  if (source.Type == XRaySource::Kind::Parallel)
  {
    return { place, (1 / Norm(source.Direction)) * source.Direction };
  }
  const Vector3 way = place - source.Position;
  return { place, (1 / Norm(way)) * way };
}

std::optional<std::vector<std::uint32_t>> SampleParts(const SurfaceMesh& surface,
  std::size_t wanted, std::size_t fewest)
{
  DisjointSets points(surface.NumberOfPoints());
  const std::vector<std::uint32_t>& corners = surface.Triangles;
  for (std::size_t n = 0; n < corners.size(); n += 3)
  {
    points.Join(corners[n + 1], corners[n]);
    points.Join(corners[n + 2], corners[n]);
  }
  // By root: triangles of the part.
  std::vector<std::uint32_t> sizes(surface.NumberOfPoints(), 0);
  for (std::size_t n = 0; n < corners.size(); n += 3)
  {
    sizes[points.Root(corners[n])] += 1;
  }
  const auto parts = static_cast<std::size_t>(
    std::count_if(sizes.begin(), sizes.end(), [](std::uint32_t size) { return size > 0; }));
  if (parts * fewest > wanted)
  {
    return {};
  }
  const std::size_t share = wanted / std::max<std::size_t>(1, parts);
  std::vector<std::uint32_t> met(sizes.size(), 0);
  std::vector<std::uint32_t> sample;
  for (std::size_t n = 0; n < corners.size(); n += 3)
  {
    const std::uint32_t part = points.Root(corners[n]);
    const std::size_t step = std::max<std::size_t>(1, sizes[part] / share);
    if (met[part]++ % step == 0)
    {
      sample.push_back(static_cast<std::uint32_t>(n / 3));
    }
  }
  return sample;
}

std::optional<bool> AnyContradiction(const SurfaceMesh& surface, const XRaySource& source,
  const std::vector<CrossingLine>& lines)
{
  const Shadows shadows(surface, source);
  if (!shadows.Exist(surface))
  {
    return {};
  }
  std::vector<Crossing> crossings = FindCrossings(surface, shadows, lines);
  std::vector<std::size_t> begins(lines.size() + 1, 0);
  for (const Crossing& crossing : crossings)
  {
    begins[crossing[0] + 1] += 1;
  }
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  std::vector<std::uint32_t> triangles(crossings.size());
  std::vector<std::size_t> next = begins;
  for (const Crossing& crossing : crossings)
  {
    triangles[next[crossing[0]]++] = crossing[1];
  }
  std::atomic<bool> any{ false };
  ParallelRanges(lines.size(), 256,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<LineHit> hits;
      for (std::size_t line = begin; line < end && !any; ++line)
      {
        hits.assign(begins[line + 1] - begins[line], {});
        for (std::size_t n = 0; n < hits.size(); ++n)
        {
          lines[line].Cross(surface, triangles[begins[line] + n], hits[n]);
        }
        CrossingLine::Sort(hits);
        if (!FindContradictions(surface, lines[line].Begin(), lines[line].Direction(), hits)
               .empty())
        {
          any = true;
        }
      }
    });
  return any;
}
}
