// SPDX-License-Identifier: Apache-2.0
#include "Private/TriangleCrossing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace mammoray
{
namespace
{
/// 2^40.
constexpr double GridSteps = 1099511627776.0;

__extension__ using WideInteger = __int128;
}

/// An edge that passes through an edge of another triangle.
struct SurfaceOnGrid::EdgePass
{
  /// The passing edge, from the back to the front of the triangle.
  std::uint32_t From;
  std::uint32_t To;
  /// Ends of the edge that is passed, ascending.
  std::uint32_t Low;
  std::uint32_t High;
  std::size_t Pair;

  auto Key() const { return std::tie(this->From, this->To, this->Low, this->High); }
};

SurfaceOnGrid::SurfaceOnGrid(const SurfaceMesh& surface)
{
  const auto axes = ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, surface.Points);
  double largest = 0;
  for (const Extent& extent : axes)
  {
    largest = std::max(largest, extent.Length());
  }
  const double scale = largest > 0 ? GridSteps / largest : 0;
  std::vector<Place> all(surface.NumberOfPoints());
  for (std::size_t point = 0; point < all.size(); ++point)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      all[point][axis] = std::llround(scale * (surface.Points[3 * point + axis] - axes[axis].Low));
    }
  }
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
    [&](std::uint32_t a, std::uint32_t b) { return all[a] < all[b]; });
  std::vector<std::uint32_t> placeOfPoint(all.size());
  for (const std::uint32_t point : order)
  {
    if (this->Places.empty() || this->Places.back() != all[point])
    {
      this->Places.push_back(all[point]);
    }
    placeOfPoint[point] = static_cast<std::uint32_t>(this->Places.size() - 1);
  }
  this->PlaceOf.reserve(surface.Triangles.size());
  for (const std::uint32_t point : surface.Triangles)
  {
    this->PlaceOf.push_back(placeOfPoint[point]);
  }
}

std::array<std::uint32_t, 3> SurfaceOnGrid::Corners(std::uint32_t triangle) const
{
  const std::uint32_t* first = &this->PlaceOf[3 * std::size_t{ triangle }];
  return { first[0], first[1], first[2] };
}

/// The sign of (b - a) x (c - a) . (d - a): 1 if d lies in front of the triangle a, b, c.
int SurfaceOnGrid::Side(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const
{
  Place e[3];
  const std::uint32_t ends[3] = { b, c, d };
  for (std::size_t n = 0; n < 3; ++n)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      e[n][axis] = this->Places[ends[n]][axis] - this->Places[a][axis];
    }
  }
  double sum = 0;
  double size = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::size_t next = (axis + 1) % 3;
    const std::size_t last = (axis + 2) % 3;
    const double one = static_cast<double>(e[0][next]) * static_cast<double>(e[1][last]);
    const double other = static_cast<double>(e[0][last]) * static_cast<double>(e[1][next]);
    sum += (one - other) * static_cast<double>(e[2][axis]);
    size += (std::abs(one) + std::abs(other)) * std::abs(static_cast<double>(e[2][axis]));
  }
  // Bound on six roundings of 2^-53 each, with a margin.
  if (std::abs(sum) > 2e-15 * size)
  {
    return sum > 0 ? 1 : -1;
  }
  WideInteger exact = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::size_t next = (axis + 1) % 3;
    const std::size_t last = (axis + 2) % 3;
    exact += (WideInteger{ e[0][next] } * e[1][last] - WideInteger{ e[0][last] } * e[1][next]) *
      e[2][axis];
  }
  return exact > 0 ? 1 : (exact < 0 ? -1 : 0);
}

/// True if an edge passes through a triangle's interior. Passing through an edge of it is recorded
/// in `throughEdges`.
bool SurfaceOnGrid::Passes(std::uint32_t from, std::uint32_t to,
  const std::array<std::uint32_t, 3>& corners, std::size_t pair,
  std::vector<EdgePass>& throughEdges) const
{
  const int begin = this->Side(corners[0], corners[1], corners[2], from);
  if (begin == 0 || this->Side(corners[0], corners[1], corners[2], to) != -begin)
  {
    return false;
  }
  if (begin > 0)
  {
    std::swap(from, to);
  }
  int zeros = 0;
  std::size_t edge = 0;
  int sides = 0;
  for (std::size_t n = 0; n < 3; ++n)
  {
    const int side = this->Side(from, to, corners[n], corners[(n + 1) % 3]);
    sides += side;
    zeros += side == 0 ? 1 : 0;
    edge = side == 0 ? n : edge;
  }
  if (std::abs(sides) + zeros < 3 || zeros > 1)
  {
    return false;
  }
  if (zeros == 1)
  {
    const auto [low, high] = std::minmax(corners[edge], corners[(edge + 1) % 3]);
    throughEdges.push_back({ from, to, low, high, pair });
  }
  return zeros == 0;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> SurfaceOnGrid::Crossings(
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& close) const
{
  std::vector<char> crosses(close.size(), 0);
  std::vector<EdgePass> throughEdges;
  for (std::size_t pair = 0; pair < close.size(); ++pair)
  {
    const std::array<std::array<std::uint32_t, 3>, 2> both{ this->Corners(close[pair].first),
      this->Corners(close[pair].second) };
    int common = 0;
    for (const std::uint32_t corner : both[0])
    {
      common += static_cast<int>(std::count(both[1].begin(), both[1].end(), corner));
    }
    for (std::size_t one = 0; one < 2 && common < 2; ++one)
    {
      const auto& other = both[1 - one];
      for (std::size_t n = 0; n < 3; ++n)
      {
        const std::uint32_t from = both[one][n];
        const std::uint32_t to = both[one][(n + 1) % 3];
        const bool joined = std::count(other.begin(), other.end(), from) +
            std::count(other.begin(), other.end(), to) >
          0;
        if (!joined && this->Passes(from, to, other, pair, throughEdges))
        {
          crosses[pair] = 1;
        }
      }
    }
  }
  // An edge that passes through another edge must pass through both triangles of that edge;
  // otherwise it only touches.
  std::sort(throughEdges.begin(), throughEdges.end(),
    [&](const EdgePass& a, const EdgePass& b)
    { return a.Key() != b.Key() ? a.Key() < b.Key() : a.Pair < b.Pair; });
  const auto triangleThere = [&](const EdgePass& pass)
  {
    const std::array<std::uint32_t, 3> corners = this->Corners(close[pass.Pair].second);
    const bool second = std::count(corners.begin(), corners.end(), pass.Low) > 0 &&
      std::count(corners.begin(), corners.end(), pass.High) > 0;
    return second ? close[pass.Pair].second : close[pass.Pair].first;
  };
  for (std::size_t begin = 0; begin < throughEdges.size();)
  {
    std::size_t end = begin;
    bool several = false;
    while (end < throughEdges.size() && throughEdges[end].Key() == throughEdges[begin].Key())
    {
      several = several || triangleThere(throughEdges[end]) != triangleThere(throughEdges[begin]);
      ++end;
    }
    for (std::size_t n = begin; several && n < end; ++n)
    {
      crosses[throughEdges[n].Pair] = 1;
    }
    begin = end;
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> crossing;
  for (std::size_t pair = 0; pair < close.size(); ++pair)
  {
    if (crosses[pair] != 0)
    {
      crossing.push_back(close[pair]);
    }
  }
  return crossing;
}
}
