// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DeviceSurface_h
#define mammoray_DeviceSurface_h

#include "Private/Buffer.h"
#include "mammoray/Foundation/Meshes.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mammoray
{
/**
 * A surface in the buffers of a device, in the *local frame*: the mesh's axes, the origin at the
 * middle of the mesh's box, so that coordinates are small.
 */
struct DeviceSurface
{
  std::size_t PointCount = 0;
  std::uint32_t TriangleCount = 0;
  /// Air included.
  std::uint32_t MaterialCount = 0;
  /// The local frame's origin, and the mesh's box, in the mesh's frame, mm.
  Vector3 Center{ 0, 0, 0 };
  Box3 Bounds;
  /// 3 x PointCount doubles or floats, x y z interleaved, local frame, mm.
  Buffer Positions;
  /// 3 x TriangleCount 32-bit point indices.
  Buffer Triangles;
  /// TriangleCount 32-bit words: front material in the lower, back material in the upper 16 bits.
  Buffer Materials;

  /// Replaces the surface; triangle n is the mesh's triangle order[n], or n where there is no
  /// order. Throws DeviceError where one of the buffers would be larger than the device takes.
  void Set(const VulkanDevice& device, const SurfaceMesh& mesh,
    const std::vector<std::uint32_t>& order, bool doubles, vk::BufferUsageFlags usage);
  /// New positions (3 x PointCount, mm) for the same triangles, and the local frame with them.
  void Move(const std::vector<double>& points, bool doubles);
  /// Positions relative to Center; 3 x PointCount values.
  template <typename Real>
  void WriteLocal(const std::vector<double>& points, Real* positions) const
  {
    for (std::size_t index = 0; index < points.size(); index += 3)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        positions[index + axis] = static_cast<Real>(points[index + axis] - this->Center[axis]);
      }
    }
  }
};
}

#endif
