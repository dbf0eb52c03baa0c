// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CellPatches_h
#define mammoray_CellPatches_h

#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <vector>

namespace mammoray
{
/// Corners of the face opposite to each corner of a tetrahedron, counter-clockwise from outside.
constexpr int FaceCorners[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
/// Corners at the ends of the edges, in whose order quadratic cells number their middles, from 4
/// on.
constexpr int CellEdges[6][2] = { { 0, 1 }, { 1, 2 }, { 0, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
/// The edge middles of each face, in the order of FaceCorners.
constexpr int FaceMiddles[4][3] = { { 5, 9, 8 }, { 7, 9, 6 }, { 4, 8, 7 }, { 6, 5, 4 } };

/// The cell behind the face opposite to each corner, -1 on the boundary; 4 per cell.
MAMMORAYBIOMECHANICS_EXPORT std::vector<std::int32_t> FaceNeighbours(const TetrahedralMesh& mesh);

/// Cells of a patch: what is aimed at, and the most.
constexpr int UsualPatchSize = 8;
constexpr int LargestPatchSize = 12;

/**
 * Divides the cells into compact patches that hang together by faces, each with cells of one group
 * only. Depends on the order of the cells and on nothing else. `neighbours` of FaceNeighbours,
 * `groups`: one per cell.
 */
MAMMORAYBIOMECHANICS_EXPORT std::vector<std::vector<std::int32_t>> MakePatches(
  const TetrahedralMesh& mesh, const std::vector<std::int32_t>& neighbours,
  const std::vector<char>& groups);
}

#endif
