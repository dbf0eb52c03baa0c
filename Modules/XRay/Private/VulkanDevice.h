// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VulkanDevice_h
#define mammoray_VulkanDevice_h

#include "mammoray/XRay/PathLengthProjector.h"

#include "Private/Vulkan.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// Calls a function and turns exceptions of Vulkan-Hpp into DeviceErrors with the VkResult's name.
template <typename Function>
auto WithDeviceErrors(const Function& function)
{
  try
  {
    return function();
  }
  catch (const vk::SystemError& error)
  {
    const auto result = static_cast<vk::Result>(error.code().value());
    const std::string name = "VK_" +
      [&]
    {
      // "ErrorOutOfDeviceMemory" -> "ERROR_OUT_OF_DEVICE_MEMORY"
      std::string text;
      for (const char letter : vk::to_string(result))
      {
        if (letter >= 'A' && letter <= 'Z' && !text.empty())
        {
          text += '_';
        }
        text += static_cast<char>(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
      }
      return text;
    }();
    throw DeviceError("Vulkan: " + std::string(error.what()) + " (" + name + ")");
  }
}

class VulkanInstance;

/**
 * One device of this process's Vulkan instance, able to do what the options ask for, and one queue.
 * Members are declared in creation order. Not copied, not moved: the other types keep references to
 * it.
 */
class VulkanDevice
{
public:
  explicit VulkanDevice(const ProjectorOptions& options);
  VulkanDevice(const VulkanDevice&) = delete;
  VulkanDevice& operator=(const VulkanDevice&) = delete;

  const vk::raii::Device& Device() const { return *this->LogicalDevice; }
  const std::string& Name() const { return this->DeviceName; }
  /// True when shaders may use 64-bit floats.
  bool HasDoubles() const { return this->Doubles; }
  /// True when shaders may add 64-bit integers in buffers atomically.
  bool HasLongAtomics() const { return this->LongAtomics; }
  /// True if the device is a CPU with a software driver.
  bool IsSoftware() const { return this->Software; }
  /// True if the host reads the device's memory directly; false on discrete devices. The
  /// environment variable MAMMORAY_SEPARATE_MEMORY makes it false, for tests.
  bool SharesMemory() const { return this->Sharing; }
  /// True if the device supports ray tracing and the options select it.
  bool TracesRays() const { return this->ForRayTracing; }
  const vk::PhysicalDeviceRayTracingPipelinePropertiesKHR& RayTracingProperties() const
  {
    return this->RayTracing;
  }
  const vk::PhysicalDeviceAccelerationStructurePropertiesKHR& StructureProperties() const
  {
    return this->Structure;
  }
  const vk::PhysicalDeviceLimits& Limits() const { return this->DeviceLimits; }

  /// Index of the first memory type among `typeBits` with all of the properties; empty if none has.
  vk::MemoryPropertyFlags MemoryFlags(std::uint32_t type) const
  {
    return this->Memory.memoryTypes[type].propertyFlags;
  }
  std::optional<std::uint32_t> FindMemoryType(std::uint32_t typeBits,
    vk::MemoryPropertyFlags properties) const;

  /// Records commands, submits them and waits. Throws DeviceError, also for validation messages.
  void Run(const std::function<void(const vk::raii::CommandBuffer&)>& record);
  /// Throws DeviceError with the first message of the validation layer, if there was one: one of
  /// this device or of another of the process.
  void CheckValidation();

private:
  void ChooseDevice(const std::string& wanted, ProjectorOptions::Method method);
  void MakeDevice();

  VulkanInstance& Instance;
  std::optional<vk::raii::PhysicalDevice> PhysicalDevice;
  std::string DeviceName;
  bool Doubles = false;
  bool LongAtomics = false;
  bool Software = false;
  bool Sharing = true;
  bool ForRayTracing = false;
  std::uint32_t QueueFamily = 0;
  vk::PhysicalDeviceLimits DeviceLimits;
  vk::PhysicalDeviceMemoryProperties Memory;
  vk::PhysicalDeviceRayTracingPipelinePropertiesKHR RayTracing;
  vk::PhysicalDeviceAccelerationStructurePropertiesKHR Structure;
  std::optional<vk::raii::Device> LogicalDevice;
  std::optional<vk::raii::Queue> Queue;
  std::optional<vk::raii::CommandPool> Pool;
  std::optional<vk::raii::CommandBuffer> Commands;
  std::optional<vk::raii::Fence> Done;
};
}

#endif
