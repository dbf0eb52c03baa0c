// SPDX-License-Identifier: Apache-2.0
// A Vulkan layer that lets one call fail, as a lost device or a full one would: MAMMORAY_FAULT is
// "submit N" (the Nth vkQueueSubmit and all later ones: VK_ERROR_DEVICE_LOST) or "memory N" (the
// Nth vkAllocateMemory and all later ones: VK_ERROR_OUT_OF_DEVICE_MEMORY). Loaded by the loader
// (VK_ADD_LAYER_PATH or VK_LAYER_PATH, VK_INSTANCE_LAYERS=VK_LAYER_MAMMORAY_fault).
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <string>

namespace
{
// Programs under test make one instance and one device at a time.
PFN_vkGetInstanceProcAddr NextInstanceProcAddr = nullptr;
PFN_vkGetDeviceProcAddr NextDeviceProcAddr = nullptr;
PFN_vkQueueSubmit NextQueueSubmit = nullptr;
PFN_vkAllocateMemory NextAllocateMemory = nullptr;
VkInstance Instance = VK_NULL_HANDLE;

/// Whether this call is to fail.
bool IsDue(const std::string& kind, std::atomic<long>& calls)
{
  const char* const text = std::getenv("MAMMORAY_FAULT");
  const std::string wanted = text ? text : "";
  if (wanted.compare(0, kind.size() + 1, kind + " ") != 0)
  {
    return false;
  }
  return ++calls >= std::atol(wanted.c_str() + kind.size() + 1);
}

VKAPI_ATTR VkResult VKAPI_CALL QueueSubmit(VkQueue queue, std::uint32_t count,
  const VkSubmitInfo* infos, VkFence fence)
{
  static std::atomic<long> calls{ 0 };
  return IsDue("submit", calls) ? VK_ERROR_DEVICE_LOST
                                : NextQueueSubmit(queue, count, infos, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL AllocateMemory(VkDevice device, const VkMemoryAllocateInfo* info,
  const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory)
{
  static std::atomic<long> calls{ 0 };
  return IsDue("memory", calls) ? VK_ERROR_OUT_OF_DEVICE_MEMORY
                                : NextAllocateMemory(device, info, callbacks, memory);
}

/// The link to the next layer that the loader put into the chain of a create call.
template <typename Link, typename Info>
Link* LinkOf(const Info* info, VkStructureType type)
{
  auto* link = const_cast<Link*>(reinterpret_cast<const Link*>(info->pNext));
  while (link && (link->sType != type || link->function != VK_LAYER_LINK_INFO))
  {
    link = const_cast<Link*>(reinterpret_cast<const Link*>(link->pNext));
  }
  return link;
}

VKAPI_ATTR VkResult VKAPI_CALL CreateInstance(const VkInstanceCreateInfo* info,
  const VkAllocationCallbacks* callbacks, VkInstance* instance)
{
  auto* const link =
    LinkOf<VkLayerInstanceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (!link)
  {
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  NextInstanceProcAddr = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(
    NextInstanceProcAddr(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, callbacks, instance);
  Instance = *instance;
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL CreateDevice(VkPhysicalDevice physical,
  const VkDeviceCreateInfo* info, const VkAllocationCallbacks* callbacks, VkDevice* device)
{
  auto* const link =
    LinkOf<VkLayerDeviceCreateInfo>(info, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (!link)
  {
    return VK_ERROR_INITIALIZATION_FAILED;
  }
  const auto nextInstance = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  NextDeviceProcAddr = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create =
    reinterpret_cast<PFN_vkCreateDevice>(nextInstance(Instance, "vkCreateDevice"));
  const VkResult result = create(physical, info, callbacks, device);
  if (result == VK_SUCCESS)
  {
    NextQueueSubmit =
      reinterpret_cast<PFN_vkQueueSubmit>(NextDeviceProcAddr(*device, "vkQueueSubmit"));
    NextAllocateMemory =
      reinterpret_cast<PFN_vkAllocateMemory>(NextDeviceProcAddr(*device, "vkAllocateMemory"));
  }
  return result;
}

template <typename Function>
PFN_vkVoidFunction Erased(Function function)
{
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}
}

extern "C"
{
  VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL faultGetDeviceProcAddr(VkDevice device, const char* name)
  {
    return std::strcmp(name, "vkGetDeviceProcAddr") == 0 ? Erased(faultGetDeviceProcAddr)
      : std::strcmp(name, "vkQueueSubmit") == 0          ? Erased(QueueSubmit)
      : std::strcmp(name, "vkAllocateMemory") == 0       ? Erased(AllocateMemory)
                                                         : NextDeviceProcAddr(device, name);
  }

  VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL faultGetInstanceProcAddr(VkInstance instance,
    const char* name)
  {
    return std::strcmp(name, "vkGetInstanceProcAddr") == 0 ? Erased(faultGetInstanceProcAddr)
      : std::strcmp(name, "vkGetDeviceProcAddr") == 0      ? Erased(faultGetDeviceProcAddr)
      : std::strcmp(name, "vkCreateInstance") == 0         ? Erased(CreateInstance)
      : std::strcmp(name, "vkCreateDevice") == 0           ? Erased(CreateDevice)
      : std::strcmp(name, "vkQueueSubmit") == 0            ? Erased(QueueSubmit)
      : std::strcmp(name, "vkAllocateMemory") == 0         ? Erased(AllocateMemory)
      : NextInstanceProcAddr                               ? NextInstanceProcAddr(instance, name)
                                                           : nullptr;
  }

  VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(
    VkNegotiateLayerInterface* negotiated)
  {
    negotiated->loaderLayerInterfaceVersion = 2;
    negotiated->pfnGetInstanceProcAddr = faultGetInstanceProcAddr;
    negotiated->pfnGetDeviceProcAddr = faultGetDeviceProcAddr;
    negotiated->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
  }
}
