// SPDX-License-Identifier: Apache-2.0
#include "Private/Silhouette.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
/// An edge whose cross product with the direction is smaller, mm, lies along the ray.
constexpr double AlongTheRay = 1e-12;

double CrossInPlane(const ReceptorPoint& a, const ReceptorPoint& b)
{
  return a[0] * b[1] - a[1] * b[0];
}
}

std::vector<std::array<std::uint32_t, 2>> OuterEdges(const SurfaceMesh& surface)
{
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    if (surface.FrontMaterials[triangle] != 0 && surface.BackMaterials[triangle] != 0)
    {
      continue;
    }
    for (int side = 0; side < 3; ++side)
    {
      const std::uint32_t a = surface.Triangles[3 * triangle + side];
      const std::uint32_t b = surface.Triangles[3 * triangle + (side + 1) % 3];
      edges.push_back({ std::min(a, b), std::max(a, b) });
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<ReceptorPoint> HalfCircleDirections(int count)
{
  std::vector<ReceptorPoint> directions(std::max(count, 0));
  for (int index = 0; index < count; ++index)
  {
    const double angle = std::numbers::pi * (index + 0.5) / count;
    directions[index] = { std::cos(angle), std::sin(angle) };
  }
  return directions;
}

std::vector<double> SilhouetteRadii(const std::vector<ReceptorPoint>& projected,
  const std::vector<std::array<std::uint32_t, 2>>& edges, const ReceptorPoint& centre,
  const std::vector<ReceptorPoint>& directions, std::vector<std::int32_t>* crossed)
{
  if (crossed)
  {
    crossed->assign(directions.size(), -1);
  }
  // HalfCircleDirections come sorted by angle; any order works through this index.
  std::vector<std::pair<double, std::size_t>> angles(directions.size());
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    angles[index] = { std::atan2(directions[index][1], directions[index][0]), index };
  }
  std::sort(angles.begin(), angles.end());

  std::vector<double> radii(directions.size(), 0.0);
  std::int32_t number = -1;
  const auto visit = [&](double low, double high, const ReceptorPoint& a, const ReceptorPoint& b)
  {
    const ReceptorPoint along{ b[0] - a[0], b[1] - a[1] };
    for (auto at =
           std::lower_bound(angles.begin(), angles.end(), std::make_pair(low, std::size_t(0)));
         at != angles.end() && at->first <= high; ++at)
    {
      // centre + r d = a + s (b - a)  =>  r = (a x along) / (d x along), with a relative to centre.
      const ReceptorPoint& direction = directions[at->second];
      const double denominator = CrossInPlane(direction, along);
      const double radius = std::abs(denominator) > AlongTheRay
        ? CrossInPlane(a, along) / denominator
        : std::max(std::hypot(a[0], a[1]), std::hypot(b[0], b[1]));
      if (radius > radii[at->second])
      {
        radii[at->second] = radius;
        if (crossed)
        {
          (*crossed)[at->second] = number;
        }
      }
    }
  };
  for (const auto& edge : edges)
  {
    ++number;
    const ReceptorPoint a{ projected[edge[0]][0] - centre[0], projected[edge[0]][1] - centre[1] };
    const ReceptorPoint b{ projected[edge[1]][0] - centre[0], projected[edge[1]][1] - centre[1] };
    double low = std::atan2(a[1], a[0]);
    double high = std::atan2(b[1], b[0]);
    if (!(std::isfinite(low) && std::isfinite(high)))
    {
      continue;
    }
    if (low > high)
    {
      std::swap(low, high);
    }
    if (high - low <= std::numbers::pi)
    {
      visit(low, high, a, b);
    }
    else // across the cut of atan2 at -x
    {
      visit(high, std::numbers::pi, a, b);
      visit(-std::numbers::pi, low, a, b);
    }
  }
  return radii;
}

std::vector<double> SilhouetteDerivatives(const std::vector<ReceptorPoint>& projected,
  const std::vector<ReceptorPoint>& velocities,
  const std::vector<std::array<std::uint32_t, 2>>& edges, const ReceptorPoint& centre,
  const std::vector<ReceptorPoint>& directions, const std::vector<std::int32_t>& crossed)
{
  std::vector<double> rates(directions.size(), 0.0);
  for (std::size_t index = 0; index < directions.size(); ++index)
  {
    if (crossed[index] < 0)
    {
      continue;
    }
    const auto [first, second] = edges[crossed[index]];
    const auto relative = [&](std::uint32_t point) {
      return ReceptorPoint{ projected[point][0] - centre[0], projected[point][1] - centre[1] };
    };
    const ReceptorPoint a = relative(first);
    const ReceptorPoint b = relative(second);
    const ReceptorPoint& da = velocities[first];
    const ReceptorPoint& db = velocities[second];
    // radius = (a x b) / (d x (b - a))
    const double denominator = CrossInPlane(directions[index], { b[0] - a[0], b[1] - a[1] });
    if (std::abs(denominator) > AlongTheRay)
    {
      const double radius = CrossInPlane(a, b) / denominator;
      rates[index] = (CrossInPlane(da, b) + CrossInPlane(a, db) -
                       radius * CrossInPlane(directions[index], { db[0] - da[0], db[1] - da[1] })) /
        denominator;
    }
    else
    {
      const bool far = std::hypot(b[0], b[1]) > std::hypot(a[0], a[1]);
      const ReceptorPoint& v = far ? db : da;
      rates[index] = v[0] * directions[index][0] + v[1] * directions[index][1];
    }
  }
  return rates;
}
}
