// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CellImprovement_h
#define mammoray_CellImprovement_h

#include "Private/EditableMesh.h"
#include "mammoray/Foundation/Progress.h"

namespace mammoray
{
/**
 * Local changes that take away cells whose dihedral angles come within `goalDeg` of 0 or 180
 * degrees, worst cells first, as long as the worst angle of the cells concerned becomes better:
 * edges and faces are swapped (2-3, and all ways of filling rings of up to eight), points moved,
 * edges collapsed (Freitag and Ollivier-Gooch, Int J Numer Meth Eng 40, 1997; Klincsek's
 * triangulation for the best swap). Interfaces may move by up to `shiftMm` and keep their topology:
 * no pinches arise. Where cells end the surface stays. Deterministic.
 *
 * CGAL has such steps inside its tetrahedral remeshing only, which changes the sizes of all cells.
 */
void ImproveCells(EditableMesh& mesh, double goalDeg, double shiftMm,
  const ProgressCallback& progress);
}

#endif
