// SPDX-License-Identifier: Apache-2.0
#include "Private/Buffer.h"

#include "Private/VulkanInstance.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace mammoray
{
namespace
{
/// Suitable memory types, best first.
std::vector<std::uint32_t> MemoryTypes(const VulkanDevice& device, std::uint32_t typeBits,
  MemoryUse use)
{
  using Flag = vk::MemoryPropertyFlagBits;
  const vk::MemoryPropertyFlags host = Flag::eHostVisible | Flag::eHostCoherent;
  // Memory that is local to the device and visible to the host spares a copy.
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
    case MemoryUse::Result:
      preferences = { host | Flag::eHostCached | Flag::eDeviceLocal, Flag::eDeviceLocal, {} };
      break;
  }
  std::vector<std::uint32_t> types;
  for (const vk::MemoryPropertyFlags preference : preferences)
  {
    const auto type = device.FindMemoryType(typeBits, preference);
    if (type && std::find(types.begin(), types.end(), *type) == types.end())
    {
      types.push_back(*type);
    }
  }
  if (types.empty())
  {
    throw DeviceError("Vulkan: " + device.Name() + " has no memory of the kind needed");
  }
  return types;
}

struct Allocation
{
  vk::raii::DeviceMemory Memory;
  std::uint32_t Type = 0;
};

/// Allocates from the best type that has room: many devices let the host access only 256 MiB of
/// theirs.
Allocation Allocate(const VulkanDevice& device, const vk::MemoryRequirements& requirements,
  MemoryUse use, bool addressed)
{
  const vk::MemoryAllocateFlagsInfo flags(
    addressed ? vk::MemoryAllocateFlagBits::eDeviceAddress : vk::MemoryAllocateFlags());
  const std::vector<std::uint32_t> types = MemoryTypes(device, requirements.memoryTypeBits, use);
  const auto allocate = [&](std::uint32_t type)
  {
    return Allocation{ vk::raii::DeviceMemory(device.Device(),
                         vk::MemoryAllocateInfo(requirements.size, type, &flags)),
      type };
  };
  for (auto type = types.begin(); type + 1 != types.end(); ++type)
  {
    try
    {
      return allocate(*type);
    }
    catch (const vk::OutOfDeviceMemoryError&) // the next one may have room
    {
    }
  }
  return allocate(types.back());
}

/// Counts memory of the software device until the share is destroyed. Throws DeviceError if the
/// limit on file sizes leaves too little.
std::shared_ptr<void> ShareOfMemory(vk::DeviceSize bytes)
{
  static std::atomic<vk::DeviceSize> all = 0;
  all += bytes;
  std::shared_ptr<void> share(&all, [bytes](void*) { all -= bytes; });
  CheckFileSizeLimit(all);
  return share;
}

/// True if the host maps memory of this type.
bool IsMapped(const VulkanDevice& device, vk::MemoryPropertyFlags type, MemoryUse use)
{
  using Flag = vk::MemoryPropertyFlagBits;
  const vk::MemoryPropertyFlags shared =
    Flag::eHostVisible | Flag::eHostCoherent | Flag::eHostCached;
  return use == MemoryUse::Result ? device.SharesMemory() && (type & shared) == shared
                                  : use != MemoryUse::Device;
}
}

Buffer::Buffer(const VulkanDevice& device, vk::DeviceSize bytes, vk::BufferUsageFlags usage,
  MemoryUse use)
  : Size(bytes)
{
  const bool addressed = static_cast<bool>(usage & vk::BufferUsageFlagBits::eShaderDeviceAddress);
  this->Object.emplace(device.Device(), vk::BufferCreateInfo({}, bytes, usage));
  const vk::MemoryRequirements requirements = this->Object->getMemoryRequirements();
  if (device.IsSoftware())
  {
    this->Share = ShareOfMemory(requirements.size);
  }
  Allocation allocation = Allocate(device, requirements, use, addressed);
  this->Memory.emplace(std::move(allocation.Memory));
  this->Object->bindMemory(**this->Memory, 0);
  if (addressed)
  {
    this->DeviceAddress =
      device.Device().getBufferAddress(vk::BufferDeviceAddressInfo(**this->Object));
  }
  if (IsMapped(device, device.MemoryFlags(allocation.Type), use))
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

bool ResultBuffer::Reserve(const VulkanDevice& device, vk::DeviceSize bytes)
{
  using Usage = vk::BufferUsageFlagBits;
  return mammoray::Reserve(this->Written, device, bytes,
    Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst, MemoryUse::Result);
}

void ResultBuffer::Fetch(VulkanDevice& device, const std::vector<Range>& ranges)
{
  if (this->Written.Data<char>())
  {
    return;
  }
  mammoray::Reserve(this->Copy, device, this->Written.Bytes(),
    vk::BufferUsageFlagBits::eTransferDst, MemoryUse::Download);
  std::vector<vk::BufferCopy> copies;
  copies.reserve(ranges.size());
  for (const Range& range : ranges)
  {
    if (range.Count > 0)
    {
      copies.emplace_back(range.Begin, range.Begin, range.Count);
    }
  }
  if (copies.empty())
  {
    return;
  }
  device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      using Stage = vk::PipelineStageFlagBits;
      using Access = vk::AccessFlagBits;
      commands.copyBuffer(this->Written.Handle(), this->Copy.Handle(), copies);
      const vk::MemoryBarrier copied(Access::eTransferWrite, Access::eHostRead);
      commands.pipelineBarrier(Stage::eTransfer, Stage::eHost, {}, copied, nullptr, nullptr);
    });
}
}
