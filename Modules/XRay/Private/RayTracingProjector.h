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
/// See PathLengthProjector and shaders/pathLength.rgen. Everything but the mesh's own buffers
/// outlives frames.
class RayTracingProjector : public DeviceProjector
{
public:
  RayTracingProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options);

  void SetSurface(const SurfaceMesh& surface) override;
  void UpdatePoints(const std::vector<double>& points) override;
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

  void MakeLayout();
  const Program& ProgramFor(const Kind& kind);
  template <typename Real>
  void WriteParameters(const XRaySource& source, const XRayDetector& detector,
    std::uint32_t attempts);
  /// Copies positions, relative to the local origin, to the device and finds their box.
  void WritePoints(const std::vector<double>& points);
  void BuildScene(bool refit);
  void UpdateDescriptors();
  PathLengthImage MakeImage(const XRaySource& source, const XRayDetector& detector) const override;
  /// Materials that the shaders have room for: few capacities, so that few pipelines are compiled.
  std::uint32_t Capacity() const;
  int MostFields(const XRayDetector& detector, int fields) const override;
  void Render(const XRaySource& source, const XRayDetector& detector, int fields) override;
  void RenderFields(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& velocities, int fields, int atOnce,
    PathLengthDerivatives& derivatives) override;
  /// Fills Lengths and Failures for `count` rays.
  void RenderRays(const XRayLine* rays, std::size_t count);
  template <typename Real>
  void WriteRays(const XRayLine* rays, std::size_t count);
  /// Traces width x height rays.
  void Submit(const Kind& kind, std::uint32_t width, std::uint32_t height);

  std::optional<vk::raii::DescriptorSetLayout> SetLayout;
  std::optional<vk::raii::PipelineLayout> Layout;
  std::optional<vk::raii::DescriptorPool> DescriptorPool;
  std::optional<vk::raii::DescriptorSet> Set;
  std::map<Kind, Program> Programs;

  /// Origin of the local frame, and the box of the mesh in it, mm.
  Vector3 Center{ 0, 0, 0 };
  Vector3 BoxLow{ 0, 0, 0 };
  Vector3 BoxHigh{ 0, 0, 0 };

  Buffer Parameters;
  Buffer HitPositions;   ///< floats, for the driver's hit test
  Buffer ExactPositions; ///< doubles, for distances; unused in single precision
  Buffer Triangles;
  Buffer Materials;
  Buffer Instances;
  Buffer Rays;
  std::optional<AccelerationStructure> Surface;
  std::optional<AccelerationStructure> Scene;
};
}

#endif
