// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshQuality_h
#define mammoray_MeshQuality_h

#include "mammoray/Foundation/Meshes.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/// Smallest dihedral angle of a cell, degrees; at best 70.5.
MAMMORAYMESHING_EXPORT double SmallestDihedralDeg(const TetrahedralMesh& mesh, std::size_t cell);

/// Radius of the circumscribed sphere divided by the shortest edge; at best 0.61.
MAMMORAYMESHING_EXPORT double RadiusEdgeRatio(const TetrahedralMesh& mesh, std::size_t cell);
}

#endif
