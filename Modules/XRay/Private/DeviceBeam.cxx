// SPDX-License-Identifier: Apache-2.0
#include "Private/DeviceBeam.h"

#include "BeamParameters.h"
#include "Private/ProjectionTransfer.h"
#include "beam.h"

#include <array>

namespace mammoray
{
namespace
{
using Usage = vk::BufferUsageFlagBits;
}

DeviceBeam::DeviceBeam(VulkanDevice& device)
  : Device(device)
  , Bindings(device,
      { .Stages = vk::ShaderStageFlagBits::eCompute,
        .Count = MAMMORAY_BEAM_BINDING_COUNT,
        .ConstantBytes = sizeof(BeamParameters) })
{
  const vk::raii::ShaderModule module = MakeShader(device, beam);
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module,
    "main");
  this->Pipeline.emplace(device.Device(), nullptr,
    vk::ComputePipelineCreateInfo({}, stage, this->Bindings.Layout()));
}

std::vector<float> DeviceBeam::Transmission(const Buffer& lengths, const DeviceImage& image,
  const Beam& beam)
{
  const std::size_t pixelCount = static_cast<std::size_t>(image.Columns) * image.Rows;
  const int materialCount = image.Materials;
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

  std::array<const Buffer*, MAMMORAY_BEAM_BINDING_COUNT> buffers{};
  buffers[MAMMORAY_BEAM_LENGTHS] = &lengths;
  buffers[MAMMORAY_BEAM_TABLE] = &this->Table;
  buffers[MAMMORAY_BEAM_TRANSMISSION] = &this->Transmitted;
  this->Bindings.Update(buffers);

  const BeamParameters parameters{ static_cast<std::uint32_t>(pixelCount),
    static_cast<std::uint32_t>(materialCount), static_cast<std::uint32_t>(energies) };
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      using Stage = vk::PipelineStageFlagBits;
      commands.bindPipeline(vk::PipelineBindPoint::eCompute, **this->Pipeline);
      this->Bindings.Bind(commands, vk::PipelineBindPoint::eCompute);
      commands.pushConstants<BeamParameters>(this->Bindings.Layout(),
        vk::ShaderStageFlagBits::eCompute, 0, parameters);
      Dispatch(commands, pixelCount, MAMMORAY_BEAM_GROUP);
      const vk::MemoryBarrier barrier(vk::AccessFlagBits::eShaderWrite,
        vk::AccessFlagBits::eHostRead);
      commands.pipelineBarrier(Stage::eComputeShader, Stage::eHost, {}, barrier, nullptr, nullptr);
    });
  const float* values = this->Transmitted.Data<float>();
  std::vector<float> transmission(values, values + pixelCount);
  FillFromNeighbours(transmission, image.Columns, image.Rows, image.Holes);
  return transmission;
}
}
