// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/TriangleTree.h"

#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

namespace mammoray
{
namespace
{
constexpr std::uint32_t TrianglesPerLeaf = 4;

/// Two directions perpendicular to a line.
std::array<Vector3, 2> DirectionsAcross(const Vector3& direction)
{
  std::size_t least = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
  {
    least = std::abs(direction[axis]) < std::abs(direction[least]) ? axis : least;
  }
  Vector3 other{ 0, 0, 0 };
  other[least] = 1;
  const Vector3 u = Cross(direction, other);
  const Vector3 first = (1 / Norm(u)) * u;
  return { first, Cross(direction, first) };
}

using Place = std::array<double, 2>;

/// a x b, which equals -(b x a) exactly despite contraction by the compiler: twice the area between
/// the line and the edge, seen along the line.
double EdgeValue(const Place& a, const Place& b)
{
  return a < b ? a[0] * b[1] - a[1] * b[0] : -(b[0] * a[1] - b[1] * a[0]);
}

/// The edge's value or, if that is 0, its sign after an infinitesimal shift of the line back along
/// the first direction and an infinitesimally smaller one along the second.
double Decisive(double value, const Place& a, const Place& b)
{
  return value != 0 ? value : a[1] != b[1] ? b[1] - a[1] : a[0] - b[0];
}

/// A line prepared for intersection with triangles.
class CrossingLine
{
public:
  CrossingLine(const Vector3& begin, const Vector3& direction)
    : Origin(begin)
    , Direction(direction)
    , Perpendiculars(DirectionsAcross(direction))
  {
  }

  /// Returns true and sets `hit` if the line intersects the triangle.
  bool Cross(const SurfaceMesh& surface, std::uint32_t triangle, LineHit& hit) const
  {
    std::array<Vector3, 3> points;
    std::array<Place, 3> seen;
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      points[corner] = surface.Corner(triangle, corner) - this->Origin;
      seen[corner] = { Dot(points[corner], this->Perpendiculars[0]),
        Dot(points[corner], this->Perpendiculars[1]) };
    }
    // Value i belongs to the corner opposite to the edge; normalised, the values are the
    // barycentric coordinates.
    std::array<double, 3> values{};
    int positive = 0;
    int negative = 0;
    for (std::size_t i = 0; i < 3; ++i)
    {
      const Place& a = seen[(i + 1) % 3];
      const Place& b = seen[(i + 2) % 3];
      values[i] = EdgeValue(a, b);
      const double side = Decisive(values[i], a, b);
      positive += side > 0 ? 1 : 0;
      negative += side < 0 ? 1 : 0;
    }
    if (positive < 3 && negative < 3)
    {
      return false;
    }
    const double whole = values[0] + values[1] + values[2];
    hit.Triangle = triangle;
    hit.Weights = whole != 0
      ? std::array<double, 3>{ values[0] / whole, values[1] / whole, values[2] / whole }
      : std::array<double, 3>{ 1, 0, 0 };
    hit.T = 0;
    for (std::size_t i = 0; i < 3; ++i)
    {
      hit.T += hit.Weights[i] * Dot(points[i], this->Direction);
    }
    // Corners that appear counter-clockwise from the line's end mean that its origin faces the
    // triangle's front.
    hit.FacesBeginning = negative == 3;
    return true;
  }

private:
  Vector3 Origin;
  Vector3 Direction;
  std::array<Vector3, 2> Perpendiculars;
};
}

TriangleTree::TriangleTree(const SurfaceMesh& surface)
  : Surface(&surface)
  , Order(surface.NumberOfTriangles())
{
  std::iota(this->Order.begin(), this->Order.end(), 0u);
  std::vector<Box3> boxes(this->Order.size());
  ParallelFor(boxes.size(),
    [&](std::size_t triangle)
    { boxes[triangle] = this->BoxOf(static_cast<std::uint32_t>(triangle)); });
  this->Nodes.reserve(this->Order.size());
  if (!this->Order.empty())
  {
    this->Build(0, static_cast<std::uint32_t>(this->Order.size()), boxes);
  }
}

Box3 TriangleTree::BoxOf(std::uint32_t triangle) const
{
  Box3 box;
  for (std::size_t corner = 0; corner < 3; ++corner)
  {
    box.Add(this->Surface->Corner(triangle, corner));
  }
  return box;
}

