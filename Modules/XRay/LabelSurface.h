// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelSurface_h
#define mammoray_LabelSurface_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mammoray
{
/**
 * Quadrilaterals with a material on each side. The front of a quad is the side that its corners
 * turn counter-clockwise on.
 */
struct MAMMORAYXRAY_EXPORT QuadMesh
{
  /// mm.
  std::vector<Vector3> Points;
  /// Four point indices each.
  std::vector<std::array<std::uint32_t, 4>> Quads;
  /// One each per quad.
  std::vector<std::uint16_t> FrontMaterials;
  std::vector<std::uint16_t> BackMaterials;

  /**
   * Exactly `triangleCount` triangles of the same surface. A quad makes two; further pairs come
   * from points within the quads, spread evenly over them: the first in the middle of its quad, the
   * next ones in the middle of a triangle of it. Throws InputError on an odd count or one below two
   * per quad.
   */
  SurfaceMesh Triangulate(std::size_t triangleCount) const;
};

/**
 * The interfaces of a volume of materials (0 = air, air outside): every face between voxels of
 * different materials, once, in the volume frame. `smoothingSteps` times each corner moves to the
 * mean of its neighbours on the surface, but never more than half a voxel along any axis (surface
 * nets: Gibson, MERL TR99-24, 1999). Materials that touch keep sharing their interface, and every
 * material stays closed. Throws InputError where nothing but air is found.
 */
MAMMORAYXRAY_EXPORT QuadMesh ExtractInterfaces(const LabelVolume& materials, int smoothingSteps);
}

#endif
