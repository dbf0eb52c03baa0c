// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AccelerationStructure_h
#define mammoray_AccelerationStructure_h

#include "Private/Buffer.h"

namespace mammoray
{
/// An acceleration structure over one geometry, with its memory; can be refitted.
class AccelerationStructure
{
public:
  AccelerationStructure() = default;
  /// Sizes it for `primitiveCount` triangles or instances; Record builds it.
  AccelerationStructure(const VulkanDevice& device, vk::AccelerationStructureTypeKHR type,
    const vk::AccelerationStructureGeometryKHR& geometry, std::uint32_t primitiveCount);

  /// Records a build, or, with `refit`, an update for the same primitives at new places.
  void Record(const vk::raii::CommandBuffer& commands, bool refit) const;
  vk::AccelerationStructureKHR Handle() const { return **this->Object; }
  vk::DeviceAddress Address() const { return this->DeviceAddress; }

private:
  vk::AccelerationStructureTypeKHR Type{};
  vk::AccelerationStructureGeometryKHR Geometry;
  std::uint32_t PrimitiveCount = 0;
  Buffer Storage;
  Buffer Scratch;
  vk::DeviceAddress ScratchAddress = 0;
  std::optional<vk::raii::AccelerationStructureKHR> Object;
  vk::DeviceAddress DeviceAddress = 0;
};
}

#endif
