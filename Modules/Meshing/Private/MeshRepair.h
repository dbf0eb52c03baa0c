// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshRepair_h
#define mammoray_MeshRepair_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * Makes the boundary of every material and of the whole body a surface that nowhere touches itself
 * (MeshCheck's pinches): near such edges and points cells change their material or are divided, and
 * where the body itself hangs by an edge or a point it is parted. Other interfaces keep their
 * place; cells that arise below `smallestDihedralDeg` are improved where that leaves interfaces
 * alone. A mesh without pinches stays as it is. Deterministic. Returns the number of points that
 * were pinched. Throws InputError as TetrahedralMesh::Validate does.
 */
MAMMORAYMESHING_EXPORT std::size_t MendInterfaces(TetrahedralMesh& mesh,
  double smallestDihedralDeg = 12, const ProgressCallback& progress = {});
}

#endif
