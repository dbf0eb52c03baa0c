// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/FaceTable.h"

namespace mammoray
{
namespace
{
/// True if sorting three indices takes an odd number of exchanges.
bool IsOdd(const std::array<std::int32_t, 3>& ids)
{
  return ((ids[0] > ids[1]) != (ids[0] > ids[2])) != (ids[1] > ids[2]);
}
}

FaceTable::FaceTable(const TetrahedralMesh& mesh)
  : Mesh(mesh)
  , GroupBegin(mesh.NumberOfPoints() + 1, 0)
  , Entries(4 * mesh.NumberOfCells())
{
  for (std::size_t face = 0; face < this->Entries.size(); ++face)
  {
    const std::array<std::int32_t, 3> ids = this->Corners(face);
    ++this->GroupBegin[1 + static_cast<std::size_t>(std::min({ ids[0], ids[1], ids[2] }))];
  }
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    this->GroupBegin[point + 1] += this->GroupBegin[point];
  }
  std::vector<std::size_t> next(this->GroupBegin.begin(), this->GroupBegin.end() - 1);
  for (std::size_t face = 0; face < this->Entries.size(); ++face)
  {
    std::array<std::int32_t, 3> ids = this->Corners(face);
    std::sort(ids.begin(), ids.end());
    this->Entries[next[static_cast<std::size_t>(ids[0])]++] = { ids[1], ids[2], face };
  }
}

bool FaceTable::OnDifferentSides(std::size_t face, std::size_t other) const
{
  return IsOdd(this->Corners(face)) != IsOdd(this->Corners(other));
}
}
