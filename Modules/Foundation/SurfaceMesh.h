// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceMesh_h
#define mammoray_SurfaceMesh_h

#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammorayFoundationModule.h"

#include <cstdint>
#include <vector>

namespace mammoray
{
/**
 * Triangles with a material on each side. The front of a triangle is the side its normal
 * (p1-p0) x (p2-p0) points to. Material 0 is air.
 */
struct MAMMORAYFOUNDATION_EXPORT SurfaceMesh
{
  /// 3 x pointCount, x y z interleaved, mm.
  std::vector<double> Points;
  /// 3 x triangleCount point indices.
  std::vector<std::uint32_t> Triangles;
  /// Material on each triangle's front and back; triangleCount values each.
  std::vector<std::uint16_t> FrontMaterials;
  std::vector<std::uint16_t> BackMaterials;

  std::size_t NumberOfPoints() const { return this->Points.size() / 3; }
  std::size_t NumberOfTriangles() const { return this->Triangles.size() / 3; }
  /// 1 + the largest material index in use.
  int NumberOfMaterials() const;
  /// Throws InputError when sizes or indices do not fit or a coordinate is not finite.
  void Validate(const std::string& name) const;
};

/**
 * The interfaces of a tetrahedral body: every face with different materials on its two sides (air
 * outside), once. `pointIds`, if given, receives for each point of the result the point of the mesh
 * it came from, so that moved positions can be copied without extracting again.
 *
 * A fine mesh that a coarse simulation carries along may hold cells that are turned over. What is
 * between two materials stays where it is then, so these are taken as they were before, as long as
 * face-neighbours lead from each to an upright cell. Throws InputError where they do not, where
 * neighbours list their corners in contrary senses, and where three cells share a face.
 */
MAMMORAYFOUNDATION_EXPORT SurfaceMesh ExtractInterfaces(const TetrahedralMesh& mesh,
  std::vector<std::int32_t>* pointIds = nullptr);

/// Adds the closed boundary of a material: `boundary` says which of its sides are air (0), all
/// others are `material`.
MAMMORAYFOUNDATION_EXPORT void AppendBoundary(const SurfaceMesh& boundary, int material,
  SurfaceMesh& all);
}

#endif
