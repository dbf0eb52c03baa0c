// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RayTracingProjector_h
#define mammoray_RayTracingProjector_h

#include "Private/AccelerationStructure.h"
#include "Private/DeviceProjector.h"

#include <array>
#include <compare>
#include <map>

namespace mammoray
{
/// Traces rays; see PathLengthProjector and shaders/pathLength.rgen.
class RayTracingProjector : public DeviceProjector
{
public:
  RayTracingProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options);

  PathLengthImage ProjectRays(const std::vector<XRayLine>& rays) override;
  ProjectorOptions::Method Method() const override { return ProjectorOptions::Method::RayTracing; }

private:
  /// What a pipeline is for: room for materials, velocity fields, and rays of pixels or of a list.
  struct Kind
  {
    std::uint32_t Capacity = 4;
    std::uint32_t Fields = 0;
    bool IsList = false;
    auto operator<=>(const Kind&) const = default;
  };
  /// Pipeline of a kind, with its shader binding table.
  struct Program
  {
    std::optional<vk::raii::Pipeline> Pipeline;
    Buffer Table;
    std::array<vk::StridedDeviceAddressRegionKHR, 3> Regions; ///< ray generation, miss, hit
  };

  std::vector<std::uint32_t> TriangleOrder(const SurfaceMesh& surface) const override;
  void SurfaceChanged(const std::vector<double>& points, bool moved) override;
  bool HasRoomFor(const XRayDetector& detector) const override;
  int MostFields(const XRayDetector& detector) const override;
  FieldBatch NextBatch(const VectorFields& velocities, int next, int atOnce) const override;
  std::uint32_t Fill(const XRaySource& source, const XRayDetector& detector, int fields) override;

  const Program& ProgramFor(const Kind& kind);
  /// Makes the acceleration structures anew.
  void MakeScene(const Buffer& hitPositions);
  /// Builds them on the device or, with `refit`, fits them to moved points.
  void BuildScene(bool refit);
  /// Materials that the shaders have room for: few capacities, so that few pipelines are compiled.
  std::uint32_t Capacity() const;
  template <typename Real>
  void WriteParameters(const XRaySource& source, const XRayDetector& detector);
  /// Fills Lengths and Failures for `count` rays; gives the number of those that failed.
  std::uint32_t FillRays(const XRayLine* rays, std::size_t count);
  template <typename Real>
  void WriteRays(const XRayLine* rays, std::size_t count);
  void UpdateBindings();
  /// Traces the rays of so many pixels by a launch of width x height; gives the number of pixels
  /// with rays that failed.
  std::uint32_t Submit(const Kind& kind, std::uint64_t pixels,
    const std::array<std::uint32_t, 2>& launch);

  ShaderBindings Bindings;
  std::map<Kind, Program> Programs;
  Buffer Parameters;
  /// Floats for the driver's hit test where Surface.Positions are doubles; else unused.
  Buffer HitPositions;
  Buffer Instances;
  Buffer Rays;
  std::optional<AccelerationStructure> Triangles;
  std::optional<AccelerationStructure> Scene;
};
}

#endif
