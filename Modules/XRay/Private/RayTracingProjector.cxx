// SPDX-License-Identifier: Apache-2.0
#include "Private/RayTracingProjector.h"

#include "PathLengthParameters.h"
#include "Private/SpatialOrder.h"
#include "pathLength_rahit_double.h"
#include "pathLength_rahit_float.h"
#include "pathLength_rgen_double.h"
#include "pathLength_rgen_float.h"
#include "pathLength_rmiss_double.h"
#include "pathLength_rmiss_float.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace mammoray
{
namespace
{
using Usage = vk::BufferUsageFlagBits;

/// A ray is traced at most five times, until its result is consistent.
constexpr std::uint32_t MostTraces = 5;
/// Largest number of rates (fields x materials) in the payload of a ray.
constexpr std::uint32_t MostRates = 128;

std::uint32_t TileCount(int pixels, int tile)
{
  return static_cast<std::uint32_t>((pixels + tile - 1) / tile);
}

/// Usage of the buffers that acceleration structures are built from.
constexpr vk::BufferUsageFlags BuildInput = Usage::eStorageBuffer | Usage::eShaderDeviceAddress |
  Usage::eAccelerationStructureBuildInputReadOnlyKHR;
}

RayTracingProjector::RayTracingProjector(std::unique_ptr<VulkanDevice> device,
  const ProjectorOptions& options)
  : DeviceProjector(std::move(device), options, BuildInput)
  , Bindings(this->Device,
      { .Stages = vk::ShaderStageFlagBits::eRaygenKHR | vk::ShaderStageFlagBits::eAnyHitKHR,
        .Count = MAMMORAY_BINDING_COUNT,
        .Scene = MAMMORAY_BINDING_SCENE })
{
  Reserve(this->Parameters, this->Device, sizeof(PathLengthParameters<double>),
    Usage::eStorageBuffer, MemoryUse::Upload);
  Reserve(this->Instances, this->Device, sizeof(vk::AccelerationStructureInstanceKHR), BuildInput,
    MemoryUse::Upload);
}

const RayTracingProjector::Program& RayTracingProjector::ProgramFor(const Kind& kind)
{
  const auto known = this->Programs.find(kind);
  if (known != this->Programs.end())
  {
    return known->second;
  }
  Program program;
  const auto module = [&](const auto& single, const auto& twice)
  { return this->Doubles ? MakeShader(this->Device, twice) : MakeShader(this->Device, single); };
  const vk::raii::ShaderModule rayGeneration =
    module(pathLength_rgen_float, pathLength_rgen_double);
  const vk::raii::ShaderModule miss = module(pathLength_rmiss_float, pathLength_rmiss_double);
  const vk::raii::ShaderModule anyHit = module(pathLength_rahit_float, pathLength_rahit_double);
  const std::array<std::uint32_t, 3> values{ kind.Capacity, kind.Fields, kind.Reverse };
  const std::array<vk::SpecializationMapEntry, 3> entries{
    vk::SpecializationMapEntry(0, 0, sizeof(std::uint32_t)),
    vk::SpecializationMapEntry(1, sizeof(std::uint32_t), sizeof(std::uint32_t)),
    vk::SpecializationMapEntry(2, 2 * sizeof(std::uint32_t), sizeof(std::uint32_t)),
  };
  const vk::SpecializationInfo constants(3, entries.data(), sizeof(values), values.data());
  using Stage = vk::ShaderStageFlagBits;
  const std::array<vk::PipelineShaderStageCreateInfo, 3> stages{
    vk::PipelineShaderStageCreateInfo({}, Stage::eRaygenKHR, *rayGeneration, "main", &constants),
    vk::PipelineShaderStageCreateInfo({}, Stage::eMissKHR, *miss, "main"),
    vk::PipelineShaderStageCreateInfo({}, Stage::eAnyHitKHR, *anyHit, "main", &constants),
  };
  using GroupType = vk::RayTracingShaderGroupTypeKHR;
  constexpr std::uint32_t none = VK_SHADER_UNUSED_KHR;
  const std::array<vk::RayTracingShaderGroupCreateInfoKHR, 3> groups{
    vk::RayTracingShaderGroupCreateInfoKHR(GroupType::eGeneral, 0, none, none, none),
    vk::RayTracingShaderGroupCreateInfoKHR(GroupType::eGeneral, 1, none, none, none),
    vk::RayTracingShaderGroupCreateInfoKHR(GroupType::eTrianglesHitGroup, none, none, 2, none),
  };
  const vk::RayTracingPipelineCreateInfoKHR info({}, stages, groups, 1, nullptr, nullptr, nullptr,
    this->Bindings.Layout());
  program.Pipeline.emplace(this->Device.Device(), nullptr, nullptr, info);

  // Each region starts at the base alignment, which is also a stride every device takes.
  const auto& properties = this->Device.RayTracingProperties();
  const std::uint32_t handleBytes = properties.shaderGroupHandleSize;
  const std::uint32_t alignment =
    std::max(properties.shaderGroupBaseAlignment, properties.shaderGroupHandleAlignment);
  const std::uint32_t stride = (handleBytes + alignment - 1) / alignment * alignment;
  const auto handles = program.Pipeline->getRayTracingShaderGroupHandlesKHR<std::uint8_t>(0, 3,
    std::size_t{ 3 } * handleBytes);
  program.Table = Buffer(this->Device, 3 * stride + alignment,
    Usage::eShaderBindingTableKHR | Usage::eShaderDeviceAddress, MemoryUse::Upload);
  const vk::DeviceAddress start = (program.Table.Address() + alignment - 1) / alignment * alignment;
  for (std::uint32_t group = 0; group < 3; ++group)
  {
    std::memcpy(program.Table.Data<std::uint8_t>() + (start - program.Table.Address()) +
        group * stride,
      handles.data() + group * handleBytes, handleBytes);
    program.Regions[group] =
      vk::StridedDeviceAddressRegionKHR(start + group * stride, stride, stride);
  }
  return this->Programs.emplace(kind, std::move(program)).first->second;
}

std::vector<std::uint32_t> RayTracingProjector::TriangleOrder(const SurfaceMesh& surface) const
{
  // Drivers of hardware sort by themselves, in far less time.
  return this->Device.IsSoftware() ? SpatialOrder(surface) : std::vector<std::uint32_t>();
}

void RayTracingProjector::SurfaceChanged(const std::vector<double>& points, bool moved)
{
  if (this->Doubles)
  {
    Reserve(this->HitPositions, this->Device, points.size() * sizeof(float), BuildInput,
      MemoryUse::Upload);
    this->Surface.WriteLocal(points, this->HitPositions.Data<float>());
  }
  if (!moved)
  {
    this->MakeScene(this->Doubles ? this->HitPositions : this->Surface.Positions);
  }
  this->BuildScene(moved);
}

void RayTracingProjector::MakeScene(const Buffer& hitPositions)
{
  this->Scene.reset();
  this->Triangles.reset();
  const vk::AccelerationStructureGeometryTrianglesDataKHR triangles(vk::Format::eR32G32B32Sfloat,
    hitPositions.Address(), 3 * sizeof(float),
    static_cast<std::uint32_t>(this->Surface.PointCount - 1), vk::IndexType::eUint32,
    this->Surface.Triangles.Address());
  // Each crossing must be counted once: no duplicate any-hit calls.
  this->Triangles.emplace(this->Device, vk::AccelerationStructureTypeKHR::eBottomLevel,
    vk::AccelerationStructureGeometryKHR(vk::GeometryTypeKHR::eTriangles, triangles,
      vk::GeometryFlagBitsKHR::eNoDuplicateAnyHitInvocation),
    this->Surface.TriangleCount);

  vk::AccelerationStructureInstanceKHR instance;
  instance.transform.matrix[0][0] = 1.0f;
  instance.transform.matrix[1][1] = 1.0f;
  instance.transform.matrix[2][2] = 1.0f;
  instance.mask = 0xff;
  instance.accelerationStructureReference = this->Triangles->Address();
  *this->Instances.Data<vk::AccelerationStructureInstanceKHR>() = instance;
  const vk::AccelerationStructureGeometryInstancesDataKHR instances(false,
    this->Instances.Address());
  this->Scene.emplace(this->Device, vk::AccelerationStructureTypeKHR::eTopLevel,
    vk::AccelerationStructureGeometryKHR(vk::GeometryTypeKHR::eInstances, instances), 1);
}

void RayTracingProjector::BuildScene(bool refit)
{
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      using Stage = vk::PipelineStageFlagBits;
      using Access = vk::AccessFlagBits;
      const vk::MemoryBarrier built(Access::eAccelerationStructureWriteKHR,
        Access::eAccelerationStructureReadKHR | Access::eAccelerationStructureWriteKHR);
      this->Triangles->Record(commands, refit);
      commands.pipelineBarrier(Stage::eAccelerationStructureBuildKHR,
        Stage::eAccelerationStructureBuildKHR, {}, built, nullptr, nullptr);
      this->Scene->Record(commands, refit);
      commands.pipelineBarrier(Stage::eAccelerationStructureBuildKHR,
        Stage::eAccelerationStructureBuildKHR | Stage::eRayTracingShaderKHR, {}, built, nullptr,
        nullptr);
    });
}

