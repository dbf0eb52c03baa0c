// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Buffer_h
#define mammoray_Buffer_h

#include "Private/VulkanDevice.h"

#include <cstddef>

namespace mammoray
{
enum class MemoryUse
{
  Device,   ///< only the device touches it
  Upload,   ///< the host writes, the device reads
  Download, ///< the device writes, the host reads
};

/// A buffer with its memory, mapped unless only the device uses it. Empty when made without
/// arguments.
class Buffer
{
public:
  Buffer() = default;
  Buffer(const VulkanDevice& device, vk::DeviceSize bytes, vk::BufferUsageFlags usage,
    MemoryUse use);

  vk::DeviceSize Bytes() const { return this->Size; }
  vk::Buffer Handle() const { return **this->Object; }
  vk::DeviceAddress Address() const { return this->DeviceAddress; }
  /// The mapped memory; coherent. Null for MemoryUse::Device.
  template <typename T>
  T* Data() const
  {
    return static_cast<T*>(this->Mapped);
  }

private:
  std::optional<vk::raii::DeviceMemory> Memory;
  std::optional<vk::raii::Buffer> Object;
  vk::DeviceSize Size = 0;
  vk::DeviceAddress DeviceAddress = 0;
  void* Mapped = nullptr;
};

/// Makes the buffer at least `bytes` large, for new contents; keeps it when it is. True when it was
/// made.
bool Reserve(Buffer& buffer, const VulkanDevice& device, vk::DeviceSize bytes,
  vk::BufferUsageFlags usage, MemoryUse use);
}

#endif
