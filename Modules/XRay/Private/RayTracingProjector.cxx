// SPDX-License-Identifier: Apache-2.0
#include "Private/RayTracingProjector.h"

#include "PathLengthParameters.h"
#include "Private/ProjectionHelpers.h"
#include "pathLengthRays_rgen_double.h"
#include "pathLengthRays_rgen_float.h"
#include "pathLength_rahit_double.h"
#include "pathLength_rahit_float.h"
#include "pathLength_rgen_double.h"
#include "pathLength_rgen_float.h"
#include "pathLength_rmiss_double.h"
#include "pathLength_rmiss_float.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
using Usage = vk::BufferUsageFlagBits;

/// A ray is traced once, and again at most four times where its first result cannot be trusted.
constexpr std::uint32_t MostAttempts = 5;
/// Velocity fields done at once, and rates (fields by materials) that a ray carries.
constexpr int MostFieldsAtOnce = 8;
constexpr std::uint32_t MostRates = 128;
/// Bytes of a pass's rates and velocities.
constexpr std::uint64_t MostFieldBytes = 256u << 20;
/// Rays of a list done at once, and in a row of the launch.
constexpr std::uint64_t MostRaysAtOnce = 1u << 20;
constexpr std::size_t RaysPerRow = 8192;

std::uint32_t TileCount(int pixels, int tile)
{
  return static_cast<std::uint32_t>((pixels + tile - 1) / tile);
}

/**
 * An order of the triangles in which neighbours in space are neighbours in memory: halves of the
 * longest side of the box around their middles, again and again. Some drivers (Mesa's lavapipe)
 * build their tree in the order given: a mesh of a breast with 193,388 triangles in a mesher's
 * order took 40 times as long.
 */
std::vector<std::uint32_t> SpatialOrder(const SurfaceMesh& surface)
{
  const std::size_t count = surface.NumberOfTriangles();
  std::vector<std::array<float, 3>> middles(count);
  std::vector<std::uint32_t> order(count);
  for (std::size_t triangle = 0; triangle < count; ++triangle)
  {
    order[triangle] = static_cast<std::uint32_t>(triangle);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      double sum = 0;
      for (std::size_t corner = 0; corner < 3; ++corner)
      {
        sum += surface.Points[3 * surface.Triangles[3 * triangle + corner] + axis];
      }
      middles[triangle][axis] = static_cast<float>(sum / 3);
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> ranges{ { 0, count } };
  while (!ranges.empty())
  {
    const auto [begin, end] = ranges.back();
    ranges.pop_back();
    if (end - begin < 3)
    {
      continue;
    }
    std::array<float, 3> low = middles[order[begin]];
    std::array<float, 3> high = low;
    for (std::size_t index = begin + 1; index < end; ++index)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        low[axis] = std::min(low[axis], middles[order[index]][axis]);
        high[axis] = std::max(high[axis], middles[order[index]][axis]);
      }
    }
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
    {
      longest = high[axis] - low[axis] > high[longest] - low[longest] ? axis : longest;
    }
    const std::size_t half = begin + (end - begin) / 2;
    std::nth_element(order.begin() + static_cast<std::ptrdiff_t>(begin),
      order.begin() + static_cast<std::ptrdiff_t>(half),
      order.begin() + static_cast<std::ptrdiff_t>(end),
      [&](std::uint32_t a, std::uint32_t b)
      { return std::tie(middles[a][longest], a) < std::tie(middles[b][longest], b); });
    ranges.emplace_back(begin, half);
    ranges.emplace_back(half, end);
  }
  return order;
}
}

RayTracingProjector::RayTracingProjector(std::unique_ptr<VulkanDevice> device,
  const ProjectorOptions& options)
  : DeviceProjector(std::move(device), options)
{
  this->MakeLayout();
  Reserve(this->Parameters, this->Device, sizeof(PathLengthParameters<double>),
    Usage::eStorageBuffer, MemoryUse::Upload);
  Reserve(this->Velocities, this->Device, 1, Usage::eStorageBuffer, MemoryUse::Upload);
  Reserve(this->Rates, this->Device, 1, Usage::eStorageBuffer, MemoryUse::Download);
  Reserve(this->Rays, this->Device, 1, Usage::eStorageBuffer, MemoryUse::Upload);
}

