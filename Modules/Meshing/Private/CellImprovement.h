// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CellImprovement_h
#define mammoray_CellImprovement_h

#include "Private/EditableMesh.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
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
}

#endif
