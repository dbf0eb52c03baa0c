// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RasterisationProjector_h
#define mammoray_RasterisationProjector_h

#include "Private/DeviceProjector.h"

#include <array>

namespace mammoray
{
/**
 * Rasterises each triangle in compute shaders and adds integer path lengths per pixel; see
 * PathLengthProjector and shaders/include/raster.glsl. Not the graphics pipeline: its hit test
 * moves corners to 1/256 of a pixel, its sums are floats, and it needs a pass over the image for
 * every few materials. Everything but the mesh's own buffers outlives frames.
 */
class RasterisationProjector : public DeviceProjector
{
public:
  RasterisationProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options);

  void SetSurface(const SurfaceMesh& surface) override;
  void UpdatePoints(const std::vector<double>& points) override;
  ProjectorOptions::Method Method() const override
  {
    return ProjectorOptions::Method::Rasterisation;
  }

private:
  /// For triangles, tiles, the result, and marks.
  using Programs = std::array<std::optional<vk::raii::Pipeline>, 4>;
  /// What one run of the shaders works on; columns and rows of the detector.
  struct Work
  {
    int Fields = 0;
    int FirstRow = 0;
    int RowCount = 0;
    /// Columns and rows that are looked at, first and last.
    int Left = 0;
    int Right = 0;
    int Top = 0;
    int Bottom = 0;
    /// 0 at first; then how often rays that failed have been traced again, this time included.
    int Attempt = 0;
    /// The attempt is done once more: marks stay as they are.
    bool KeepsMarks = false;
    /// The list of tiles is that of an earlier attempt.
    bool KeepsTiles = false;
  };

  void MakeLayout();
  const Programs& ProgramsFor(bool withRates);
  void WritePoints(const std::vector<double>& points);
  template <typename Real>
  void WriteParameters(const XRaySource& source, const XRayDetector& detector, const Work& work);
  void UpdateDescriptors();
  PathLengthImage MakeImage(const XRaySource& source, const XRayDetector& detector) const override;
  /// Bytes of the sums of one row of the detector.
  std::uint64_t RowBytes(const XRayDetector& detector, int fields) const;
  int MostFields(const XRayDetector& detector, int fields) const override;
  void Render(const XRaySource& source, const XRayDetector& detector, int fields) override;
  void RenderFields(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& velocities, int fields, int atOnce,
    PathLengthDerivatives& derivatives) override;
  /// Makes buffers large enough, runs the shaders and, where the list of tiles was too short, runs
  /// them again; false, with `tiles` the number needed, when there is no room for so many.
  bool Run(const XRaySource& source, const XRayDetector& detector, Work work, std::uint64_t& tiles);
  /// Gives the number of tiles that the list should have held.
  std::uint32_t Submit(const XRayDetector& detector, const Work& work);
  /// Traces rays of the rows that failed again, a little beside, a few times.
  void RunAgain(const XRaySource& source, const XRayDetector& detector, Work work);
  std::uint64_t MostBytes() const;

  std::optional<vk::raii::DescriptorSetLayout> SetLayout;
  std::optional<vk::raii::PipelineLayout> Layout;
  std::optional<vk::raii::DescriptorPool> DescriptorPool;
  std::optional<vk::raii::DescriptorSet> Set;
  /// Without and with derivatives; the latter made when first used.
  std::array<std::optional<Programs>, 2> Pipelines;

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
  Buffer Marks;
};
}

#endif