void RayTracingProjector::MakeLayout()
{
  std::array<vk::DescriptorSetLayoutBinding, MAMMORAY_BINDING_COUNT> bindings;
  for (std::uint32_t binding = 0; binding < bindings.size(); ++binding)
  {
    bindings[binding] = vk::DescriptorSetLayoutBinding(binding,
      binding == MAMMORAY_BINDING_SCENE ? vk::DescriptorType::eAccelerationStructureKHR
                                        : vk::DescriptorType::eStorageBuffer,
      1, vk::ShaderStageFlagBits::eRaygenKHR | vk::ShaderStageFlagBits::eAnyHitKHR);
  }
  const vk::raii::Device& device = this->Device.Device();
  this->SetLayout.emplace(device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const vk::DescriptorSetLayout setLayout = **this->SetLayout;
  this->Layout.emplace(device, vk::PipelineLayoutCreateInfo({}, setLayout));
  const std::array<vk::DescriptorPoolSize, 2> sizes{
    vk::DescriptorPoolSize(vk::DescriptorType::eAccelerationStructureKHR, 1),
    vk::DescriptorPoolSize(vk::DescriptorType::eStorageBuffer, MAMMORAY_BINDING_COUNT - 1),
  };
  this->DescriptorPool.emplace(device,
    vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, sizes));
  vk::raii::DescriptorSets sets(device,
    vk::DescriptorSetAllocateInfo(**this->DescriptorPool, setLayout));
  this->Set.emplace(std::move(sets.front()));
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
  {
    return this->Doubles ? Module(this->Device, twice, sizeof(twice))
                         : Module(this->Device, single, sizeof(single));
  };
  const vk::raii::ShaderModule rayGeneration = kind.IsList
    ? module(pathLengthRays_rgen_float, pathLengthRays_rgen_double)
    : module(pathLength_rgen_float, pathLength_rgen_double);
  const vk::raii::ShaderModule miss = module(pathLength_rmiss_float, pathLength_rmiss_double);
  const vk::raii::ShaderModule anyHit = module(pathLength_rahit_float, pathLength_rahit_double);
  const std::array<std::uint32_t, 2> values{ kind.Capacity, kind.Fields };
  const std::array<vk::SpecializationMapEntry, 2> entries{
    vk::SpecializationMapEntry(0, 0, sizeof(std::uint32_t)),
    vk::SpecializationMapEntry(1, sizeof(std::uint32_t), sizeof(std::uint32_t)),
  };
  const vk::SpecializationInfo constants(2, entries.data(), sizeof(values), values.data());
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
    **this->Layout);
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

void RayTracingProjector::SetSurface(const SurfaceMesh& surface)
{
  surface.Validate("surface");
  this->Forget();
  WithDeviceErrors(
    [&]
    {
      this->Scene.reset();
      this->Surface.reset();
      this->PointCount = surface.NumberOfPoints();
      this->TriangleCount = static_cast<std::uint32_t>(surface.NumberOfTriangles());
      this->MaterialCount = static_cast<std::uint32_t>(surface.NumberOfMaterials());

      const vk::BufferUsageFlags input = Usage::eStorageBuffer | Usage::eShaderDeviceAddress |
        Usage::eAccelerationStructureBuildInputReadOnlyKHR;
      Reserve(this->HitPositions, this->Device, surface.Points.size() * sizeof(float), input,
        MemoryUse::Upload);
      if (this->Doubles)
      {
        Reserve(this->ExactPositions, this->Device, surface.Points.size() * sizeof(double),
          Usage::eStorageBuffer, MemoryUse::Upload);
      }
      Reserve(this->Triangles, this->Device, surface.Triangles.size() * sizeof(std::uint32_t),
        input, MemoryUse::Upload);
      Reserve(this->Materials, this->Device, this->TriangleCount * sizeof(std::uint32_t),
        Usage::eStorageBuffer, MemoryUse::Upload);
      Reserve(this->Instances, this->Device, sizeof(vk::AccelerationStructureInstanceKHR), input,
        MemoryUse::Upload);

      this->WritePoints(surface.Points);
      std::uint32_t* triangles = this->Triangles.Data<std::uint32_t>();
      std::uint32_t* materials = this->Materials.Data<std::uint32_t>();
      for (const std::uint32_t triangle : SpatialOrder(surface))
      {
        triangles = std::copy_n(&surface.Triangles[3 * std::size_t{ triangle }], 3, triangles);
        *materials++ = surface.FrontMaterials[triangle] |
          static_cast<std::uint32_t>(surface.BackMaterials[triangle]) << 16;
      }
      this->BuildScene(false);
      this->DescriptorsStale = true;
    });
}

