// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ShaderBindings_h
#define mammoray_ShaderBindings_h

#include "Private/Buffer.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace mammoray
{
/// A shader from its SPIR-V words.
template <std::size_t Count>
vk::raii::ShaderModule MakeShader(const VulkanDevice& device, const std::uint32_t (&words)[Count])
{
  return vk::raii::ShaderModule(device.Device(),
    vk::ShaderModuleCreateInfo({}, sizeof(words), words));
}

/// Records a dispatch of workgroups of `groupSize`, in rows of at most 32768: a single row would be
/// too long for some devices.
void Dispatch(const vk::raii::CommandBuffer& commands, std::uint64_t invocations,
  std::uint32_t groupSize);

/// The pipeline layout of some shaders, and their buffers: one descriptor set, set 0.
class ShaderBindings
{
public:
  struct Description
  {
    vk::ShaderStageFlags Stages;
    /// Bindings 0 to Count - 1 are storage buffers.
    std::uint32_t Count = 0;
    /// Binding of an acceleration structure, if there is one.
    std::optional<std::uint32_t> Scene;
    /// Size of the push constants.
    std::uint32_t ConstantBytes = 0;
  };

  ShaderBindings(const VulkanDevice& device, const Description& description);

  vk::PipelineLayout Layout() const { return *this->PipelineLayout; }
  /// Binds all of buffers[n] to binding n; null at that of the acceleration structure. The device
  /// must be idle.
  void Update(std::span<const Buffer* const> buffers, vk::AccelerationStructureKHR scene = {});
  /// Records the binding of the buffers.
  void Bind(const vk::raii::CommandBuffer& commands, vk::PipelineBindPoint point) const;

private:
  const VulkanDevice& Device;
  vk::raii::DescriptorSetLayout SetLayout;
  vk::raii::PipelineLayout PipelineLayout;
  vk::raii::DescriptorPool Pool;
  vk::raii::DescriptorSet Set;
};
}

#endif
