// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FaceTable_h
#define mammoray_FaceTable_h

#include "mammoray/Foundation/Meshes.h"
#include "mammorayFoundationModule.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

namespace mammoray
{
/// Finds the faces that cells of a mesh share. Face 4 c + f is the face of cell c opposite to its
/// corner f. The mesh must have valid indices and outlive the table.
class MAMMORAYFOUNDATION_EXPORT FaceTable
{
public:
  explicit FaceTable(const TetrahedralMesh& mesh);

  /// Points of a face, counter-clockwise seen from outside a positively oriented cell.
  std::array<std::int32_t, 3> Corners(std::size_t face) const
  {
    const std::int32_t* cell = &this->Mesh.Cells[face & ~static_cast<std::size_t>(3)];
    const std::array<std::size_t, 3>& local = LocalCorners[face & 3];
    return { cell[local[0]], cell[local[1]], cell[local[2]] };
  }

  /// True if two cells that share a face lie on different sides of it, judged by the order of their
  /// corners.
  bool OnDifferentSides(std::size_t face, std::size_t other) const;

  /// A face of one cell, identified by the two larger of its sorted point indices.
  struct Entry
  {
    std::int32_t Middle = 0;
    std::int32_t Last = 0;
    std::size_t Face = 0;
  };

  /// Calls visit(entries) once for every face of the mesh. `entries` is a span with one Entry per
  /// cell that has the face, with ascending Face. Faces come in the order of their sorted points.
  template <typename Visit>
  void ForEachFace(const Visit& visit)
  {
    for (std::size_t group = 0; group + 1 < this->GroupBegin.size(); ++group)
    {
      const std::span entries =
        std::span(this->Entries)
          .subspan(this->GroupBegin[group], this->GroupBegin[group + 1] - this->GroupBegin[group]);
      std::sort(entries.begin(), entries.end(),
        [](const Entry& a, const Entry& b)
        { return std::tie(a.Middle, a.Last, a.Face) < std::tie(b.Middle, b.Last, b.Face); });
      for (std::size_t first = 0, end = 0; first < entries.size(); first = end)
      {
        while (end < entries.size() && entries[end].Middle == entries[first].Middle &&
          entries[end].Last == entries[first].Last)
        {
          ++end;
        }
        visit(std::span<const Entry>(entries.subspan(first, end - first)));
      }
    }
  }

private:
  static constexpr std::array<std::array<std::size_t, 3>, 4> LocalCorners{ { { 1, 2, 3 },
    { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } } };

  const TetrahedralMesh& Mesh;
  /// Entries, grouped by the smallest point of their faces. Groups are small, so sorting each is
  /// fast.
  std::vector<std::size_t> GroupBegin;
  std::vector<Entry> Entries;
};

/// Disjoint sets of the numbers [0, count), which are joined pair by pair (union-find). At first
/// each number is a set of its own.
class DisjointSets
{
public:
  explicit DisjointSets(std::size_t count)
    : Parent(count)
  {
    std::iota(this->Parent.begin(), this->Parent.end(), std::uint32_t{ 0 });
  }
  /// Representative of a member's set.
  std::uint32_t Root(std::uint32_t member)
  {
    while (this->Parent[member] != member)
    {
      this->Parent[member] = this->Parent[this->Parent[member]];
      member = this->Parent[member];
    }
    return member;
  }
  /// Joins two sets; the representative of `b`'s set represents both.
  void Join(std::uint32_t a, std::uint32_t b) { this->Parent[this->Root(a)] = this->Root(b); }

private:
  std::vector<std::uint32_t> Parent;
};
}

#endif
