// SPDX-License-Identifier: Apache-2.0
#include "Private/Buffer.h"

#include <algorithm>

namespace mammoray
{
namespace
{
std::uint32_t ChooseMemoryType(const VulkanDevice& device, std::uint32_t typeBits, MemoryUse use)
{
  using Flag = vk::MemoryPropertyFlagBits;
  const vk::MemoryPropertyFlags host = Flag::eHostVisible | Flag::eHostCoherent;
  // Best first. Memory that is local to the device and visible to the host spares a copy; meshes
  // and images here are a few MB, which fits even the small window of devices that limit it.
  std::vector<vk::MemoryPropertyFlags> preferences;
  switch (use)
  {
    case MemoryUse::Device:
      preferences = { Flag::eDeviceLocal, {} };
      break;
    case MemoryUse::Upload:
      preferences = { host | Flag::eDeviceLocal, host };
      break;
    case MemoryUse::Download:
      preferences = { host | Flag::eHostCached, host };
      break;
  }
  for (const vk::MemoryPropertyFlags preference : preferences)
  {
    if (const auto type = device.FindMemoryType(typeBits, preference))
    {
      return *type;
    }
  }
  throw DeviceError("Vulkan: " + device.Name() + " has no memory of the kind needed");
}
}

Buffer::Buffer(const VulkanDevice& device, vk::DeviceSize bytes, vk::BufferUsageFlags usage,
  MemoryUse use)
  : Size(bytes)
{
  const bool addressed = static_cast<bool>(usage & vk::BufferUsageFlagBits::eShaderDeviceAddress);
  this->Object.emplace(device.Device(), vk::BufferCreateInfo({}, bytes, usage));
  const vk::MemoryRequirements requirements = this->Object->getMemoryRequirements();
  const vk::MemoryAllocateFlagsInfo flags(
    addressed ? vk::MemoryAllocateFlagBits::eDeviceAddress : vk::MemoryAllocateFlags());
  const vk::MemoryAllocateInfo info(requirements.size,
    ChooseMemoryType(device, requirements.memoryTypeBits, use), &flags);
  this->Memory.emplace(device.Device(), info);
  this->Object->bindMemory(**this->Memory, 0);
  if (addressed)
  {
    this->DeviceAddress =
      device.Device().getBufferAddress(vk::BufferDeviceAddressInfo(**this->Object));
  }
  if (use != MemoryUse::Device)
  {
    this->Mapped = this->Memory->mapMemory(0, VK_WHOLE_SIZE);
  }
}

bool Reserve(Buffer& buffer, const VulkanDevice& device, vk::DeviceSize bytes,
  vk::BufferUsageFlags usage, MemoryUse use)
{
  const vk::DeviceSize wanted = std::max<vk::DeviceSize>(bytes, 16);
  if (buffer.Bytes() >= wanted)
  {
    return false;
  }
  buffer = Buffer(); // frees the old memory before the new is asked for
  buffer = Buffer(device, wanted, usage, use);
  return true;
}
}
