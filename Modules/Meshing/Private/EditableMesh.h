// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EditableMesh_h
#define mammoray_EditableMesh_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayMeshingModule.h"

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace mammoray
{
/// Tetrahedra in a form that supports moving points and adding, removing and relabelling cells.
/// Material 0 is air: such cells may be present during editing, so that the surface does not
/// intersect itself, and are left out of the result.
class MAMMORAYMESHING_EXPORT EditableMesh
{
public:
  struct Cell
  {
    /// Positively oriented.
    std::array<std::int32_t, 4> Ids{ -1, -1, -1, -1 };
    std::int32_t Material = 0;
    /// False after removal.
    bool Alive = true;
  };

  explicit EditableMesh(const TetrahedralMesh& mesh);
  /// Returns the cells of tissue and the points they use, in order.
  TetrahedralMesh Finish() const;

  std::vector<Vector3> Points;

  std::size_t NumberOfCells() const { return this->Cells.size(); }
  const Cell& operator[](std::int32_t cell) const
  {
    return this->Cells[static_cast<std::size_t>(cell)];
  }
  bool IsAlive(std::int32_t cell) const { return (*this)[cell].Alive; }
  /// Cells around a point.
  const std::vector<std::int32_t>& Star(std::int32_t point) const
  {
    return this->Stars[static_cast<std::size_t>(point)];
  }
  /// Cells that contain both points.
  std::vector<std::int32_t> Ring(std::int32_t a, std::int32_t b) const;
  /// Other corners of the cells around a point, ascending.
  std::vector<std::int32_t> Neighbours(std::int32_t point) const;
  /// An edge AB of a point's link where two materials meet, ascending; outside is air.
  struct Arc
  {
    std::int32_t A;
    std::int32_t B;
    std::array<std::int32_t, 2> Materials;
  };
  /// Edges of the link where materials meet around a point; empty inside a material.
  std::vector<Arc> Arcs(std::int32_t point) const;
  /// True if cells, possibly of air, surround a point completely.
  bool IsSurrounded(std::int32_t point) const;
  const Vector3& Point(std::int32_t point) const
  {
    return this->Points[static_cast<std::size_t>(point)];
  }
  /// Signed volume, mm^3.
  double Volume(const std::array<std::int32_t, 4>& ids) const;
  /// The smallest sine of the six dihedral angles; at best 0.94, small for angles near 0 and near
  /// 180 degrees. For needles, whose angles can be good, it is at most twice the shortest edge
  /// divided by the longest. Not positive if the volume is not.
  double Quality(const std::array<std::int32_t, 4>& ids) const;
  /// Quality of a cell with this material; 1 for upright cells of air.
  double Quality(const std::array<std::int32_t, 4>& ids, std::int32_t material) const
  {
    return material == 0 && this->Volume(ids) > 0 ? 1.0 : this->Quality(ids);
  }
  /// The worst quality of some cells; 1 if there are none.
  double WorstOf(const std::vector<std::int32_t>& cells) const;

  std::int32_t Add(const std::array<std::int32_t, 4>& ids, std::int32_t material);
  void Remove(std::int32_t cell);
  /// Restores a removed cell.
  void Restore(std::int32_t cell);
  void SetMaterial(std::int32_t cell, std::int32_t material)
  {
    this->Cells[static_cast<std::size_t>(cell)].Material = material;
  }
  /// Splits the cells around an edge at a + share (b - a); returns the new point.
  std::int32_t SplitEdge(std::int32_t a, std::int32_t b, double share);

private:
  static constexpr std::int32_t Nothing = -1;
  /// All edges of a point's link, unordered. The second material is Nothing where the mesh ends.
  std::vector<Arc> LinkEdges(std::int32_t point) const;

  std::vector<Cell> Cells;
  std::vector<std::vector<std::int32_t>> Stars;
};

/// Returns `ids` with one corner replaced.
inline std::array<std::int32_t, 4> Replaced(std::array<std::int32_t, 4> ids, std::int32_t old,
  std::int32_t fresh)
{
  for (std::int32_t& id : ids)
  {
    id = id == old ? fresh : id;
  }
  return ids;
}

inline bool Contains(const std::array<std::int32_t, 4>& ids, std::int32_t point)
{
  return ids[0] == point || ids[1] == point || ids[2] == point || ids[3] == point;
}

/// Pairs of materials that meet around a point, the lower one first.
using Contacts = std::set<std::array<std::int32_t, 2>>;
Contacts FindContacts(const EditableMesh& mesh, std::int32_t point);

/**
 * Measures how far the boundaries of the materials around a point (including air) are from
 * manifolds. It adds, for every material, the closed curves beyond the first that its boundary cuts
 * from the point's link and, for every edge, the pairs of its triangles beyond the first pair. It
 * is 0 if every boundary is a 2-manifold at the point.
 */
MAMMORAYMESHING_EXPORT int PinchExcess(const EditableMesh& mesh, std::int32_t point);

/**
 * Makes the boundary of every material, and of all of them together, a 2-manifold. First, cells
 * take the material of a neighbour, smallest cells first, if that removes pinches, opens no layer,
 * and costs no component more than 2 % of its volume. What remains is cut out: the edges that leave
 * a pinched point or edge are split, and the small cells around it all get one material, the one
 * that fills most of them, or air if the whole body is pinched.
 *
 * The second step always ends without pinches. An edge is pinched if a material fills more than one
 * sector of the cells around it. Let all edges that leave a point p (or an edge with both its ends)
 * be free of pinches. Split those edges and give the cells around p to one material. Each new point
 * lies on such an edge; it sees this material on p's side and one sector of each other material
 * beyond, so every material is a disc of its link. p itself sees one material, and nothing else has
 * changed. Points with several pinched edges are processed first; after that, each remaining
 * pinched edge is isolated. Returns the number of pinched points.
 */
MAMMORAYMESHING_EXPORT std::size_t RepairPinches(EditableMesh& mesh,
  const ProgressCallback& progress);

/**
 * Improves cells with a dihedral angle within `goalDeg` of 0 or 180 degrees by local changes, worst
 * cells first, as long as the worst angle of the affected cells improves: edge and face swaps (2-3,
 * and all fillings of rings of up to eight cells), moved points, and edge collapses (Freitag and
 * Ollivier-Gooch, Int J Numer Meth Eng 40, 1997; Klincsek's triangulation for the best swap).
 * Interfaces may move by up to `shiftMm` and keep their topology, so no pinches arise. The surface
 * of the mesh is kept. The result is deterministic.
 *
 * CGAL offers such steps only in its tetrahedral remeshing, which changes the sizes of all cells.
 */
MAMMORAYMESHING_EXPORT void ImproveCells(EditableMesh& mesh, double goalDeg, double shiftMm,
  const ProgressCallback& progress);

/**
 * Moves the interfaces so that every material gets its target volume (mm^3, by material; air takes
 * the rest). The interface of materials a and b moves along its normal by o_a - o_b, with one
 * offset o per material, found by Newton steps on the volumes (their gradient with respect to a
 * point is a third of the area normals around it). No point moves by more than `shiftMm` in total,
 * or so far that a cell around it gets a dihedral angle below `leastDeg` that it did not have.
 */
MAMMORAYMESHING_EXPORT void FitVolumes(EditableMesh& mesh,
  const std::map<std::int32_t, double>& volumesMm3, double shiftMm, double leastDeg,
  const ProgressCallback& progress);
}

#endif
