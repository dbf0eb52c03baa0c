// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Buffer_h
#define mammoray_Buffer_h

#include "Private/VulkanDevice.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace mammoray
{
enum class MemoryUse
{
  Device,   ///< only the device touches it
  Upload,   ///< the host writes, the device reads
  Download, ///< the device writes a little, the host reads it
  Result,   ///< the device writes; the host reads it where that is as fast as its own memory
};

/// A buffer with its memory, mapped where the host uses it. Empty when made without arguments.
class Buffer
{
public:
  Buffer() = default;
  Buffer(const VulkanDevice& device, vk::DeviceSize bytes, vk::BufferUsageFlags usage,
    MemoryUse use);

  vk::DeviceSize Bytes() const { return this->Size; }
  vk::Buffer Handle() const { return **this->Object; }
  vk::DeviceAddress Address() const { return this->DeviceAddress; }
  /// The mapped memory; coherent. Null for MemoryUse::Device, and for MemoryUse::Result where the
  /// device's memory is not the host's.
  template <typename T>
  T* Data() const
  {
    return static_cast<T*>(this->Mapped);
  }

private:
  std::shared_ptr<void> Share; // in what the process has of the software device
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

/// What shaders write and the host may ask for. On a discrete device it stays in that device's own
/// memory until it is fetched; elsewhere host and device see the same memory and fetching is free.
class ResultBuffer
{
public:
  /// Consecutive bytes.
  struct Range
  {
    vk::DeviceSize Begin = 0;
    vk::DeviceSize Count = 0;
  };

  /// As mammoray::Reserve, for a storage buffer.
  bool Reserve(const VulkanDevice& device, vk::DeviceSize bytes);
  const Buffer& OnDevice() const { return this->Written; }
  /// Makes these bytes of what the device has written, none where two ranges overlap, those of
  /// Data.
  void Fetch(VulkanDevice& device, const std::vector<Range>& ranges);
  /// Holds what was fetched.
  template <typename T>
  const T* Data() const
  {
    const T* own = this->Written.Data<T>();
    return own ? own : this->Copy.Data<T>();
  }

private:
  Buffer Written;
  Buffer Copy;
};
}

#endif
