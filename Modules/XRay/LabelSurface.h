// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelSurface_h
#define mammoray_LabelSurface_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mammoray
{
/**
 * Quadrilaterals with a material on each side. Seen from its front, the corners of a quad run
 * counter-clockwise.
 */
struct MAMMORAYXRAY_EXPORT QuadMesh
{
  /// mm.
  std::vector<Vector3> Points;
  /// Four point indices each.
  std::vector<std::array<std::uint32_t, 4>> Quads;
  /// Materials of each quad's two sides.
  std::vector<std::uint16_t> FrontMaterials;
  std::vector<std::uint16_t> BackMaterials;

  /**
   * The same surface as exactly `triangleCount` triangles. A quad makes two. Further pairs come
   * from points that are added evenly over the quads: first at the centre of a quad, then at the
   * centre of one of its triangles. Throws InputError on an odd count or one below two per quad.
   */
  SurfaceMesh Triangulate(std::size_t triangleCount) const;
};

/**
 * Extracts the interfaces of a volume of materials (0 = air, also outside): every face between
 * voxels of different materials, once, in the volume frame. In each of `smoothingSteps` steps a
 * corner moves to the mean of its neighbours on the surface, at most half a voxel along any axis
 * (surface nets: Gibson, MERL TR99-24, 1999). Materials that touch share their interface, and every
 * material stays closed. Throws InputError if there is only air.
 */
MAMMORAYXRAY_EXPORT QuadMesh ExtractInterfaces(const LabelVolume& materials, int smoothingSteps);
}

#endif
