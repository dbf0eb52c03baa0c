// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PinchRepair_h
#define mammoray_PinchRepair_h

#include "Private/EditableMesh.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayMeshingModule.h"

#include <array>
#include <cstdint>
#include <set>

namespace mammoray
{
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
}

#endif
