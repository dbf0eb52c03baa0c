// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/SurfaceOverlap.h"

#include "Private/TriangleCrossing.h"
#include "mammoray/Foundation/FaceTable.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <utility>

namespace mammoray
{
namespace
{
/// Test lines per part.
constexpr std::size_t LinesPerPart = 16;
/// Number of parts between two reports of progress.
constexpr std::size_t PartsAtOnce = 4096;
/// Largest number of boxes; more are merged into one.
constexpr std::size_t MostRegions = 64;

Vector3 CentreOf(const SurfaceMesh& surface, std::size_t triangle)
{
  const Vector3 sum =
    surface.Corner(triangle, 0) + surface.Corner(triangle, 1) + surface.Corner(triangle, 2);
  return (1.0 / 3) * sum;
}

/// Counts how often a line is inside each material; air starts at 1, the others at 0.
class Insides
{
public:
  void Cross(int left, int entered)
  {
    this->Change(left, -1);
    this->Change(entered, 1);
  }
  /// True inside air once and nothing else.
  bool IsOutside() const
  {
    return std::all_of(this->Times.begin(), this->Times.end(),
      [](const auto& entry) { return entry.second == (entry.first == 0 ? 1 : 0); });
  }
  /// True inside one material once and nothing else.
  bool IsLabelled() const { return this->InvalidCounts == 0; }
  SurfaceContradiction Describe() const
  {
    SurfaceContradiction found;
    for (const auto& [material, times] : this->Times)
    {
      if (material != 0)
      {
        found.Negative = found.Negative || times < 0;
        found.Materials.insert(found.Materials.end(), std::max(0, times), material);
      }
    }
    return found;
  }

private:
  /// Counts of 0 and 1 are valid. Their sum is always 1, so exactly one material is then 1.
  static int IsInvalid(int times) { return times < 0 || times > 1 ? 1 : 0; }
  void Change(int material, int by)
  {
    int& times = this->Times[material];
    this->InvalidCounts -= IsInvalid(times);
    times += by;
    this->InvalidCounts += IsInvalid(times);
  }

  std::map<int, int> Times{ { 0, 1 } };
  int InvalidCounts = 0;
};

/// Sorts materials at a segment behind hit `n` by how long the line is in each, so that what lies
/// in another comes first.
void SortByLength(const SurfaceMesh& surface, const std::vector<LineHit>& hits, std::size_t n,
  std::vector<int>& materials)
{
  std::map<int, double> lengths;
  for (const int material : materials)
  {
    std::size_t entry = n;
    while (entry > 0 && MaterialsAt(surface, hits[entry]).second != material)
    {
      --entry;
    }
    std::size_t exit = n + 1;
    while (exit + 1 < hits.size() && MaterialsAt(surface, hits[exit]).first != material)
    {
      ++exit;
    }
    lengths[material] = hits[exit].T - hits[entry].T;
  }
  std::stable_sort(materials.begin(), materials.end(),
    [&lengths](int one, int other) { return lengths[one] < lengths[other]; });
}

/// Hits at the two ends of a segment: those from Begin up to Middle at its begin, those up to End
/// at its end. Several lie at one place where parts have a common face.
struct SegmentHits
{
  std::size_t Begin;
  std::size_t Middle;
  std::size_t End;
};

/// Calls visit(ends, contradiction) for the segments between successive hits whose labels are
/// contradictory. Segments of no length are skipped. A line that does not end in air passed a hole
/// and is ignored.
template <typename Visit>
void ForEachContradiction(const SurfaceMesh& surface, const Vector3& begin,
  const Vector3& direction, const std::vector<LineHit>& hits, const Visit& visit)
{
  const auto cross = [&](const LineHit& hit, Insides& insides)
  {
    const auto [left, entered] = MaterialsAt(surface, hit);
    insides.Cross(left, entered);
  };
  Insides whole;
  for (const LineHit& hit : hits)
  {
    cross(hit, whole);
  }
  if (!whole.IsOutside())
  {
    return;
  }
  Insides insides;
  // Coinciding surfaces have nothing between them, in whatever order their hits come.
  const double gap =
    hits.empty() ? 0 : 1e-9 * (1 + std::max(std::abs(hits.front().T), std::abs(hits.back().T)));
  for (std::size_t n = 0; n < hits.size(); ++n)
  {
    cross(hits[n], insides);
    if (!insides.IsLabelled() && n + 1 < hits.size() && hits[n + 1].T - hits[n].T > gap)
    {
      SurfaceContradiction stretch = insides.Describe();
      SortByLength(surface, hits, n, stretch.Materials);
      stretch.LengthMm = hits[n + 1].T - hits[n].T;
      stretch.Place = begin + 0.5 * (hits[n + 1].T + hits[n].T) * direction;
      SegmentHits ends{ n, n + 1, n + 2 };
      while (ends.Begin > 0 && hits[n].T - hits[ends.Begin - 1].T <= gap)
      {
        --ends.Begin;
      }
      while (ends.End < hits.size() && hits[ends.End].T - hits[n + 1].T <= gap)
      {
        ++ends.End;
      }
      visit(ends, stretch);
    }
  }
}

/// Connected components of triangles by common corners, and the results for each.
struct SurfaceParts
{
  explicit SurfaceParts(const SurfaceOnGrid& grid)
    : PartOf(grid.NumberOfTriangles())
  {
    DisjointSets places(grid.NumberOfPlaces());
    for (std::uint32_t triangle = 0; triangle < this->PartOf.size(); ++triangle)
    {
      const auto corners = grid.Corners(triangle);
      places.Join(corners[1], corners[0]);
      places.Join(corners[2], corners[0]);
    }
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (std::uint32_t triangle = 0; triangle < this->PartOf.size(); ++triangle)
    {
      const auto next = static_cast<std::uint32_t>(this->Triangles.size());
      const auto [entry, isNew] = numbers.try_emplace(places.Root(grid.Corners(triangle)[0]), next);
      if (isNew)
      {
        this->Triangles.emplace_back();
      }
      this->PartOf[triangle] = entry->second;
      this->Triangles[entry->second].push_back(triangle);
    }
  }

