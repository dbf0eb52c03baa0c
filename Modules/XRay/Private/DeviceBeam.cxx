// SPDX-License-Identifier: Apache-2.0
#include "Private/DeviceBeam.h"

#include "BeamParameters.h"
#include "Private/ProjectionHelpers.h"
#include "beam.h"

#include <algorithm>
#include <array>

namespace mammoray
{
namespace
{
using Usage = vk::BufferUsageFlagBits;
constexpr std::uint32_t GroupsPerRow = 32768;
}

DeviceBeam::DeviceBeam(VulkanDevice& device)
  : Device(device)
{
  std::array<vk::DescriptorSetLayoutBinding, MAMMORAY_BEAM_BINDING_COUNT> bindings;
  for (std::uint32_t binding = 0; binding < bindings.size(); ++binding)
  {
    bindings[binding] = vk::DescriptorSetLayoutBinding(binding, vk::DescriptorType::eStorageBuffer,
      1, vk::ShaderStageFlagBits::eCompute);
  }
  const vk::raii::Device& logical = device.Device();
  this->SetLayout.emplace(logical, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const vk::DescriptorSetLayout setLayout = **this->SetLayout;
  const vk::PushConstantRange constants(vk::ShaderStageFlagBits::eCompute, 0,
    sizeof(BeamParameters));
  this->Layout.emplace(logical, vk::PipelineLayoutCreateInfo({}, setLayout, constants));
  const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer,
    MAMMORAY_BEAM_BINDING_COUNT);
  this->DescriptorPool.emplace(logical,
    vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size));
  vk::raii::DescriptorSets sets(logical,
    vk::DescriptorSetAllocateInfo(**this->DescriptorPool, setLayout));
  this->Set.emplace(std::move(sets.front()));
  const vk::raii::ShaderModule module = Module(device, beam, sizeof(beam));
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module,
    "main");
  this->Pipeline.emplace(logical, nullptr,
    vk::ComputePipelineCreateInfo({}, stage, **this->Layout));
}

std::vector<float> DeviceBeam::Transmission(const Buffer& lengths,
  const std::optional<ProjectedView>& view, const Beam& beam)
{
  if (!view)
  {
    throw InputError("projector: expected a projection before its transmission, found none");
  }
  const std::size_t pixelCount = static_cast<std::size_t>(view->Columns) * view->Rows;
  const int materialCount = view->Materials;
  beam.CheckMaterials(materialCount);
  const std::size_t energies = beam.EnergyWeights().size();
  const auto stride = static_cast<std::size_t>(materialCount);
  Reserve(this->Table, this->Device, energies * stride * sizeof(float), Usage::eStorageBuffer,
    MemoryUse::Upload);
  Reserve(this->Transmitted, this->Device, pixelCount * sizeof(float), Usage::eStorageBuffer,
    MemoryUse::Download);
  float* entry = this->Table.Data<float>();
  for (std::size_t energy = 0; energy < energies; ++energy)
  {
    *entry++ = static_cast<float>(beam.EnergyWeights()[energy]);
    for (int material = 1; material < materialCount; ++material)
    {
      *entry++ = static_cast<float>(beam.MuPerMm(energy, material));
    }
  }

  const std::array<vk::DescriptorBufferInfo, MAMMORAY_BEAM_BINDING_COUNT> infos{
    vk::DescriptorBufferInfo(lengths.Handle(), 0, VK_WHOLE_SIZE),
    vk::DescriptorBufferInfo(this->Table.Handle(), 0, VK_WHOLE_SIZE),
    vk::DescriptorBufferInfo(this->Transmitted.Handle(), 0, VK_WHOLE_SIZE),
  };
  std::vector<vk::WriteDescriptorSet> writes;
  for (std::uint32_t binding = 0; binding < infos.size(); ++binding)
  {
    writes.emplace_back(**this->Set, binding, 0, 1, vk::DescriptorType::eStorageBuffer, nullptr,
      &infos[binding]);
  }
  this->Device.Device().updateDescriptorSets(writes, {});

  const BeamParameters parameters{ static_cast<std::uint32_t>(pixelCount),
    static_cast<std::uint32_t>(materialCount), static_cast<std::uint32_t>(energies) };
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      using Stage = vk::PipelineStageFlagBits;
      commands.bindPipeline(vk::PipelineBindPoint::eCompute, **this->Pipeline);
      commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, **this->Layout, 0, **this->Set,
        nullptr);
      commands.pushConstants<BeamParameters>(**this->Layout, vk::ShaderStageFlagBits::eCompute, 0,
        parameters);
      const auto groups =
        static_cast<std::uint32_t>((pixelCount + MAMMORAY_BEAM_GROUP - 1) / MAMMORAY_BEAM_GROUP);
      commands.dispatch(std::min(groups, GroupsPerRow), (groups + GroupsPerRow - 1) / GroupsPerRow,
        1);
      const vk::MemoryBarrier barrier(vk::AccessFlagBits::eShaderWrite,
        vk::AccessFlagBits::eHostRead);
      commands.pipelineBarrier(Stage::eComputeShader, Stage::eHost, {}, barrier, nullptr, nullptr);
    });
  const float* values = this->Transmitted.Data<float>();
  std::vector<float> image(values, values + pixelCount);
  FillFromNeighbours(image, view->Columns, view->Rows, view->Holes);
  return image;
}
}
