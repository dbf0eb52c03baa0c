// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PinchRepair_h
#define mammoray_PinchRepair_h

#include "Private/EditableMesh.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * How far the boundaries of the materials around a point (air included) are from being surfaces
 * there: for every material the closed curves that its boundary cuts out of the point's link beyond
 * the first, and for every edge the pairs of its triangles beyond the first pair. 0: every boundary
 * is a 2-manifold at the point.
 */
MAMMORAYMESHING_EXPORT int PinchExcess(const EditableMesh& mesh, std::int32_t point);

/**
 * Makes the boundary of every material, and of all of them together, a 2-manifold. First cells go
 * to the material of a neighbour, the smallest ones first, where that takes pinches away, no layer
 * is opened, and no component loses more than a fiftieth of its volume. What remains is cut out:
 * the edges that leave a pinched point or edge are divided, and the small cells around it all
 * become one material, the one that fills most of them, or air where the whole body is pinched.
 *
 * That always ends without pinches. An edge is pinched when a material fills more than one sector
 * of the cells around it. Where all edges that leave a point p (or an edge with both its ends) are
 * not pinched, give the cells around it to one material after dividing those edges: each new point
 * lies on such an edge, and sees the one material on p's side and a single sector of each other one
 * beyond, so that every material is a disc of its link; p itself sees one material. Nothing else
 * has changed. Points with several pinched edges are taken first, after which each pinched edge
 * that is left stands alone. Returns the number of points that were pinched.
 */
MAMMORAYMESHING_EXPORT std::size_t RepairPinches(EditableMesh& mesh,
  const ProgressCallback& progress);
}

#endif
