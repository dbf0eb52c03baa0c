// SPDX-License-Identifier: Apache-2.0
#include "Private/EditableMesh.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace mammoray
{
namespace
{
using Ids = std::array<std::int32_t, 4>;
using Cell = EditableMesh::Cell;

/// Points around an edge in order, with the material between each point and the next.
struct EdgeRing
{
  std::vector<std::int32_t> Points;
  std::vector<std::int32_t> Materials;
  std::vector<std::int32_t> Cells;
};

/// The ring around the edge from a to b, counter-clockwise about that axis; no value if it is open
/// or has more than `most` cells.
std::optional<EdgeRing> FindRing(const EditableMesh& mesh, std::int32_t a, std::int32_t b,
  std::size_t most)
{
  EdgeRing ring;
  ring.Cells = mesh.Ring(a, b);
  if (ring.Cells.empty() || ring.Cells.size() > most)
  {
    return std::nullopt;
  }
  struct Step
  {
    std::int32_t From;
    std::int32_t To;
    std::int32_t Material;
  };
  std::vector<Step> steps;
  for (const std::int32_t cell : ring.Cells)
  {
    Ids turned = mesh[cell].Ids; // to be (a, b, from, to), by an even number of swaps
    int swaps = 0;
    for (const std::size_t place : { 0, 1 })
    {
      const auto at = std::find(turned.begin(), turned.end(), place == 0 ? a : b);
      if (at != turned.begin() + place)
      {
        std::swap(*at, turned[place]);
        ++swaps;
      }
    }
    if (swaps == 1)
    {
      std::swap(turned[2], turned[3]);
    }
    steps.push_back({ turned[2], turned[3], mesh[cell].Material });
  }
  std::int32_t at = steps[0].From;
  for (std::size_t n = 0; n < steps.size(); ++n)
  {
    const auto next =
      std::find_if(steps.begin(), steps.end(), [&](const Step& s) { return s.From == at; });
    if (next == steps.end())
    {
      return std::nullopt;
    }
    ring.Points.push_back(at);
    ring.Materials.push_back(next->Material);
    at = next->To;
  }
  return at == steps[0].From ? std::optional(ring) : std::nullopt;
}

/// The best filling of the space between two points and a polygon around them: Klincsek's
/// triangulation of the polygon, judged by the worst cell.
class PolygonFill
{
public:
  /// `polygon` runs counter-clockwise about the axis from `below` to `above`; it must outlive this
  /// object.
  PolygonFill(const EditableMesh& mesh, const std::vector<std::int32_t>& polygon,
    std::int32_t material, std::int32_t below, std::int32_t above)
    : Mesh(mesh)
    , Polygon(polygon)
    , Material(material)
    , Below(below)
    , Above(above)
    , Count(polygon.size())
    , Qualities(Count * Count, 1.0)
    , Middle(Count * Count, 0)
  {
    for (std::size_t length = 2; length < this->Count; ++length)
    {
      for (std::size_t i = 0; i + length < this->Count; ++i)
      {
        this->FindMiddle(i, i + length);
      }
    }
  }

  /// Quality of the worst cell of the best filling.
  double Best() const { return this->Qualities[this->Count - 1]; }
  /// Adds the cells of the best filling.
  void Collect(std::vector<Ids>& cells) const { this->Collect(0, this->Count - 1, cells); }

private:
  void FindMiddle(std::size_t i, std::size_t j)
  {
    double& best = this->Qualities[i * this->Count + j];
    best = -1;
    for (std::size_t k = i + 1; k < j; ++k)
    {
      const double sides =
        std::min(this->Qualities[i * this->Count + k], this->Qualities[k * this->Count + j]);
      if (sides <= best)
      {
        continue;
      }
      const double own = std::min(this->Mesh.Quality(this->Upper(i, k, j), this->Material),
        this->Mesh.Quality(this->Lower(i, k, j), this->Material));
      if (std::min(own, sides) > best)
      {
        best = std::min(own, sides);
        this->Middle[i * this->Count + j] = k;
      }
    }
  }
  Ids Upper(std::size_t i, std::size_t k, std::size_t j) const
  {
    return { this->Polygon[i], this->Polygon[k], this->Polygon[j], this->Above };
  }
  Ids Lower(std::size_t i, std::size_t k, std::size_t j) const
  {
    return { this->Polygon[i], this->Polygon[j], this->Polygon[k], this->Below };
  }
  void Collect(std::size_t i, std::size_t j, std::vector<Ids>& cells) const
  {
    if (j - i >= 2)
    {
      const std::size_t k = this->Middle[i * this->Count + j];
      cells.push_back(this->Upper(i, k, j));
      cells.push_back(this->Lower(i, k, j));
      this->Collect(i, k, cells);
      this->Collect(k, j, cells);
    }
  }

  const EditableMesh& Mesh;
  const std::vector<std::int32_t>& Polygon;
  std::int32_t Material;
  std::int32_t Below;
  std::int32_t Above;
  std::size_t Count;
  /// Quality of the worst cell of the best filling between corners i and j, at i * Count + j, and
  /// the corner k that it uses.
  std::vector<double> Qualities;
  std::vector<std::size_t> Middle;
};

/// Improves one mesh step by step.
class CellImprover
{
public:
  CellImprover(EditableMesh& mesh, double goal, double shiftMm)
    : Mesh(mesh)
    , Goal(goal)
    , ShiftMm(shiftMm)
    , Anchors(mesh.Points)
    , LastChange(mesh.Points.size(), 1)
  {
  }

  /// Tries to improve every cell below the goal; returns the number of improved cells.
  std::size_t Pass(const ProgressCallback& progress)
  {
    std::vector<std::pair<double, std::int32_t>> bad;
    this->LastExamined.resize(this->Mesh.NumberOfCells(), 0);
    for (std::size_t n = 0; n < this->Mesh.NumberOfCells(); ++n)
    {
      const auto cell = static_cast<std::int32_t>(n);
      if (this->IsTissue(cell) && this->HasChanged(cell))
      {
        this->LastExamined[n] = this->Changes;
        const double quality = this->Mesh.Quality(this->Mesh[cell].Ids);
        if (quality < this->Goal)
        {
          bad.emplace_back(quality, cell);
        }
      }
    }
    std::sort(bad.begin(), bad.end());
    std::size_t better = 0;
    for (std::size_t n = 0; n < bad.size(); ++n)
    {
      if (n % 256 == 0)
      {
        ReportProgress(progress, static_cast<double>(n) / bad.size(), "improving cells");
      }
      const std::int32_t cell = bad[n].second;
      if (this->IsBad(cell))
      {
        this->LastExamined[static_cast<std::size_t>(cell)] = this->Changes;
        better += this->Mend(cell);
      }
    }
    return better;
  }

private:
  /// Smallest improvement of the worst quality by a step, so that passes end.
  static constexpr double LeastGain = 1e-4;

  /// True if a cell around the corners has changed since this cell was last examined.
  bool HasChanged(std::int32_t cell) const
  {
    const Ids& ids = this->Mesh[cell].Ids;
    return std::any_of(ids.begin(), ids.end(),
      [&](std::int32_t id)
      {
        return this->LastChange[static_cast<std::size_t>(id)] >
          this->LastExamined[static_cast<std::size_t>(cell)];
      });
  }
  template <typename Points>
  void NoteChange(const Points& points)
  {
    ++this->Changes;
    for (const std::int32_t id : points)
    {
      this->LastChange[static_cast<std::size_t>(id)] = this->Changes;
    }
  }

  bool IsTissue(std::int32_t cell) const
  {
    return this->Mesh.IsAlive(cell) && this->Mesh[cell].Material != 0;
  }
  bool IsBad(std::int32_t cell) const
  {
    return this->IsTissue(cell) && this->Mesh.Quality(this->Mesh[cell].Ids) < this->Goal;
  }

  bool Mend(std::int32_t cell)
  {
    const Ids ids = this->Mesh[cell].Ids;
    bool better = false;
    for (std::size_t i = 0; i < 4; ++i)
    {
      for (std::size_t j = i + 1; j < 4; ++j)
      {
        if (this->RemoveEdge(ids[i], ids[j]))
        {
          return true;
        }
      }
    }
    for (const std::int32_t id : ids)
    {
      if (this->SwapFace(cell, id))
      {
        return true;
      }
    }
    for (const std::int32_t id : ids)
    {
      better = this->Move(id) || better;
      if (!this->IsBad(cell))
      {
        return true;
      }
    }
    for (const std::int32_t from : ids)
    {
      for (const std::int32_t to : ids)
      {
        if (from != to && this->Collapse(from, to))
        {
          return true;
        }
      }
    }
    return better;
  }

  /// Replaces cells; material[n] is that of the n-th new cell.
  void Replace(const std::vector<std::int32_t>& old, const std::vector<Ids>& cells,
    const std::vector<std::int32_t>& materials)
  {
    this->Exchange(old, cells, materials);
    this->NoteReplaced(old);
  }
  /// Records the change; the new cells use only corners of the old ones.
  void NoteReplaced(const std::vector<std::int32_t>& old)
  {
    for (const std::int32_t cell : old)
    {
      this->NoteChange(this->Mesh[cell].Ids);
    }
  }
  void Exchange(const std::vector<std::int32_t>& old, const std::vector<Ids>& cells,
    const std::vector<std::int32_t>& materials)
  {
    for (const std::int32_t cell : old)
    {
      this->Mesh.Remove(cell);
    }
    for (std::size_t n = 0; n < cells.size(); ++n)
    {
      this->Mesh.Add(cells[n], materials[n]);
    }
  }

  int ExcessOf(const std::vector<std::int32_t>& points) const
  {
    int excess = 0;
    for (const std::int32_t point : points)
    {
      excess += PinchExcess(this->Mesh, point);
    }
    return excess;
  }

  /// Removes an edge by another filling of its ring. If two materials surround it, the edge belongs
  /// to their interface, whose two triangles are replaced by the other two of their quadrilateral.
  bool RemoveEdge(std::int32_t a, std::int32_t b)
  {
    constexpr std::size_t most = 8;
    const std::optional<EdgeRing> ring = FindRing(this->Mesh, a, b, most);
    if (!ring)
    {
      return false;
    }
    // Chains of cells with one material; at most two.
    const std::size_t count = ring->Cells.size();
    std::vector<std::size_t> changes;
    for (std::size_t n = 0; n < count; ++n)
    {
      if (ring->Materials[n] != ring->Materials[(n + count - 1) % count])
      {
        changes.push_back(n);
      }
    }
    std::vector<Ids> cells;
    std::vector<std::int32_t> materials;
    const double before = this->Mesh.WorstOf(ring->Cells);
    double after = 1;
    const auto fill = [&](std::size_t begin, std::size_t length, bool whole)
    {
      std::vector<std::int32_t> polygon;
      for (std::size_t n = 0; n < length + (whole ? 0 : 1); ++n)
      {
        polygon.push_back(ring->Points[(begin + n) % ring->Points.size()]);
      }
      const PolygonFill filling(this->Mesh, polygon, ring->Materials[begin], a, b);
      after = std::min(after, filling.Best());
      if (after > before)
      {
        filling.Collect(cells);
      }
      materials.resize(cells.size(), ring->Materials[begin]);
    };
    if (changes.empty())
    {
      fill(0, count, true);
      if (after <= before + LeastGain)
      {
        return false;
      }
      this->Replace(ring->Cells, cells, materials);
      return true;
    }
    if (changes.size() != 2)
    {
      return false;
    }
    fill(changes[0], changes[1] - changes[0], false);
    fill(changes[1], count - (changes[1] - changes[0]), false);
    const std::int32_t c = ring->Points[changes[0]];
    const std::int32_t d = ring->Points[changes[1]];
    return after > before + LeastGain && this->IsFlat(a, b, c, d) &&
      this->ReplaceInterface(ring->Cells, cells, materials, { a, b, c, d });
  }

  /// True if swapping the triangles abc, abd for acd, bcd moves the interface within the limit.
  bool IsFlat(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) const
  {
    const Vector3 one = this->Mesh.Point(b) - this->Mesh.Point(a);
    const Vector3 other = this->Mesh.Point(d) - this->Mesh.Point(c);
    const Vector3 normal = Cross(one, other);
    const double gap = Dot(normal, this->Mesh.Point(c) - this->Mesh.Point(a));
    return std::abs(gap) <= this->ShiftMm * Norm(normal);
  }

  /// Replaces cells unless that pinches a boundary or changes which materials meet at `touched`.
  bool ReplaceInterface(const std::vector<std::int32_t>& old, const std::vector<Ids>& cells,
    const std::vector<std::int32_t>& materials, const std::vector<std::int32_t>& touched)
  {
    const int before = this->ExcessOf(touched);
    const auto contactsAt = [&]
    {
      std::vector<Contacts> at;
      at.reserve(touched.size());
      for (const std::int32_t point : touched)
      {
        at.push_back(FindContacts(this->Mesh, point));
      }
      return at;
    };
    const auto kept = contactsAt();
    const auto firstNew = static_cast<std::int32_t>(this->Mesh.NumberOfCells());
    this->Exchange(old, cells, materials);
    if (this->ExcessOf(touched) <= before && contactsAt() == kept)
    {
      this->NoteReplaced(old);
      return true;
    }
    for (std::size_t n = 0; n < cells.size(); ++n)
    {
      this->Mesh.Remove(firstNew + static_cast<std::int32_t>(n));
    }
    for (const std::int32_t cell : old)
    {
      this->Mesh.Restore(cell);
    }
    return false;
  }

  /// Swaps the face opposite to `apex` for an edge if both sides have one material.
  bool SwapFace(std::int32_t cell, std::int32_t apex)
  {
    const Ids ids = this->Mesh[cell].Ids;
    std::array<std::int32_t, 3> face{};
    std::copy_if(ids.begin(), ids.end(), face.begin(),
      [apex](std::int32_t id) { return id != apex; });
    for (const std::int32_t other : this->Mesh.Star(face[0]))
    {
      const Cell neighbour = this->Mesh[other];
      if (other == cell || neighbour.Material != this->Mesh[cell].Material ||
        !Contains(neighbour.Ids, face[1]) || !Contains(neighbour.Ids, face[2]))
      {
        continue;
      }
      const std::int32_t opposite = *std::find_if(neighbour.Ids.begin(), neighbour.Ids.end(),
        [&](std::int32_t id) { return std::find(face.begin(), face.end(), id) == face.end(); });
      const double before = this->Mesh.WorstOf({ cell, other });
      std::vector<Ids> cells;
      for (const std::int32_t gone : face)
      {
        cells.push_back(Replaced(ids, gone, opposite));
        if (this->Mesh.Quality(cells.back(), neighbour.Material) <= before + LeastGain)
        {
          return false;
        }
      }
      this->Replace({ cell, other }, cells, std::vector<std::int32_t>(3, neighbour.Material));
      return true;
    }
    return false;
  }

  /// Moves a point to the position with the best worst cell; on an interface only along it.
  bool Move(std::int32_t point)
  {
    const std::vector<EditableMesh::Arc> arcs = this->Mesh.Arcs(point);
    if (!arcs.empty() && !this->Mesh.IsSurrounded(point))
    {
      return false; // nothing would keep the surface from cutting itself
    }
    const Vector3 normal = this->InterfaceNormal(point, arcs);
    const std::vector<std::int32_t>& star = this->Mesh.Star(point);
    const double start = this->Mesh.WorstOf(star);
    double best = start;
    double step = 0;
    Vector3 middle{ 0, 0, 0 };
    const std::vector<std::int32_t> neighbours = this->Mesh.Neighbours(point);
    for (const std::int32_t id : neighbours)
    {
      const Vector3 away = this->Mesh.Point(id) - this->Mesh.Point(point);
      const double length = Norm(away);
      step = step == 0 ? length : std::min(step, length);
      middle = middle + (1.0 / static_cast<double>(neighbours.size())) * away;
    }
    step *= 0.3;
    std::vector<Vector3> directions;
    if (Norm(middle) > 0)
    {
      directions.push_back((1 / Norm(middle)) * middle);
    }
    for (const double x : { -0.577, 0.577 })
    {
      for (const double y : { -0.577, 0.577 })
      {
        directions.insert(directions.end(), { { x, y, -0.577 }, { x, y, 0.577 } });
      }
    }
    directions.insert(directions.end(),
      { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { 0, 0, -1 } });
    const int halvings = 4;
    for (int halving = 0; halving < halvings && best < this->Goal; ++halving, step *= 0.5)
    {
      for (const Vector3& direction : directions)
      {
        const Vector3 along = direction - Dot(direction, normal) * normal;
        best = std::max(best, this->TryPlace(point, step * along, !arcs.empty(), best));
      }
    }
    if (best > start)
    {
      this->NoteChange(neighbours);
    }
    return best > start + LeastGain;
  }

  /// Unit normal of the interface at a point where two materials meet; otherwise zero.
  Vector3 InterfaceNormal(std::int32_t point, const std::vector<EditableMesh::Arc>& arcs) const
  {
    Vector3 sum{ 0, 0, 0 };
    for (const EditableMesh::Arc& arc : arcs)
    {
      if (arc.Materials != arcs[0].Materials)
      {
        return { 0, 0, 0 };
      }
      Vector3 normal = Cross(this->Mesh.Point(arc.A) - this->Mesh.Point(point),
        this->Mesh.Point(arc.B) - this->Mesh.Point(point));
      // Arcs have arbitrary orientation; the interface turns by less than 90 degrees between
      // neighbouring arcs.
      sum = sum + (Dot(normal, sum) < 0 ? -1.0 : 1.0) * normal;
    }
    const double length = Norm(sum);
    return length > 0 ? (1 / length) * sum : sum;
  }

  /// Moves the point if the worst quality around it then exceeds `best`, and returns that quality;
  /// otherwise returns -1.
  double TryPlace(std::int32_t point, const Vector3& shift, bool onInterface, double best)
  {
    Vector3& place = this->Mesh.Points[static_cast<std::size_t>(point)];
    const Vector3 old = place;
    place = place + shift;
    if (onInterface && Norm(place - this->AnchorOf(point)) > this->ShiftMm)
    {
      place = old;
      return -1;
    }
    double worst = 1;
    for (const std::int32_t cell : this->Mesh.Star(point))
    {
      worst = std::min(worst, this->Mesh.Quality(this->Mesh[cell].Ids, this->Mesh[cell].Material));
      if (worst <= best)
      {
        place = old;
        return -1;
      }
    }
    return worst;
  }

  const Vector3& AnchorOf(std::int32_t point) const
  {
    return this->Anchors[static_cast<std::size_t>(point)];
  }

  /// Collapses `from` into `to`. The new cells fill the same space, so it suffices that they are
  /// upright. On an interface the same pairs of materials must meet at both points, and volumes may
  /// change by as much as a shift of the interface would change them.
  bool Collapse(std::int32_t from, std::int32_t to)
  {
    const std::vector<EditableMesh::Arc> arcs = this->Mesh.Arcs(from);
    if (!arcs.empty() && !this->MayCollapse(from, to, arcs))
    {
      return false;
    }
    const std::vector<std::int32_t> old = this->Mesh.Star(from);
    const double before = this->Mesh.WorstOf(old);
    std::vector<Ids> cells;
    std::vector<std::int32_t> materials;
    std::map<std::int32_t, double> volumes;
    for (const std::int32_t cell : old)
    {
      const Cell& around = this->Mesh[cell];
      volumes[around.Material] -= this->Mesh.Volume(around.Ids);
      if (!Contains(around.Ids, to))
      {
        cells.push_back(Replaced(around.Ids, from, to));
        materials.push_back(around.Material);
        volumes[around.Material] += this->Mesh.Volume(cells.back());
        if (this->Mesh.Quality(cells.back(), around.Material) <= before + LeastGain)
        {
          return false;
        }
      }
    }
    if (cells.empty())
    {
      return false;
    }
    if (arcs.empty())
    {
      this->Replace(old, cells, materials);
      return true;
    }
    const double area = this->InterfaceArea(from, arcs);
    for (const auto& [material, change] : volumes)
    {
      if (std::abs(change) > 0.25 * this->ShiftMm * area ||
        std::find(materials.begin(), materials.end(), material) == materials.end())
      {
        return false;
      }
    }
    std::vector<std::int32_t> touched = this->Mesh.Neighbours(from);
    return this->ReplaceInterface(old, cells, materials, touched);
  }

  /// True if `to` lies on every interface of `from` and both are connected along it.
  bool MayCollapse(std::int32_t from, std::int32_t to,
    const std::vector<EditableMesh::Arc>& arcs) const
  {
    Contacts joined;
    for (const EditableMesh::Arc& arc : arcs)
    {
      if (arc.A == to || arc.B == to)
      {
        joined.insert(arc.Materials);
      }
    }
    return std::all_of(arcs.begin(), arcs.end(),
             [&joined](const EditableMesh::Arc& arc) { return joined.count(arc.Materials) > 0; }) &&
      this->Mesh.IsSurrounded(from);
  }

  double InterfaceArea(std::int32_t point, const std::vector<EditableMesh::Arc>& arcs) const
  {
    double area = 0;
    for (const EditableMesh::Arc& arc : arcs)
    {
      area += 0.5 *
        Norm(Cross(this->Mesh.Point(arc.A) - this->Mesh.Point(point),
          this->Mesh.Point(arc.B) - this->Mesh.Point(point)));
    }
    return area;
  }

  EditableMesh& Mesh;
  double Goal;
  double ShiftMm;
  /// Initial positions of the points.
  std::vector<Vector3> Anchors;
  /// Counter of changes. A cell that could not be improved is tried again only after a change
  /// around it, because most such cells cannot be improved at all.
  std::uint32_t Changes = 1;
  /// Number of the last change to the cells around each point.
  std::vector<std::uint32_t> LastChange;
  /// Number of the last change when each cell was examined.
  std::vector<std::uint32_t> LastExamined;
};
}

void ImproveCells(EditableMesh& mesh, double goalDeg, double shiftMm,
  const ProgressCallback& progress)
{
  CellImprover improver(mesh, std::sin(goalDeg * std::numbers::pi / 180), shiftMm);
  for (int pass = 0; pass < 6; ++pass)
  {
    if (improver.Pass(ShareOf(progress, pass / 6.0, (pass + 1) / 6.0)) == 0)
    {
      break;
    }
  }
}
}
