// SPDX-License-Identifier: Apache-2.0
#include "Private/ShaderBindings.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
using Description = ShaderBindings::Description;
using Type = vk::DescriptorType;

vk::raii::DescriptorSetLayout MakeSetLayout(const VulkanDevice& device, const Description& wanted)
{
  std::vector<vk::DescriptorSetLayoutBinding> bindings;
  for (std::uint32_t binding = 0; binding < wanted.Count; ++binding)
  {
    bindings.emplace_back(binding,
      binding == wanted.Scene ? Type::eAccelerationStructureKHR : Type::eStorageBuffer, 1,
      wanted.Stages);
  }
  return { device.Device(), vk::DescriptorSetLayoutCreateInfo({}, bindings) };
}

vk::raii::PipelineLayout MakePipelineLayout(const VulkanDevice& device, const Description& wanted,
  const vk::DescriptorSetLayout& set)
{
  vk::PipelineLayoutCreateInfo info({}, set);
  const vk::PushConstantRange constants(wanted.Stages, 0, wanted.ConstantBytes);
  if (wanted.ConstantBytes > 0)
  {
    info.setPushConstantRanges(constants);
  }
  return { device.Device(), info };
}

vk::raii::DescriptorPool MakePool(const VulkanDevice& device, const Description& wanted)
{
  const std::uint32_t scenes = wanted.Scene ? 1 : 0;
  std::vector<vk::DescriptorPoolSize> sizes{ { Type::eStorageBuffer, wanted.Count - scenes } };
  if (wanted.Scene)
  {
    sizes.emplace_back(Type::eAccelerationStructureKHR, scenes);
  }
  return { device.Device(),
    vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, sizes) };
}

vk::raii::DescriptorSet MakeSet(const VulkanDevice& device, const vk::DescriptorPool& pool,
  const vk::DescriptorSetLayout& layout)
{
  vk::raii::DescriptorSets sets(device.Device(), vk::DescriptorSetAllocateInfo(pool, layout));
  return std::move(sets.front());
}
}

void Dispatch(const vk::raii::CommandBuffer& commands, std::uint64_t invocations,
  std::uint32_t groupSize)
{
  constexpr std::uint64_t groupsPerRow = 32768;
  const std::uint64_t groups = (invocations + groupSize - 1) / groupSize;
  const std::uint64_t rows = (groups + groupsPerRow - 1) / groupsPerRow;
  commands.dispatch(static_cast<std::uint32_t>(std::min(groups, groupsPerRow)),
    static_cast<std::uint32_t>(rows), 1);
}

ShaderBindings::ShaderBindings(const VulkanDevice& device, const Description& description)
  : Device(device)
  , SetLayout(MakeSetLayout(device, description))
  , PipelineLayout(MakePipelineLayout(device, description, *this->SetLayout))
  , Pool(MakePool(device, description))
  , Set(MakeSet(device, *this->Pool, *this->SetLayout))
{
}

void ShaderBindings::Update(std::span<const Buffer* const> buffers,
  vk::AccelerationStructureKHR scene)
{
  const vk::WriteDescriptorSetAccelerationStructureKHR sceneInfo(scene);
  std::vector<vk::DescriptorBufferInfo> infos(buffers.size());
  std::vector<vk::WriteDescriptorSet> writes;
  for (std::uint32_t binding = 0; binding < buffers.size(); ++binding)
  {
    vk::WriteDescriptorSet write(*this->Set, binding, 0, 1, Type::eStorageBuffer);
    if (buffers[binding])
    {
      infos[binding] = vk::DescriptorBufferInfo(buffers[binding]->Handle(), 0, VK_WHOLE_SIZE);
      write.pBufferInfo = &infos[binding];
    }
    else
    {
      write.descriptorType = Type::eAccelerationStructureKHR;
      write.pNext = &sceneInfo;
    }
    writes.push_back(write);
  }
  this->Device.Device().updateDescriptorSets(writes, nullptr);
}

void ShaderBindings::Bind(const vk::raii::CommandBuffer& commands,
  vk::PipelineBindPoint point) const
{
  commands.bindDescriptorSets(point, *this->PipelineLayout, 0, *this->Set, nullptr);
}
}
