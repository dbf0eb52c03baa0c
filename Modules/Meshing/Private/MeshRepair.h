// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshRepair_h
#define mammoray_MeshRepair_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * Makes the boundary of every material, and of the whole body, a manifold that nowhere touches
 * itself (see MeshTrouble::Kind::Pinches). Near such edges and points, cells change their material
 * or are split; where the body itself is connected only by an edge or a point, it is separated.
 * Other interfaces stay in place. New cells below `smallestDihedralDeg` are improved if interfaces
 * allow it. A mesh without pinches is unchanged. The result is deterministic. Returns the number of
 * pinched points. Throws InputError as TetrahedralMesh::Validate.
 */
MAMMORAYMESHING_EXPORT std::size_t MendInterfaces(TetrahedralMesh& mesh,
  double smallestDihedralDeg = 12, const ProgressCallback& progress = {});
}

#endif