void RayTracingProjector::UpdatePoints(const std::vector<double>& points)
{
  if (!this->Scene)
  {
    throw InputError("projector: expected a surface before its points are moved, found none");
  }
  CheckMovedPoints(points, this->PointCount);
  this->Forget();
  WithDeviceErrors(
    [&]
    {
      this->WritePoints(points);
      this->BuildScene(true);
    });
}

void RayTracingProjector::WritePoints(const std::vector<double>& points)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  this->BoxLow = { infinity, infinity, infinity };
  this->BoxHigh = { -infinity, -infinity, -infinity };
  for (std::size_t index = 0; index < points.size(); index += 3)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      this->BoxLow[axis] = std::min(this->BoxLow[axis], points[index + axis]);
      this->BoxHigh[axis] = std::max(this->BoxHigh[axis], points[index + axis]);
    }
  }
  this->Center = 0.5 * (this->BoxLow + this->BoxHigh);
  // Room for the rounding of positions and of the rays' starts.
  const double room = 1e-3 + 1e-4 * Norm(this->BoxHigh - this->BoxLow);
  this->BoxLow = this->BoxLow - this->Center - Vector3{ room, room, room };
  this->BoxHigh = this->BoxHigh - this->Center + Vector3{ room, room, room };

  float* hit = this->HitPositions.Data<float>();
  double* exact = this->Doubles ? this->ExactPositions.Data<double>() : nullptr;
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    const double local = points[index] - this->Center[index % 3];
    hit[index] = static_cast<float>(local);
    if (exact)
    {
      exact[index] = local;
    }
  }
}

void RayTracingProjector::BuildScene(bool refit)
{
  if (!refit)
  {
    const vk::AccelerationStructureGeometryTrianglesDataKHR triangles(vk::Format::eR32G32B32Sfloat,
      this->HitPositions.Address(), 3 * sizeof(float),
      static_cast<std::uint32_t>(this->PointCount - 1), vk::IndexType::eUint32,
      this->Triangles.Address());
    // Each crossing must be counted once: no duplicate any-hit calls.
    this->Surface.emplace(this->Device, vk::AccelerationStructureTypeKHR::eBottomLevel,
      vk::AccelerationStructureGeometryKHR(vk::GeometryTypeKHR::eTriangles, triangles,
        vk::GeometryFlagBitsKHR::eNoDuplicateAnyHitInvocation),
      this->TriangleCount);

    vk::AccelerationStructureInstanceKHR instance;
    instance.transform.matrix[0][0] = 1.0f;
    instance.transform.matrix[1][1] = 1.0f;
    instance.transform.matrix[2][2] = 1.0f;
    instance.mask = 0xff;
    instance.accelerationStructureReference = this->Surface->Address();
    *this->Instances.Data<vk::AccelerationStructureInstanceKHR>() = instance;
    const vk::AccelerationStructureGeometryInstancesDataKHR instances(false,
      this->Instances.Address());
    this->Scene.emplace(this->Device, vk::AccelerationStructureTypeKHR::eTopLevel,
      vk::AccelerationStructureGeometryKHR(vk::GeometryTypeKHR::eInstances, instances), 1);
  }
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      using Stage = vk::PipelineStageFlagBits;
      using Access = vk::AccessFlagBits;
      const vk::MemoryBarrier built(Access::eAccelerationStructureWriteKHR,
        Access::eAccelerationStructureReadKHR | Access::eAccelerationStructureWriteKHR);
      this->Surface->Record(commands, refit);
      commands.pipelineBarrier(Stage::eAccelerationStructureBuildKHR,
        Stage::eAccelerationStructureBuildKHR, {}, built, nullptr, nullptr);
      this->Scene->Record(commands, refit);
      commands.pipelineBarrier(Stage::eAccelerationStructureBuildKHR,
        Stage::eAccelerationStructureBuildKHR | Stage::eRayTracingShaderKHR, {}, built, nullptr,
        nullptr);
    });
}