  Box3 BoxOf(const SurfaceMesh& surface, std::uint32_t part) const
  {
    Box3 box;
    for (const std::uint32_t triangle : this->Triangles[part])
    {
      for (std::size_t corner = 0; corner < 3; ++corner)
      {
        box.Add(surface.Corner(triangle, corner));
      }
    }
    return box;
  }

  std::vector<std::uint32_t> PartOf;
  std::vector<std::vector<std::uint32_t>> Triangles;
};

/// The longest contradiction of each part whose surface bounds one.
using PartContradictions = std::map<std::uint32_t, SurfaceContradiction>;

void KeepLonger(SurfaceContradiction& known, const SurfaceContradiction& other)
{
  if (other.LengthMm > known.LengthMm)
  {
    known = other;
  }
}

/// Parts that a segment belongs to: the one that bounds it on both ends, otherwise the two that do.
std::set<std::uint32_t> PartsAt(const SurfaceParts& parts, const std::vector<LineHit>& hits,
  const SegmentHits& ends)
{
  std::set<std::uint32_t> atBegin;
  for (std::size_t n = ends.Begin; n < ends.Middle; ++n)
  {
    atBegin.insert(parts.PartOf[hits[n].Triangle]);
  }
  for (std::size_t n = ends.Middle; n < ends.End; ++n)
  {
    const std::uint32_t part = parts.PartOf[hits[n].Triangle];
    if (atBegin.count(part) > 0)
    {
      return { part };
    }
  }
  return { parts.PartOf[hits[ends.Middle - 1].Triangle], parts.PartOf[hits[ends.Middle].Triangle] };
}

/// Follows lines through the triangles of one part. `hits` is working memory.
void ProbePart(const SurfaceMesh& surface, const TriangleTree& tree, const SurfaceParts& parts,
  std::size_t part, std::vector<LineHit>& hits, PartContradictions& found)
{
  // A direction along no axis and no diagonal, so that few lines graze faces.
  const Vector3 skew{ 0.5257311, 0.2763932, 0.8045085 };
  const Vector3 direction = (1 / Norm(skew)) * skew;
  const std::vector<std::uint32_t>& triangles = parts.Triangles[part];
  const std::size_t lines = std::min(LinesPerPart, triangles.size());
  for (std::size_t line = 0; line < lines; ++line)
  {
    const Vector3 begin = CentreOf(surface, triangles[line * triangles.size() / lines]);
    tree.CrossLine(begin, direction, hits);
    ForEachContradiction(surface, begin, direction, hits,
      [&](const SegmentHits& ends, const SurfaceContradiction& stretch)
      {
        for (const std::uint32_t at : PartsAt(parts, hits, ends))
        {
          KeepLonger(found[at], stretch);
        }
      });
  }
}

PartContradictions ProbeParts(const SurfaceMesh& surface, const TriangleTree& tree,
  const SurfaceParts& parts, const ProgressCallback& progress)
{
  PartContradictions found;
  const std::size_t count = parts.Triangles.size();
  for (std::size_t from = 0; from < count; from += PartsAtOnce)
  {
    ReportProgress(progress, 0.5 * static_cast<double>(from) / static_cast<double>(count),
      "looking for overlaps");
    // Merged in the order of the parts, so that the first of equal lengths is kept.
    std::map<std::size_t, PartContradictions> ranges;
    std::mutex guard;
    ParallelRanges(std::min(PartsAtOnce, count - from), 64,
      [&](std::size_t begin, std::size_t end)
      {
        PartContradictions own;
        std::vector<LineHit> hits;
        for (std::size_t part = from + begin; part < from + end; ++part)
        {
          ProbePart(surface, tree, parts, part, hits, own);
        }
        const std::scoped_lock lock(guard);
        ranges[begin] = std::move(own);
      });
    for (const auto& [begin, own] : ranges)
    {
      for (const auto& [part, stretch] : own)
      {
        KeepLonger(found[part], stretch);
      }
    }
  }
  return found;
}

/// The common boxes of parts that cross each other, and the boxes of parts with contradictions.
std::vector<Box3> FindRegions(const SurfaceMesh& surface, const SurfaceParts& parts,
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& crossings,
  const PartContradictions& contradictions)
{
  std::set<std::pair<std::uint32_t, std::uint32_t>> together;
  for (const auto& [one, other] : crossings)
  {
    together.insert(std::minmax(parts.PartOf[one], parts.PartOf[other]));
  }
  for (const auto& [part, stretch] : contradictions)
  {
    together.insert({ part, part });
  }
  std::vector<Box3> regions;
  for (const auto& [one, other] : together)
  {
    Box3 box = parts.BoxOf(surface, one);
    const Box3 shared = parts.BoxOf(surface, other);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      box.Low[axis] = std::max(box.Low[axis], shared.Low[axis]);
      box.High[axis] = std::min(box.High[axis], shared.High[axis]);
    }
    regions.push_back(box);
  }
  if (regions.size() <= MostRegions)
  {
    return regions;
  }
  Box3 all;
  for (const Box3& box : regions)
  {
    all.Add(box);
  }
  return { all };
}
}

