// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RasterisationProjector_h
#define mammoray_RasterisationProjector_h

#include "Buffer.h"

#include <array>

namespace mammoray
{
/**
 * Rasterises each triangle in compute shaders and adds integer path lengths per pixel; see
 * PathLengthProjector and shaders/include/raster.glsl. Not the graphics pipeline: its hit test
 * moves corners to 1/256 of a pixel, its sums are floats, and it needs a pass over the image for
 * every few materials. Everything but the mesh's own buffers outlives frames.
 */
class RasterisationProjector : public PathLengthProjector
{
public:
  RasterisationProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options);

  void SetSurface(const SurfaceMesh& surface) override;
  void UpdatePoints(const std::vector<double>& points) override;
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) override;
  std::string DeviceName() const override { return this->Device.Name(); }
  ProjectorOptions::Method Method() const override
  {
    return ProjectorOptions::Method::Rasterisation;
  }

private:
  void MakePipelines();
  void WritePoints(const std::vector<double>& points);
  template <typename Real>
  void WriteParameters(const XRaySource& source, const XRayDetector& detector, int firstRow,
    int rowCount);
  void UpdateDescriptors();
  /// Rasterises rows of the detector; gives the number of tiles that the list should have held.
  std::uint32_t RunBand(const XRayDetector& detector, int rowCount);

  std::unique_ptr<VulkanDevice> OwnedDevice;
  VulkanDevice& Device;
  bool Doubles = false;
  std::optional<vk::raii::DescriptorSetLayout> SetLayout;
  std::optional<vk::raii::PipelineLayout> Layout;
  std::optional<vk::raii::DescriptorPool> DescriptorPool;
  std::optional<vk::raii::DescriptorSet> Set;
  /// For triangles, tiles, and the result.
  std::array<std::optional<vk::raii::Pipeline>, 3> Pipelines;

  std::size_t PointCount = 0;
  std::uint32_t TriangleCount = 0;
  std::uint32_t MaterialCount = 0;
  /// Origin of the local frame, and the largest distance from it, mm.
  Vector3 Center{ 0, 0, 0 };
  double Reach = 0;

  Buffer Parameters;
  Buffer Positions;
  Buffer Triangles;
  Buffer Materials;
  Buffer Sums;
  Buffer Tiles;
  Buffer TileCount;
  Buffer Lengths;
  Buffer Failures;
  bool DescriptorsStale = true;
};
}

#endif