void RayTracingProjector::UpdateDescriptors()
{
  std::vector<vk::WriteDescriptorSet> writes;
  const vk::AccelerationStructureKHR scene = this->Scene->Handle();
  const vk::WriteDescriptorSetAccelerationStructureKHR sceneInfo(scene);
  vk::WriteDescriptorSet sceneWrite(**this->Set, MAMMORAY_BINDING_SCENE, 0, 1,
    vk::DescriptorType::eAccelerationStructureKHR);
  sceneWrite.pNext = &sceneInfo;
  writes.push_back(sceneWrite);

  const Buffer* buffers[MAMMORAY_BINDING_COUNT] = {};
  buffers[MAMMORAY_BINDING_PARAMETERS] = &this->Parameters;
  buffers[MAMMORAY_BINDING_POSITIONS] = this->Doubles ? &this->ExactPositions : &this->HitPositions;
  buffers[MAMMORAY_BINDING_TRIANGLES] = &this->Triangles;
  buffers[MAMMORAY_BINDING_MATERIALS] = &this->Materials;
  buffers[MAMMORAY_BINDING_LENGTHS] = &this->Lengths;
  buffers[MAMMORAY_BINDING_FAILURES] = &this->Failures;
  buffers[MAMMORAY_BINDING_VELOCITIES] = &this->Velocities;
  buffers[MAMMORAY_BINDING_RATES] = &this->Rates;
  buffers[MAMMORAY_BINDING_RAYS] = &this->Rays;
  std::array<vk::DescriptorBufferInfo, MAMMORAY_BINDING_COUNT> infos;
  for (std::uint32_t binding = 0; binding < MAMMORAY_BINDING_COUNT; ++binding)
  {
    if (buffers[binding])
    {
      infos[binding] = vk::DescriptorBufferInfo(buffers[binding]->Handle(), 0, VK_WHOLE_SIZE);
      writes.emplace_back(**this->Set, binding, 0, 1, vk::DescriptorType::eStorageBuffer, nullptr,
        &infos[binding]);
    }
  }
  this->Device.Device().updateDescriptorSets(writes, nullptr);
  this->DescriptorsStale = false;
}

template <typename Real>
void RayTracingProjector::WriteParameters(const XRaySource& source, const XRayDetector& detector,
  std::uint32_t attempts)
{
  PathLengthParameters<Real> parameters{};
  const auto set = [](Real(&target)[4], const Vector3& value, double fourth = 0)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      target[axis] = static_cast<Real>(value[axis]);
    }
    target[3] = static_cast<Real>(fourth);
  };
  if (source.Type == XRaySource::Kind::Point)
  {
    set(parameters.Source, source.Position - this->Center, 1);
  }
  else
  {
    set(parameters.Source, (1.0 / Norm(source.Direction)) * source.Direction);
  }
  set(parameters.DetectorOrigin, detector.Origin - this->Center);
  set(parameters.ColumnStep, detector.ColumnStep);
  set(parameters.RowStep, detector.RowStep);
  set(parameters.BoxLow, this->BoxLow);
  set(parameters.BoxHigh, this->BoxHigh);
  parameters.Columns = static_cast<std::uint32_t>(detector.Columns);
  parameters.Rows = static_cast<std::uint32_t>(detector.Rows);
  parameters.Samples = static_cast<std::uint32_t>(detector.Samples);
  parameters.Materials = this->MaterialCount;
  parameters.Attempts = attempts;
  *this->Parameters.Data<PathLengthParameters<Real>>() = parameters;
}

