// SPDX-License-Identifier: Apache-2.0
#include "Private/VulkanDevice.h"

#include "Private/VulkanInstance.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>

namespace mammoray
{
namespace
{
constexpr std::array<const char*, 3> RequiredExtensions{
  VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
  VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
  VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
};

std::vector<vk::raii::PhysicalDevice> Devices(const vk::raii::Instance& instance)
{
  try
  {
    return vk::raii::PhysicalDevices(instance);
  }
  catch (const vk::InitializationFailedError&) // what the loader answers without a usable driver
  {
    return {};
  }
}

bool CanTraceRays(const vk::raii::PhysicalDevice& device)
{
  if (device.getProperties().apiVersion < VK_API_VERSION_1_2)
  {
    return false;
  }
  const auto extensions = device.enumerateDeviceExtensionProperties();
  for (const char* required : RequiredExtensions)
  {
    if (std::none_of(extensions.begin(), extensions.end(),
          [&](const vk::ExtensionProperties& extension)
          { return std::strcmp(extension.extensionName, required) == 0; }))
    {
      return false;
    }
  }
  const auto features = device.getFeatures2<vk::PhysicalDeviceFeatures2,
    vk::PhysicalDeviceVulkan12Features, vk::PhysicalDeviceAccelerationStructureFeaturesKHR,
    vk::PhysicalDeviceRayTracingPipelineFeaturesKHR>();
  return features.get<vk::PhysicalDeviceVulkan12Features>().bufferDeviceAddress &&
    features.get<vk::PhysicalDeviceAccelerationStructureFeaturesKHR>().accelerationStructure &&
    features.get<vk::PhysicalDeviceRayTracingPipelineFeaturesKHR>().rayTracingPipeline;
}

/// Most capable first: the kind of device, then ray tracing.
int Rank(const vk::raii::PhysicalDevice& device)
{
  int kind = 0;
  switch (device.getProperties().deviceType)
  {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      kind = 4;
      break;
    case vk::PhysicalDeviceType::eIntegratedGpu:
      kind = 3;
      break;
    case vk::PhysicalDeviceType::eVirtualGpu:
      kind = 2;
      break;
    case vk::PhysicalDeviceType::eCpu:
      kind = 1;
      break;
    default:
      break;
  }
  return 2 * kind + (CanTraceRays(device) ? 1 : 0);
}

std::string TypeName(vk::PhysicalDeviceType type)
{
  switch (type)
  {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return "discrete GPU";
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return "integrated GPU";
    case vk::PhysicalDeviceType::eVirtualGpu:
      return "virtual GPU";
    case vk::PhysicalDeviceType::eCpu:
      return "CPU";
    default:
      return "other";
  }
}

std::string LowerCase(std::string text)
{
  for (char& letter : text)
  {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return text;
}

std::vector<vk::raii::PhysicalDevice> RankedDevices(const vk::raii::Instance& instance)
{
  std::vector<vk::raii::PhysicalDevice> devices = Devices(instance);
  std::vector<std::pair<int, std::size_t>> order;
  for (std::size_t index = 0; index < devices.size(); ++index)
  {
    order.emplace_back(-Rank(devices[index]), index);
  }
  std::sort(order.begin(), order.end());
  std::vector<vk::raii::PhysicalDevice> ranked;
  ranked.reserve(order.size());
  for (const auto& [rank, index] : order)
  {
    ranked.push_back(std::move(devices[index]));
  }
  return ranked;
}

std::string WantedDevice(const ProjectorOptions& options)
{
  const char* variable = std::getenv("MAMMORAY_DEVICE");
  return options.Device.empty() && variable ? variable : options.Device;
}
}

std::vector<DeviceDescription> ListDevices(std::string* reason)
{
  std::vector<DeviceDescription> descriptions;
  try
  {
    WithDeviceErrors(
      [&]
      {
        for (const vk::raii::PhysicalDevice& device :
          RankedDevices(VulkanInstance::Get(false).Handle()))
        {
          const auto properties =
            device
              .getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
          const auto& general = properties.get<vk::PhysicalDeviceProperties2>().properties;
          const auto& driver = properties.get<vk::PhysicalDeviceDriverProperties>();
          DeviceDescription description;
          description.Name = general.deviceName.data();
          description.Driver =
            std::string(driver.driverName.data()) + " " + driver.driverInfo.data();
          description.Type = TypeName(general.deviceType);
          description.RayTracing = CanTraceRays(device);
          descriptions.push_back(description);
        }
      });
    if (descriptions.empty() && reason)
    {
      *reason = NoDevice;
    }
  }
  catch (const DeviceError& error)
  {
    descriptions.clear();
    if (reason)
    {
      *reason = error.what();
    }
  }
  return descriptions;
}

VulkanDevice::VulkanDevice(const ProjectorOptions& options)
#ifdef MAMMORAY_VULKAN_VALIDATION
  : Instance(VulkanInstance::Get(true))
#else
  : Instance(VulkanInstance::Get(options.Validation))
#endif
{
  this->ChooseDevice(WantedDevice(options), options.Projection);
  this->MakeDevice();
  this->CheckValidation();
}

void VulkanDevice::ChooseDevice(const std::string& wanted, ProjectorOptions::Method method)
{
  using Method = ProjectorOptions::Method;
  std::string found;
  for (vk::raii::PhysicalDevice& device : RankedDevices(this->Instance.Handle()))
  {
    const vk::PhysicalDeviceProperties properties = device.getProperties();
    const std::string name = properties.deviceName.data();
    const bool recent = properties.apiVersion >= VK_API_VERSION_1_2;
    const bool tracesRays = CanTraceRays(device);
    found += (found.empty() ? "" : ", ") + name +
      (!recent         ? " (older than Vulkan 1.2)"
          : tracesRays ? ""
                       : " (no ray tracing)");
    if (LowerCase(name).find(LowerCase(wanted)) != std::string::npos && recent &&
      (tracesRays || method != Method::RayTracing))
    {
      const bool isHardware = properties.deviceType != vk::PhysicalDeviceType::eCpu;
      this->ForRayTracing =
        tracesRays && (method == Method::RayTracing || (method == Method::Auto && isHardware));
      this->Software = !isHardware;
      this->Sharing = properties.deviceType != vk::PhysicalDeviceType::eDiscreteGpu &&
        !std::getenv("MAMMORAY_SEPARATE_MEMORY");
      this->PhysicalDevice = std::move(device);
      this->DeviceName = name;
      return;
    }
  }
  if (found.empty())
  {
    throw DeviceError(NoDevice);
  }
  throw DeviceError(std::string("Vulkan: expected a device ") +
    (method == Method::RayTracing ? "that traces rays (VK_KHR_ray_tracing_pipeline)"
                                  : "of Vulkan 1.2") +
    (wanted.empty() ? "" : " with '" + wanted + "' in its name") + ", found " + found);
}

void VulkanDevice::MakeDevice()
{
  this->DeviceLimits = this->PhysicalDevice->getProperties().limits;
  if (this->ForRayTracing)
  {
    const auto properties = this->PhysicalDevice->getProperties2<vk::PhysicalDeviceProperties2,
      vk::PhysicalDeviceRayTracingPipelinePropertiesKHR,
      vk::PhysicalDeviceAccelerationStructurePropertiesKHR>();
    this->RayTracing = properties.get<vk::PhysicalDeviceRayTracingPipelinePropertiesKHR>();
    this->Structure = properties.get<vk::PhysicalDeviceAccelerationStructurePropertiesKHR>();
  }
  this->Memory = this->PhysicalDevice->getMemoryProperties();
  const auto features =
    this->PhysicalDevice
      ->getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  const vk::PhysicalDeviceFeatures& general = features.get<vk::PhysicalDeviceFeatures2>().features;
  this->Doubles = general.shaderFloat64;
  this->LongAtomics = general.shaderInt64 &&
    features.get<vk::PhysicalDeviceVulkan12Features>().shaderBufferInt64Atomics;

  const auto families = this->PhysicalDevice->getQueueFamilyProperties();
  const auto family = std::find_if(families.begin(), families.end(),
    [](const vk::QueueFamilyProperties& candidate)
    { return static_cast<bool>(candidate.queueFlags & vk::QueueFlagBits::eCompute); });
  if (family == families.end())
  {
    throw DeviceError("Vulkan: " + this->DeviceName + " has no queue that computes");
  }
  this->QueueFamily = static_cast<std::uint32_t>(family - families.begin());

  const float priority = 1.0f;
  const vk::DeviceQueueCreateInfo queue({}, this->QueueFamily, 1, &priority);
  vk::StructureChain<vk::DeviceCreateInfo, vk::PhysicalDeviceFeatures2,
    vk::PhysicalDeviceVulkan12Features, vk::PhysicalDeviceAccelerationStructureFeaturesKHR,
    vk::PhysicalDeviceRayTracingPipelineFeaturesKHR>
    info;
  info.get<vk::DeviceCreateInfo>().setQueueCreateInfos(queue);
  info.get<vk::PhysicalDeviceFeatures2>().features.shaderFloat64 = this->Doubles;
  info.get<vk::PhysicalDeviceFeatures2>().features.shaderInt64 = this->LongAtomics;
  info.get<vk::PhysicalDeviceVulkan12Features>().shaderBufferInt64Atomics = this->LongAtomics;
  if (this->ForRayTracing)
  {
    info.get<vk::DeviceCreateInfo>().setPEnabledExtensionNames(RequiredExtensions);
    info.get<vk::PhysicalDeviceVulkan12Features>().bufferDeviceAddress = true;
    info.get<vk::PhysicalDeviceAccelerationStructureFeaturesKHR>().accelerationStructure = true;
    info.get<vk::PhysicalDeviceRayTracingPipelineFeaturesKHR>().rayTracingPipeline = true;
  }
  else
  {
    info.unlink<vk::PhysicalDeviceAccelerationStructureFeaturesKHR>();
    info.unlink<vk::PhysicalDeviceRayTracingPipelineFeaturesKHR>();
  }
  this->LogicalDevice.emplace(*this->PhysicalDevice, info.get<vk::DeviceCreateInfo>());
  this->Queue.emplace(*this->LogicalDevice, this->QueueFamily, 0);
  this->Pool.emplace(*this->LogicalDevice,
    vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
      this->QueueFamily));
  vk::raii::CommandBuffers buffers(*this->LogicalDevice,
    vk::CommandBufferAllocateInfo(**this->Pool, vk::CommandBufferLevel::ePrimary, 1));
  this->Commands.emplace(std::move(buffers.front()));
  this->Done.emplace(*this->LogicalDevice, vk::FenceCreateInfo());
}

std::optional<std::uint32_t> VulkanDevice::FindMemoryType(std::uint32_t typeBits,
  vk::MemoryPropertyFlags properties) const
{
  for (std::uint32_t type = 0; type < this->Memory.memoryTypeCount; ++type)
  {
    if ((typeBits >> type & 1u) != 0 &&
      (this->Memory.memoryTypes[type].propertyFlags & properties) == properties)
    {
      return type;
    }
  }
  return std::nullopt;
}

void VulkanDevice::Run(const std::function<void(const vk::raii::CommandBuffer&)>& record)
{
  this->Commands->begin({ vk::CommandBufferUsageFlagBits::eOneTimeSubmit });
  record(*this->Commands);
  this->Commands->end();
  const vk::CommandBuffer commands = **this->Commands;
  this->Queue->submit(vk::SubmitInfo({}, {}, commands), **this->Done);
  const vk::Result result = this->LogicalDevice->waitForFences(**this->Done, true, UINT64_MAX);
  if (result != vk::Result::eSuccess)
  {
    throw DeviceError(
      "Vulkan: waiting for " + this->DeviceName + " failed: " + vk::to_string(result));
  }
  this->LogicalDevice->resetFences(**this->Done);
  this->CheckValidation();
}

void VulkanDevice::CheckValidation()
{
  std::string message = this->Instance.TakeMessage();
  if (!message.empty())
  {
    std::replace(message.begin(), message.end(), '\n', ' ');
    throw DeviceError("Vulkan validation: " + message);
  }
}
}
