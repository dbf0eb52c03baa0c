// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/TetrahedralMesh.h"

#include "mammoray/Foundation/Error.h"

namespace mammoray
{
Vector3 TetrahedralMesh::CellCentre(std::size_t cell) const
{
  const std::int32_t* ids = &this->Cells[4 * cell];
  return 0.25 *
    (this->Point(ids[0]) + this->Point(ids[1]) + this->Point(ids[2]) + this->Point(ids[3]));
}

double TetrahedralMesh::CellVolume(std::size_t cell) const
{
  const std::int32_t* ids = &this->Cells[4 * cell];
  const Vector3 origin = this->Point(ids[0]);
  return Dot(this->Point(ids[1]) - origin,
           Cross(this->Point(ids[2]) - origin, this->Point(ids[3]) - origin)) /
    6.0;
}

void TetrahedralMesh::ValidateIndices(const std::string& name) const
{
  if (this->NumberOfCells() == 0)
  {
    throw InputError(name + ": expected tetrahedra, found none");
  }
  if (this->Cells.size() % 4 != 0 || this->Materials.size() != this->NumberOfCells())
  {
    throw InputError(name + ": expected 4 indices and 1 material per cell, found " +
      std::to_string(this->Cells.size()) + " and " + std::to_string(this->Materials.size()));
  }
  const auto pointCount = static_cast<std::int64_t>(this->NumberOfPoints());
  for (std::size_t index = 0; index < this->Cells.size(); ++index)
  {
    if (this->Cells[index] < 0 || this->Cells[index] >= pointCount)
    {
      throw InputError(name + ": cell " + std::to_string(index / 4) + " uses point " +
        std::to_string(this->Cells[index]) + ", expected 0 to " + std::to_string(pointCount - 1));
    }
  }
}

void TetrahedralMesh::Validate(const std::string& name) const
{
  this->ValidateIndices(name);
  for (std::size_t cell = 0; cell < this->NumberOfCells(); ++cell)
  {
    const double volume = this->CellVolume(cell);
    if (!(volume > 0))
    {
      throw InputError(name + ": cell " + std::to_string(cell) + " has volume " +
        std::to_string(volume) + " mm3, expected a positive one");
    }
  }
}
}