PathLengthImage RayTracingProjector::MakeImage(const XRaySource& source,
  const XRayDetector& detector) const
{
  CheckGeometry(source, detector);
  if (!this->Scene)
  {
    throw InputError("projector: expected a surface before the projection, found none");
  }
  PathLengthImage image;
  image.Columns = detector.Columns;
  image.Rows = detector.Rows;
  image.Materials = static_cast<int>(this->MaterialCount);
  if (image.NumberOfPixels() * this->MaterialCount * sizeof(float) >
      this->Device.Limits().maxStorageBufferRange ||
    (image.Columns + 8ull) * (image.Rows + 8ull) >
      this->Device.RayTracingProperties().maxRayDispatchInvocationCount)
  {
    throw InputError("detector: " + std::to_string(image.NumberOfPixels()) + " pixels of " +
      std::to_string(this->MaterialCount) + " materials are more than " + this->Device.Name() +
      " takes in one image");
  }
  return image;
}

std::uint32_t RayTracingProjector::Capacity() const
{
  std::uint32_t capacity = 4;
  while (capacity < this->MaterialCount)
  {
    capacity *= 2;
  }
  return capacity;
}

int RayTracingProjector::MostFields(const XRayDetector& detector, int fields) const
{
  const std::uint64_t most =
    std::min<std::uint64_t>(MostFieldBytes, this->Device.Limits().maxStorageBufferRange);
  const std::uint64_t rates = std::uint64_t(detector.Columns) * std::uint64_t(detector.Rows) *
    this->MaterialCount * sizeof(float);
  const std::uint64_t velocities = 3 * this->PointCount * sizeof(float);
  if (velocities > most)
  {
    throw InputError("projector: velocities of " + std::to_string(this->PointCount) +
      " points are more than " + this->Device.Name() + " takes in one buffer");
  }
  const std::uint64_t carried = std::max(1u, MostRates / this->Capacity());
  return FieldsAtOnce(fields,
    static_cast<int>(std::min({ std::uint64_t{ MostFieldsAtOnce }, carried, most / velocities,
      std::max<std::uint64_t>(1, most / rates) })));
}

void RayTracingProjector::Render(const XRaySource& source, const XRayDetector& detector, int fields)
{
  const std::uint64_t pixelCount =
    std::uint64_t(detector.Columns) * static_cast<std::uint64_t>(detector.Rows);
  const std::uint64_t lengthBytes = pixelCount * this->MaterialCount * sizeof(float);
  bool grown =
    Reserve(this->Lengths, this->Device, lengthBytes, Usage::eStorageBuffer, MemoryUse::Download);
  grown |= Reserve(this->Failures, this->Device, pixelCount * sizeof(std::uint32_t),
    Usage::eStorageBuffer, MemoryUse::Download);
  grown |= Reserve(this->Rates, this->Device, lengthBytes * static_cast<std::uint64_t>(fields),
    Usage::eStorageBuffer, MemoryUse::Download);
  if (this->DescriptorsStale || grown)
  {
    this->UpdateDescriptors();
  }
  if (this->Doubles)
  {
    this->WriteParameters<double>(source, detector, MostAttempts);
  }
  else
  {
    this->WriteParameters<float>(source, detector, MostAttempts);
  }
  this->Submit({ this->Capacity(), static_cast<std::uint32_t>(fields), false },
    8 * TileCount(detector.Columns, MAMMORAY_TILE_COLUMNS),
    TileCount(detector.Rows, MAMMORAY_TILE_ROWS));
}

void RayTracingProjector::Submit(const Kind& kind, std::uint32_t width, std::uint32_t height)
{
  const Program& program = this->ProgramFor(kind);
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      commands.bindPipeline(vk::PipelineBindPoint::eRayTracingKHR, **program.Pipeline);
      commands.bindDescriptorSets(vk::PipelineBindPoint::eRayTracingKHR, **this->Layout, 0,
        **this->Set, nullptr);
      commands.traceRaysKHR(program.Regions[0], program.Regions[1], program.Regions[2], {}, width,
        height, 1);
      const vk::MemoryBarrier written(vk::AccessFlagBits::eShaderWrite,
        vk::AccessFlagBits::eHostRead);
      commands.pipelineBarrier(vk::PipelineStageFlagBits::eRayTracingShaderKHR,
        vk::PipelineStageFlagBits::eHost, {}, written, nullptr, nullptr);
    });
}

