// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TetrahedralMesh_h
#define mammoray_TetrahedralMesh_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/// Linear tetrahedra with one material each. In a positively oriented cell, det(p1-p0, p2-p0,
/// p3-p0) > 0.
struct MAMMORAYFOUNDATION_EXPORT TetrahedralMesh
{
  /// 3 x pointCount, x y z interleaved, mm, volume frame.
  std::vector<double> Points;
  /// 4 x cellCount point indices.
  std::vector<std::int32_t> Cells;
  /// One material index (see MaterialTable) per cell; never 0 (air).
  std::vector<std::int32_t> Materials;

  std::size_t NumberOfPoints() const { return this->Points.size() / 3; }
  std::size_t NumberOfCells() const { return this->Cells.size() / 4; }
  Vector3 Point(std::size_t index) const
  {
    return { this->Points[3 * index], this->Points[3 * index + 1], this->Points[3 * index + 2] };
  }
  /// Centroid of a cell, mm.
  Vector3 CellCentre(std::size_t cell) const;
  /// Signed volume of a cell, mm^3.
  double CellVolume(std::size_t cell) const;
  /// Throws InputError if there are no cells or an index is out of range.
  void ValidateIndices(const std::string& name) const;
  /// Throws InputError as ValidateIndices, and if a cell is not positively oriented.
  void Validate(const std::string& name) const;
  bool operator==(const TetrahedralMesh&) const = default;
};
}

#endif