void TriangleTree::Build(std::uint32_t begin, std::uint32_t end, std::vector<Box3>& boxes)
{
  const std::size_t place = this->Nodes.size();
  Node node;
  for (std::uint32_t n = begin; n < end; ++n)
  {
    node.Bounds.Add(boxes[this->Order[n]]);
  }
  node.First = begin;
  node.Count = end - begin <= TrianglesPerLeaf ? end - begin : 0;
  this->Nodes.push_back(node);
  if (node.Count > 0)
  {
    return;
  }
  const Vector3 size = node.Bounds.High - node.Bounds.Low;
  const auto axis =
    static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(this->Order.begin() + begin, this->Order.begin() + middle,
    this->Order.begin() + end,
    [&](std::uint32_t a, std::uint32_t b)
    {
      const double left = boxes[a].Low[axis] + boxes[a].High[axis];
      const double right = boxes[b].Low[axis] + boxes[b].High[axis];
      return left != right ? left < right : a < b;
    });
  this->Build(begin, middle, boxes);
  this->Nodes[place].First = static_cast<std::uint32_t>(this->Nodes.size());
  this->Build(middle, end, boxes);
}

bool TriangleTree::Touch(const Box3& a, const Box3& b)
{
  bool touch = true;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    touch = touch && a.Low[axis] <= b.High[axis] && b.Low[axis] <= a.High[axis];
  }
  return touch;
}

template <typename Meets, typename Visit>
void TriangleTree::Descend(const Meets& meets, const Visit& visit) const
{
  if (this->Nodes.empty())
  {
    return;
  }
  // The tree is balanced, so 64 levels suffice for 2^32 triangles.
  std::array<std::uint32_t, 64> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0)
  {
    const std::uint32_t place = waiting[--count];
    const Node& node = this->Nodes[place];
    if (!meets(node.Bounds))
    {
      continue;
    }
    if (node.Count == 0)
    {
      waiting[count++] = node.First;
      waiting[count++] = place + 1;
      continue;
    }
    for (std::uint32_t n = 0; n < node.Count; ++n)
    {
      visit(this->Order[node.First + n]);
    }
  }
}

void TriangleTree::CrossLine(const Vector3& begin, const Vector3& direction,
  std::vector<LineHit>& hits) const
{
  hits.clear();
  const auto meets = [&](const Box3& box)
  {
    // Separating axes: the projections of box and line must overlap along each of the three
    // directions perpendicular to the line and an axis, with a margin for rounding.
    const Vector3 half = 0.5 * (box.High - box.Low);
    const Vector3 middle = 0.5 * (box.Low + box.High) - begin;
    const double slack = 1e-12 * (Norm(half) + Norm(middle));
    bool meet = true;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const std::size_t next = (axis + 1) % 3;
      const std::size_t last = (axis + 2) % 3;
      meet = meet &&
        std::abs(middle[next] * direction[last] - middle[last] * direction[next]) <=
          half[next] * std::abs(direction[last]) + half[last] * std::abs(direction[next]) + slack;
    }
    return meet;
  };
  const CrossingLine line(begin, direction);
  LineHit hit;
  this->Descend(meets,
    [&](std::uint32_t triangle)
    {
      if (line.Cross(*this->Surface, triangle, hit))
      {
        hits.push_back(hit);
      }
    });
  std::sort(hits.begin(), hits.end(),
    [](const LineHit& a, const LineHit& b)
    { return a.T != b.T ? a.T < b.T : a.Triangle < b.Triangle; });
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> TriangleTree::ClosePairs() const
{
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  std::mutex guard;
  ParallelRanges(this->Order.size(), 4096,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
      for (std::size_t n = begin; n < end; ++n)
      {
        const std::uint32_t one = this->Order[n];
        const Box3 box = this->BoxOf(one);
        this->Descend([&](const Box3& other) { return Touch(box, other); },
          [&](std::uint32_t other)
          {
            if (one < other && Touch(box, this->BoxOf(other)))
            {
              found.emplace_back(one, other);
            }
          });
      }
      const std::scoped_lock lock(guard);
      pairs.insert(pairs.end(), found.begin(), found.end());
    });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}
}
