// SPDX-License-Identifier: Apache-2.0
#include "Private/VulkanInstance.h"

#include "mammoray/XRay/PathLengthProjector.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace mammoray
{
namespace
{
constexpr const char* ValidationLayer = "VK_LAYER_KHRONOS_validation";

vk::raii::Context OpenLoader()
{
  CheckFileSizeLimit(0);
  try
  {
    return vk::raii::Context();
  }
  catch (const std::exception&)
  {
    throw DeviceError("no Vulkan: the loader (libvulkan.so.1) cannot be opened");
  }
}

vk::raii::Instance MakeInstance(const vk::raii::Context& context, bool validation)
{
  const vk::ApplicationInfo application("mammoray", 1, "mammoray", 1, VK_API_VERSION_1_2);
  std::vector<const char*> layers;
  std::vector<const char*> extensions;
  if (validation)
  {
    const auto available = context.enumerateInstanceLayerProperties();
    if (std::none_of(available.begin(), available.end(),
          [](const vk::LayerProperties& layer)
          { return std::strcmp(layer.layerName, ValidationLayer) == 0; }))
    {
      throw DeviceError(std::string("Vulkan: validation was asked for, but there is no layer ") +
        ValidationLayer + " (Debian: vulkan-validationlayers)");
    }
    layers.push_back(ValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  }
  const vk::ValidationFeatureEnableEXT synchronization =
    vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
  const vk::ValidationFeaturesEXT features(synchronization);
  vk::InstanceCreateInfo info({}, &application, layers, extensions);
  info.pNext = validation ? &features : nullptr;
  try
  {
    return vk::raii::Instance(context, info);
  }
  catch (const vk::IncompatibleDriverError&)
  {
    throw DeviceError(NoDevice);
  }
}
}

void CheckFileSizeLimit(vk::DeviceSize bytes)
{
  // The index of Mesa's cache of shaders has 1.3 MB; what pipelines and their sets take is less.
  constexpr vk::DeviceSize ofDrivers = vk::DeviceSize{ 16 } << 20;
  rlimit limit{};
  const vk::DeviceSize least = ofDrivers + 2 * bytes;
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
    limit.rlim_cur < least)
  {
    throw DeviceError("Vulkan: expected at least " + std::to_string((least + 1023) >> 10) +
      " KiB of file size (ulimit -f), where drivers keep memory, found " +
      std::to_string(limit.rlim_cur >> 10));
  }
}

VulkanInstance& VulkanInstance::Get(bool validation)
{
  // Not destroyed at the process's end: the drivers' own libraries may have gone before.
  if (validation)
  {
    static VulkanInstance* const validated = new VulkanInstance(true);
    return *validated;
  }
  static VulkanInstance* const plain = new VulkanInstance(false);
  return *plain;
}

VulkanInstance::VulkanInstance(bool validation)
  : Context(OpenLoader())
  , Instance(MakeInstance(this->Context, validation))
{
  if (validation)
  {
    // Vulkan's own struct: the type of the callback in vk's changed with its version.
    const VkDebugUtilsMessengerCreateInfoEXT info{
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT, nullptr, 0,
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT |
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT,
      VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
        VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT,
      OnMessage, this
    };
    this->Messenger.emplace(*this->Instance, info);
  }
}

VKAPI_ATTR VkBool32 VKAPI_CALL VulkanInstance::OnMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
  VkDebugUtilsMessageTypeFlagsEXT, const VkDebugUtilsMessengerCallbackDataEXT* data, void* self)
{
  try
  {
    auto* instance = static_cast<VulkanInstance*>(self);
    const std::lock_guard lock(instance->Mutex);
    instance->Messages.emplace_back(data->pMessage);
  }
  catch (...) // must not cross the driver; the message is lost, the call goes on
  {
  }
  return VK_FALSE;
}

std::string VulkanInstance::TakeMessage()
{
  const std::lock_guard lock(this->Mutex);
  const std::vector<std::string> messages = std::exchange(this->Messages, {});
  return messages.empty() ? std::string() : messages.front();
}
}
