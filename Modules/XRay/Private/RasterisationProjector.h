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
 * every few materials.
 */
class RasterisationProjector : public DeviceProjector
{
public:
  RasterisationProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options);

  ProjectorOptions::Method Method() const override
  {
    return ProjectorOptions::Method::Rasterisation;
  }

private:
  /// The shaders for triangles, tiles, the result, and marks.
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

  void SurfaceChanged(const std::vector<double>& points, bool moved) override;
  bool HasRoomFor(const XRayDetector& detector) const override;
  int MostFields(const XRayDetector& detector) const override;
  FieldBatch NextBatch(const VectorFields& velocities, int next, int atOnce) const override;
  std::uint32_t Fill(const XRaySource& source, const XRayDetector& detector, int fields) override;

  const Programs& ProgramsFor(bool withRates);
  /// Bytes of the sums of one row of the detector.
  std::uint64_t RowBytes(const XRayDetector& detector, int fields) const;
  /// Makes buffers large enough, runs the shaders and, where the list of tiles was too short, runs
  /// them again; false, with `tiles` the number needed, when there is no room for so many.
  bool Run(const XRaySource& source, const XRayDetector& detector, Work work, std::uint64_t& tiles);
  template <typename Real>
  void WriteParameters(const XRaySource& source, const XRayDetector& detector, const Work& work);
  void UpdateBindings();
  /// Gives the number of tiles that the list should have held.
  std::uint32_t Submit(const XRayDetector& detector, const Work& work);
  /// Traces rays of the rows that failed again, a little beside, a few times; gives the number of
  /// pixels with rays that fail still.
  std::uint32_t RunAgain(const XRaySource& source, const XRayDetector& detector, Work work);

  ShaderBindings Bindings;
  /// Without and with derivatives; the latter made when first used.
  std::array<std::optional<Programs>, 2> Pipelines;
  /// No point of the surface is farther from the local origin, mm.
  double Reach = 0;
  Buffer Parameters;
  Buffer Sums;
  Buffer Tiles;
  Buffer TileCount;
  Buffer Marks;
};
}

#endif
