// SPDX-License-Identifier: Apache-2.0
#include "Private/AccelerationStructure.h"

#include <algorithm>

namespace mammoray
{
namespace
{
vk::AccelerationStructureBuildGeometryInfoKHR BuildInfo(vk::AccelerationStructureTypeKHR type,
  const vk::AccelerationStructureGeometryKHR& geometry)
{
  vk::AccelerationStructureBuildGeometryInfoKHR info;
  info.type = type;
  info.flags = vk::BuildAccelerationStructureFlagBitsKHR::ePreferFastTrace |
    vk::BuildAccelerationStructureFlagBitsKHR::eAllowUpdate;
  info.mode = vk::BuildAccelerationStructureModeKHR::eBuild;
  info.setGeometries(geometry);
  return info;
}
}

AccelerationStructure::AccelerationStructure(const VulkanDevice& device,
  vk::AccelerationStructureTypeKHR type, const vk::AccelerationStructureGeometryKHR& geometry,
  std::uint32_t primitiveCount)
  : Type(type)
  , Geometry(geometry)
  , PrimitiveCount(primitiveCount)
{
  const vk::AccelerationStructureBuildSizesInfoKHR sizes =
    device.Device().getAccelerationStructureBuildSizesKHR(
      vk::AccelerationStructureBuildTypeKHR::eDevice, BuildInfo(type, geometry), primitiveCount);
  this->Storage = Buffer(device, sizes.accelerationStructureSize,
    vk::BufferUsageFlagBits::eAccelerationStructureStorageKHR |
      vk::BufferUsageFlagBits::eShaderDeviceAddress,
    MemoryUse::Device);
  const vk::DeviceSize alignment =
    std::max(1u, device.StructureProperties().minAccelerationStructureScratchOffsetAlignment);
  this->Scratch =
    Buffer(device, std::max(sizes.buildScratchSize, sizes.updateScratchSize) + alignment,
      vk::BufferUsageFlagBits::eStorageBuffer | vk::BufferUsageFlagBits::eShaderDeviceAddress,
      MemoryUse::Device);
  this->ScratchAddress = (this->Scratch.Address() + alignment - 1) / alignment * alignment;
  this->Object.emplace(device.Device(),
    vk::AccelerationStructureCreateInfoKHR({}, this->Storage.Handle(), 0,
      sizes.accelerationStructureSize, type));
  this->DeviceAddress = device.Device().getAccelerationStructureAddressKHR(
    vk::AccelerationStructureDeviceAddressInfoKHR(**this->Object));
}

void AccelerationStructure::Record(const vk::raii::CommandBuffer& commands, bool refit) const
{
  vk::AccelerationStructureBuildGeometryInfoKHR info = BuildInfo(this->Type, this->Geometry);
  info.dstAccelerationStructure = **this->Object;
  info.scratchData.deviceAddress = this->ScratchAddress;
  if (refit)
  {
    info.mode = vk::BuildAccelerationStructureModeKHR::eUpdate;
    info.srcAccelerationStructure = **this->Object;
  }
  const vk::AccelerationStructureBuildRangeInfoKHR range(this->PrimitiveCount, 0, 0, 0);
  const vk::AccelerationStructureBuildRangeInfoKHR* ranges = &range;
  commands.buildAccelerationStructuresKHR(info, ranges);
}
}
