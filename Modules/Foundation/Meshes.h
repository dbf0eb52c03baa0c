// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Meshes_h
#define mammoray_Meshes_h

#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
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

/// Triangles with a material on each side. The normal (p1-p0) x (p2-p0) of a triangle points to its
/// front. Material 0 is air.
struct MAMMORAYFOUNDATION_EXPORT SurfaceMesh
{
  /// 3 x pointCount, x y z interleaved, mm.
  std::vector<double> Points;
  /// 3 x triangleCount point indices.
  std::vector<std::uint32_t> Triangles;
  /// Material on the front and on the back of each triangle; triangleCount values each.
  std::vector<std::uint16_t> FrontMaterials;
  std::vector<std::uint16_t> BackMaterials;

  std::size_t NumberOfPoints() const { return this->Points.size() / 3; }
  std::size_t NumberOfTriangles() const { return this->Triangles.size() / 3; }
  Vector3 Point(std::size_t index) const
  {
    return { this->Points[3 * index], this->Points[3 * index + 1], this->Points[3 * index + 2] };
  }
  /// Position of corner 0, 1 or 2 of a triangle.
  Vector3 Corner(std::size_t triangle, std::size_t corner) const
  {
    return this->Point(this->Triangles[3 * triangle + corner]);
  }
  /// 1 + the largest material index in use.
  int NumberOfMaterials() const;
  /// Throws InputError if array sizes or indices are inconsistent or a coordinate is not finite.
  void Validate(const std::string& name) const;
};

/**
 * Extracts the interfaces of a tetrahedral body: every face with different materials on its two
 * sides (air outside), once. If `pointIds` is given, it receives the mesh's point for each point of
 * the result, so that moved positions can be copied without another extraction.
 *
 * A fine mesh that a coarse simulation moves can contain inverted cells. They are treated as if
 * they were not inverted, because interfaces stay between the same materials, as long as neighbours
 * lead from each of them to an upright cell. Throws InputError if they do not, if neighbours list
 * their corners in contradictory order, and if three cells share a face.
 */
MAMMORAYFOUNDATION_EXPORT SurfaceMesh ExtractInterfaces(const TetrahedralMesh& mesh,
  std::vector<std::int32_t>* pointIds = nullptr);

/// Appends the closed boundary of a material to `all`. Sides of `boundary` with material 0 are air;
/// all others become `material`.
MAMMORAYFOUNDATION_EXPORT void AppendBoundary(const SurfaceMesh& boundary, int material,
  SurfaceMesh& all);

/**
 * Vector fields over the same points in one array, ordered [field][point][3]: for example the
 * velocity of every point with each parameter. From the solver to the projectors they keep this
 * order.
 */
struct VectorFields
{
  /// Values[(field * pointCount + point) * 3 + axis].
  std::vector<double> Values;
  /// Length of one field: 3 * pointCount.
  std::size_t Length = 0;

  VectorFields() = default;
  /// Fields of zeros.
  VectorFields(std::size_t count, std::size_t length)
    : Values(count * length, 0.0)
    , Length(length)
  {
  }
  /// The fields in `values`, each of `length` values.
  VectorFields(std::vector<double> values, std::size_t length)
    : Values(std::move(values))
    , Length(length)
  {
  }
  std::size_t Count() const { return this->Length ? this->Values.size() / this->Length : 0; }
  std::span<double> operator[](std::size_t field)
  {
    return std::span(this->Values).subspan(field * this->Length, this->Length);
  }
  std::span<const double> operator[](std::size_t field) const
  {
    return std::span(this->Values).subspan(field * this->Length, this->Length);
  }
};
}

#endif
