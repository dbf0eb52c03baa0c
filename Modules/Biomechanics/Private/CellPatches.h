// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CellPatches_h
#define mammoray_CellPatches_h

#include "TetrahedralMesh.h"

#include <cstdint>
#include <vector>

namespace mammoray
{
/// Corners of the face opposite to each corner of a tetrahedron, counter-clockwise from inside.
constexpr int FaceCorners[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };

/// The cell behind the face opposite to each corner, -1 on the boundary; 4 per cell.
std::vector<std::int32_t> FaceNeighbours(const TetrahedralMesh& mesh);

/// Cells of a patch: what is aimed at, and the most.
constexpr int UsualPatchSize = 8;
constexpr int LargestPatchSize = 12;

/**
 * Divides the cells into compact patches that hang together by faces, each with cells of one group
 * only. Depends on the order of the cells and on nothing else. `neighbours` of FaceNeighbours,
 * `groups`: one per cell.
 */
std::vector<std::vector<std::int32_t>> MakePatches(const TetrahedralMesh& mesh,
  const std::vector<std::int32_t>& neighbours, const std::vector<char>& groups);
}

#endif
