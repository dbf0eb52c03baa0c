// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VulkanInstance_h
#define mammoray_VulkanInstance_h

#include "Private/Vulkan.h"

#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * The process's Vulkan instance: one for all devices, kept to the end. Making it loads the drivers,
 * which takes a tenth of a second, and a driver that is loaded again and again loses something each
 * time: NVIDIA's 580 cannot be loaded any more after some two hundred times. Thread-safe.
 */
class VulkanInstance
{
public:
  /// The instance with or without the Khronos validation layer, created at first use. Throws
  /// DeviceError if there is no loader, driver or layer; the next call tries again.
  static VulkanInstance& Get(bool validation);

  const vk::raii::Instance& Handle() const { return *this->Instance; }
  /// The first message of the validation layer since the last call; empty if there is none.
  std::string TakeMessage();

private:
  explicit VulkanInstance(bool validation);
  static VKAPI_ATTR VkBool32 VKAPI_CALL OnMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
    VkDebugUtilsMessageTypeFlagsEXT, const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

  vk::raii::Context Context;
  std::mutex Mutex;
  std::vector<std::string> Messages;
  std::optional<vk::raii::Instance> Instance;
  std::optional<vk::raii::DebugUtilsMessengerEXT> Messenger;
};

/**
 * Mesa's software device keeps its memory in one file without a name, and its drivers their caches
 * in mapped ones: where the system does not let a file grow (RLIMIT_FSIZE, ulimit -f), the process
 * ends by SIGBUS at the first access. Throws DeviceError where the limit leaves no room for so much
 * memory of that device, as pieces that come and go may need up to twice as much.
 */
void CheckFileSizeLimit(vk::DeviceSize bytes);

/// Message if the loader finds no device.
inline constexpr const char* NoDevice =
  "no Vulkan: the loader found no driver for any device (Debian: mesa-vulkan-drivers)";
}

#endif
