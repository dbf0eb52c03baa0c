// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshQuality_h
#define mammoray_MeshQuality_h

#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/// Smallest of the six dihedral angles of a cell, degrees; 70.5 at best.
MAMMORAYMESHING_EXPORT double SmallestDihedralDeg(const TetrahedralMesh& mesh, std::size_t cell);

/// Radius of the circumscribed sphere over the shortest edge; 0.61 at best.
MAMMORAYMESHING_EXPORT double RadiusEdgeRatio(const TetrahedralMesh& mesh, std::size_t cell);
}

#endif
