// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RasterisationProjector_h
#define mammoray_RasterisationProjector_h

#include "Private/DeviceProjector.h"

#include <array>
#include <optional>
#include <vector>

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
  /// The quantity that the shaders sum.
  enum class Pass
  {
    Lengths,
    Rates,
    Gradient
  };
  /// The shaders for triangles, tiles, the result, and marks.
  using Programs = std::array<std::optional<vk::raii::Pipeline>, 4>;
  /// The part of an image that one run of the shaders computes; columns and rows of the detector.
  struct Work
  {
    int Fields = 0;
    int FirstRow = 0;
    int RowCount = 0;
    /// First and last column and row with rays to follow.
    int Left = 0;
    int Right = 0;
    int Top = 0;
    int Bottom = 0;
    /// 0 for the first run, n for the nth repetition with the rays that failed.
    int Attempt = 0;
    /// True if the same attempt runs again: its marks are kept.
    bool KeepsMarks = false;
    /// True if the list of tiles of an earlier attempt is used.
    bool KeepsTiles = false;
    /// True if some rays of these rows have marks.
    bool HasMarks = false;
  };

  void SurfaceChanged(const std::vector<double>& points, bool moved) override;
  bool HasRoomFor(const XRayDetector& detector) const override;
  int MostFields(const XRayDetector& detector) const override;
  FieldBatch NextBatch(const VectorFields& velocities, int next, int atOnce) const override;
  std::uint32_t Fill(const XRaySource& source, const XRayDetector& detector, int fields) override;
  void AddGradient(const XRaySource& source, const XRayDetector& detector) override;

  const Programs& ProgramsFor(Pass pass);
  /// Fill that calls finish(attempts), with all that was run, for each band of rows while its sums
  /// are there.
  template <typename Finish>
  std::uint32_t FillBands(const XRaySource& source, const XRayDetector& detector, int fields,
    const Finish& finish);
  /// Bytes of the sums of one row of the detector.
  std::uint64_t RowBytes(const XRayDetector& detector, int fields) const;
  /// Enlarges buffers and runs the shaders, again if the list of tiles was too short. Returns false
  /// and sets `tiles` to the number needed if there is no room for them.
  bool Run(const XRaySource& source, const XRayDetector& detector, Work work, std::uint64_t& tiles);
  template <typename Real>
  void WriteParameters(const XRaySource& source, const XRayDetector& detector, const Work& work);
  void UpdateBindings();
  void WriteParametersOf(const XRaySource& source, const XRayDetector& detector, const Work& work);
  /// Returns the number of tiles that the list needs.
  std::uint32_t Submit(const XRayDetector& detector, const Work& work);
  /// Follows failed rays of these rows again a few times, with small offsets, until FailedPixels is
  /// 0. Returns the attempts.
  std::vector<Work> RunAgain(const XRaySource& source, const XRayDetector& detector, Work work);
  /// Adds the gradient of all rays of a band, whose sums are there.
  void AddBand(const XRaySource& source, const XRayDetector& detector,
    const std::vector<Work>& attempts);
  /// Adds that of the rays that an attempt followed last, whose parameters are written.
  void SubmitGradient();
  /// Entries that there is room for in the list of tiles.
  std::uint64_t TileCapacity() const
  {
    return this->Tiles.Bytes() / (2 * sizeof(std::uint32_t)) - 1;
  }

  /// The last image, if its sums are still on the device: one band, without rates.
  struct Filled
  {
    XRaySource Source;
    XRayDetector Detector;
    std::vector<Work> Attempts;
  };

  ShaderBindings Bindings;
  /// By Pass; created at first use.
  std::array<std::optional<Programs>, 3> Pipelines;
  /// Largest distance of a point of the surface from the local origin, mm.
  double Reach = 0;
  Buffer Parameters;
  Buffer Sums;
  Buffer Tiles;
  Buffer TileCount;
  Buffer Marks;
  std::optional<Filled> Last;
};
}

#endif