void RayTracingProjector::UpdateBindings()
{
  if (!this->BindingsStale)
  {
    return;
  }
  std::array<const Buffer*, MAMMORAY_BINDING_COUNT> buffers{}; // none for the scene
  buffers[MAMMORAY_BINDING_PARAMETERS] = &this->Parameters;
  buffers[MAMMORAY_BINDING_POSITIONS] = &this->Surface.Positions;
  buffers[MAMMORAY_BINDING_TRIANGLES] = &this->Surface.Triangles;
  buffers[MAMMORAY_BINDING_MATERIALS] = &this->Surface.Materials;
  buffers[MAMMORAY_BINDING_LENGTHS] = &this->Lengths.OnDevice();
  buffers[MAMMORAY_BINDING_FAILURES] = &this->Failures.OnDevice();
  buffers[MAMMORAY_BINDING_VELOCITIES] = &this->Velocities;
  buffers[MAMMORAY_BINDING_RATES] = &this->Rates.OnDevice();
  this->Bindings.Update(buffers, this->Scene->Handle());
  this->BindingsStale = false;
}

template <typename Real>
void RayTracingProjector::WriteParameters(const XRaySource& source, const XRayDetector& detector)
{
  const Vector3& center = this->Surface.Center;
  // Room for the rounding of positions and of the rays' starts.
  const double room = 1e-3 + 1e-4 * Norm(this->Surface.Bounds.High - this->Surface.Bounds.Low);
  PathLengthParameters<Real> parameters{};
  if (source.Type == XRaySource::Kind::Point)
  {
    SetReal4(parameters.Source, source.Position - center, 1);
  }
  else
  {
    SetReal4(parameters.Source, (1.0 / Norm(source.Direction)) * source.Direction);
  }
  SetReal4(parameters.DetectorOrigin, detector.Origin - center);
  SetReal4(parameters.ColumnStep, detector.ColumnStep);
  SetReal4(parameters.RowStep, detector.RowStep);
  SetReal4(parameters.BoxLow, this->Surface.Bounds.Low - center - Vector3{ room, room, room });
  SetReal4(parameters.BoxHigh, this->Surface.Bounds.High - center + Vector3{ room, room, room });
  parameters.Columns = static_cast<std::uint32_t>(detector.Columns);
  parameters.Rows = static_cast<std::uint32_t>(detector.Rows);
  parameters.Samples = static_cast<std::uint32_t>(detector.Samples);
  parameters.Materials = this->Surface.MaterialCount;
  parameters.Attempts = MostTraces;
  *this->Parameters.Data<PathLengthParameters<Real>>() = parameters;
}

