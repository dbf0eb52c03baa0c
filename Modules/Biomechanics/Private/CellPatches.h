// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CellPatches_h
#define mammoray_CellPatches_h

#include "mammoray/Foundation/Meshes.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <vector>

namespace mammoray
{
/// Corners of the face opposite to each corner of a tetrahedron, counter-clockwise seen from
/// outside.
constexpr int FaceCorners[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
/// Corners at the ends of the six edges. Quadratic cells number their mid-side nodes in this order,
/// from 4 on.
constexpr int CellEdges[6][2] = { { 0, 1 }, { 1, 2 }, { 0, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
/// Mid-side nodes of each face, in the order of FaceCorners.
constexpr int FaceMiddles[4][3] = { { 5, 9, 8 }, { 7, 9, 6 }, { 4, 8, 7 }, { 6, 5, 4 } };

/// The cell behind the face opposite to each corner, 4 per cell; -1 on the boundary.
MAMMORAYBIOMECHANICS_EXPORT std::vector<std::int32_t> FaceNeighbours(const TetrahedralMesh& mesh);

/// Intended and largest number of cells in a patch.
constexpr int UsualPatchSize = 8;
constexpr int LargestPatchSize = 12;

/// Divides the cells into compact patches connected by faces, each with cells of one group only.
/// The result depends only on the order of the cells. `neighbours` comes from FaceNeighbours;
/// `groups` holds one value per cell.
MAMMORAYBIOMECHANICS_EXPORT std::vector<std::vector<std::int32_t>> MakePatches(
  const TetrahedralMesh& mesh, const std::vector<std::int32_t>& neighbours,
  const std::vector<char>& groups);
}

#endif