std::vector<SurfaceContradiction> FindContradictions(const SurfaceMesh& surface,
  const Vector3& begin, const Vector3& direction, const std::vector<LineHit>& hits)
{
  std::vector<SurfaceContradiction> found;
  ForEachContradiction(surface, begin, direction, hits,
    [&](const SegmentHits&, const SurfaceContradiction& stretch) { found.push_back(stretch); });
  return found;
}

SurfaceOverlap FindOverlap(const SurfaceMesh& surface, const TriangleTree& tree,
  const ProgressCallback& progress, bool alwaysCrossings)
{
  SurfaceOverlap overlap;
  const SurfaceOnGrid grid(surface);
  const SurfaceParts parts(grid);
  const PartContradictions contradictions = ProbeParts(surface, tree, parts, progress);
  for (const auto& [part, stretch] : contradictions)
  {
    (stretch.Negative ? overlap.NegativeParts : overlap.DoubledParts) += 1;
    if (overlap.Contradictions.size() < SurfaceOverlap::MostPlaces)
    {
      overlap.Contradictions.push_back(stretch);
    }
  }
  if (!alwaysCrossings && contradictions.empty())
  {
    return overlap;
  }
  ReportProgress(progress, 0.5, "looking for crossing triangles");
  const auto crossings = grid.Crossings(tree.ClosePairs());
  overlap.Crossings = crossings.size();
  for (std::size_t n = 0; n < std::min(crossings.size(), SurfaceOverlap::MostPlaces); ++n)
  {
    overlap.CrossingPlaces.push_back(
      0.5 * (CentreOf(surface, crossings[n].first) + CentreOf(surface, crossings[n].second)));
    overlap.CrossingMaterials.push_back(surface.BackMaterials[crossings[n].first]);
  }
  overlap.Regions = FindRegions(surface, parts, crossings, contradictions);
  return overlap;
}
}