template <typename Real>
void RayTracingProjector::WriteRays(const XRayLine* rays, std::size_t count)
{
  Real* target = this->Rays.Data<Real>();
  for (const XRayLine* line = rays; line != rays + count; ++line)
  {
    for (const Vector3& point : { line->Begin, line->End })
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        *target++ = static_cast<Real>(point[axis] - this->Center[axis]);
      }
    }
  }
  // Source and detector stay unread.
  XRayDetector detector;
  detector.Columns = static_cast<int>(count);
  this->WriteParameters<Real>({}, detector, MostAttempts);
}

void RayTracingProjector::RenderRays(const XRayLine* rays, std::size_t count)
{
  bool grown = Reserve(this->Lengths, this->Device, count * this->MaterialCount * sizeof(float),
    Usage::eStorageBuffer, MemoryUse::Download);
  grown |= Reserve(this->Failures, this->Device, count * sizeof(std::uint32_t),
    Usage::eStorageBuffer, MemoryUse::Download);
  grown |=
    Reserve(this->Rays, this->Device, 6 * count * (this->Doubles ? sizeof(double) : sizeof(float)),
      Usage::eStorageBuffer, MemoryUse::Upload);
  if (this->DescriptorsStale || grown)
  {
    this->UpdateDescriptors();
  }
  if (this->Doubles)
  {
    this->WriteRays<double>(rays, count);
  }
  else
  {
    this->WriteRays<float>(rays, count);
  }
  const auto width = static_cast<std::uint32_t>(std::min(count, RaysPerRow));
  this->Submit({ this->Capacity(), 0, true }, width,
    static_cast<std::uint32_t>((count + width - 1) / width));
}

PathLengthImage RayTracingProjector::ProjectRays(const std::vector<XRayLine>& rays)
{
  if (!this->Scene)
  {
    throw InputError("projector: expected a surface before the projection, found none");
  }
  CheckRays(rays);
  this->Forget();
  PathLengthImage image;
  image.Columns = static_cast<int>(rays.size());
  image.Rows = 1;
  image.Materials = static_cast<int>(this->MaterialCount);
  image.Lengths.assign(rays.size() * this->MaterialCount, 0.0f);
  image.Inconsistent.resize(rays.size());
  const std::uint64_t mostValues = this->Device.Limits().maxStorageBufferRange / sizeof(float);
  const auto atOnce = static_cast<std::size_t>(
    std::clamp<std::uint64_t>(mostValues / this->MaterialCount, 1, MostRaysAtOnce));
  for (std::size_t first = 0; first < rays.size(); first += atOnce)
  {
    const std::size_t count = std::min(atOnce, rays.size() - first);
    WithDeviceErrors([&] { this->RenderRays(rays.data() + first, count); });
    for (std::size_t material = 1; material < this->MaterialCount; ++material)
    {
      std::copy_n(this->Lengths.Data<float>() + material * count, count,
        image.Lengths.begin() + static_cast<std::ptrdiff_t>(material * rays.size() + first));
    }
    std::transform(this->Failures.Data<std::uint32_t>(),
      this->Failures.Data<std::uint32_t>() + count,
      image.Inconsistent.begin() + static_cast<std::ptrdiff_t>(first),
      [](std::uint32_t failed) { return static_cast<unsigned char>(failed); });
  }
  return image;
}

void RayTracingProjector::RenderFields(const XRaySource& source, const XRayDetector& detector,
  const std::vector<double>& velocities, int fields, int atOnce, PathLengthDerivatives& derivatives)
{
  const std::vector<double> factors(static_cast<std::size_t>(atOnce), 1.0);
  for (int next = 0; next < fields; next += atOnce)
  {
    // The last batch repeats some fields of the one before, so that one pipeline does for all.
    const int first = std::min(next, fields - atOnce);
    this->RenderBatch(source, detector, velocities, first, factors);
    ReadRates(this->Rates.Data<float>(), first, factors, derivatives);
  }
}
}
