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

/// A buffer with its memory, which is mapped if the host uses it. The default is empty.
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
  std::shared_ptr<void> Share; // of the memory that the process uses on a software device
  std::optional<vk::raii::DeviceMemory> Memory;
  std::optional<vk::raii::Buffer> Object;
  vk::DeviceSize Size = 0;
  vk::DeviceAddress DeviceAddress = 0;
  void* Mapped = nullptr;
};

/// Enlarges the buffer to `bytes` if it is smaller, which loses its contents. Returns true if it
/// did.
bool Reserve(Buffer& buffer, const VulkanDevice& device, vk::DeviceSize bytes,
  vk::BufferUsageFlags usage, MemoryUse use);

/// A buffer that shaders write and the host reads. On a discrete device it stays in the device's
/// memory until it is fetched; otherwise host and device share the memory and fetching costs
/// nothing.
class ResultBuffer
{
public:
  /// Consecutive bytes.
  struct Range
  {
    vk::DeviceSize Begin = 0;
    vk::DeviceSize Count = 0;
  };

  /// Like mammoray::Reserve, for a storage buffer.
  bool Reserve(const VulkanDevice& device, vk::DeviceSize bytes);
  const Buffer& OnDevice() const { return this->Written; }
  /// Copies these bytes to the host, where Data has them. Ranges must not overlap.
  void Fetch(VulkanDevice& device, const std::vector<Range>& ranges);
  /// The bytes that were fetched; others are undefined.
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
