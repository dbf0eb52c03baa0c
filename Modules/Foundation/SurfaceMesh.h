// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceMesh_h
#define mammoray_SurfaceMesh_h

#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammorayFoundationModule.h"

#include <cstdint>
#include <vector>

namespace mammoray
{
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
}

#endif