bool RayTracingProjector::HasRoomFor(const XRayDetector& detector) const
{
  return (detector.Columns + 8ull) * (detector.Rows + 8ull) <=
    this->Device.RayTracingProperties().maxRayDispatchInvocationCount;
}

std::uint32_t RayTracingProjector::Capacity() const
{
  std::uint32_t capacity = 4;
  while (capacity < this->Surface.MaterialCount)
  {
    capacity *= 2;
  }
  return capacity;
}

int RayTracingProjector::MostFields(const XRayDetector&) const
{
  return static_cast<int>(std::max(1u, MostRates / this->Capacity()));
}

FieldBatch RayTracingProjector::NextBatch(const VectorFields& velocities, int next,
  int atOnce) const
{
  // The last batch repeats some fields of the one before, so that one pipeline does for all.
  return { std::min(next, static_cast<int>(velocities.Count()) - atOnce), atOnce };
}

std::uint32_t RayTracingProjector::Fill(const XRaySource& source, const XRayDetector& detector,
  int fields)
{
  this->Trace(source, detector, { this->Capacity(), static_cast<std::uint32_t>(fields), 0 });
  return this->FailedPixels();
}

void RayTracingProjector::AddGradient(const XRaySource& source, const XRayDetector& detector)
{
  this->Trace(source, detector, { this->Capacity(), 0, 1 });
}

void RayTracingProjector::Trace(const XRaySource& source, const XRayDetector& detector,
  const Kind& kind)
{
  this->UpdateBindings();
  if (this->Doubles)
  {
    this->WriteParameters<double>(source, detector);
  }
  else
  {
    this->WriteParameters<float>(source, detector);
  }
  const Program& program = this->ProgramFor(kind);
  const std::uint64_t pixels = detector.NumberOfPixels();
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      using Stage = vk::PipelineStageFlagBits;
      using Access = vk::AccessFlagBits;
      this->RecordClearing(commands, pixels);
      const vk::MemoryBarrier cleared(Access::eTransferWrite | Access::eShaderWrite,
        Access::eShaderRead | Access::eShaderWrite);
      commands.pipelineBarrier(Stage::eTransfer | Stage::eRayTracingShaderKHR,
        Stage::eRayTracingShaderKHR, {}, cleared, nullptr, nullptr);
      commands.bindPipeline(vk::PipelineBindPoint::eRayTracingKHR, **program.Pipeline);
      this->Bindings.Bind(commands, vk::PipelineBindPoint::eRayTracingKHR);
      commands.traceRaysKHR(program.Regions[0], program.Regions[1], program.Regions[2], {},
        8 * TileCount(detector.Columns, MAMMORAY_TILE_COLUMNS),
        TileCount(detector.Rows, MAMMORAY_TILE_ROWS), 1);
      this->RecordResults(commands, Stage::eRayTracingShaderKHR, pixels);
    });
}
}
