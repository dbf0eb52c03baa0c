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

  ProjectorOptions::Method Method() const override { return ProjectorOptions::Method::RayTracing; }

private:
  /// What a pipeline is specialised for: room for materials, velocity fields, and reverse mode.
  struct Kind
  {
    std::uint32_t Capacity = 4;
    std::uint32_t Fields = 0;
    std::uint32_t Reverse = 0;
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
  void AddGradient(const XRaySource& source, const XRayDetector& detector) override;

  const Program& ProgramFor(const Kind& kind);
  void Trace(const XRaySource& source, const XRayDetector& detector, const Kind& kind);
  /// Creates the acceleration structures.
  void MakeScene(const Buffer& hitPositions);
  /// Builds them on the device or, with `refit`, fits them to moved points.
  void BuildScene(bool refit);
  /// Number of materials that the shaders have room for: a power of two, so that few pipelines are
  /// compiled.
  std::uint32_t Capacity() const;
  template <typename Real>
  void WriteParameters(const XRaySource& source, const XRayDetector& detector);
  void UpdateBindings();

  ShaderBindings Bindings;
  std::map<Kind, Program> Programs;
  Buffer Parameters;
  /// Floats for the driver's hit test where Surface.Positions are doubles; else unused.
  Buffer HitPositions;
  Buffer Instances;
  std::optional<AccelerationStructure> Triangles;
  std::optional<AccelerationStructure> Scene;
};
}

#endif
