// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DeviceProjector_h
#define mammoray_DeviceProjector_h

#include "Private/DeviceBeam.h"
#include "Private/DeviceSurface.h"
#include "Private/ProjectionTransfer.h"

#include <memory>
#include <optional>
#include <vector>

namespace mammoray
{
/**
 * The life of a projector on a Vulkan device, whichever way it finds path lengths: the surface goes
 * to the device's buffers, an image is rendered strip by strip of rows (one strip where a buffer
 * holds it all), its derivatives batch by batch of fields, and both are read back; the beam acts on
 * what is there. Derived classes render. Everything but the surface's own buffers outlives frames.
 * Members are declared in creation order.
 */
class DeviceProjector : public PathLengthProjector
{
public:
  void SetSurface(const SurfaceMesh& surface) final;
  void UpdatePoints(const std::vector<double>& points) final;
  void Render(const XRaySource& source, const XRayDetector& detector) final;
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) final;
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector,
    const VectorFields& velocities, PathLengthDerivatives& derivatives) final;
  std::vector<float> Transmission(const Beam& beam) final;
  std::string DeviceName() const final { return this->Device.Name(); }

protected:
  /// `surfaceUsage`: what the buffers of the surface are used for.
  DeviceProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options,
    vk::BufferUsageFlags surfaceUsage);

  /// The order in which triangles lie on the device: order[n] is the number of the nth one. Empty:
  /// as they come.
  virtual std::vector<std::uint32_t> TriangleOrder(const SurfaceMesh&) const { return {}; }
  /// The device's buffers hold a new surface or, with `moved`, the same one with other points.
  virtual void SurfaceChanged(const std::vector<double>& points, bool moved) = 0;
  /// Whether an image of this detector can be rendered at once.
  virtual bool HasRoomFor(const XRayDetector& detector) const = 0;
  /// Most fields that one pass over this detector can take besides memory for results; may be 0.
  virtual int MostFields(const XRayDetector& detector) const = 0;
  /// The batch that does field `next` of all, at most `atOnce` of them.
  virtual FieldBatch NextBatch(const VectorFields& velocities, int next, int atOnce) const = 0;
  /// Fills Lengths, Failures and, for the fields of Velocities, Rates, which have room. Gives the
  /// number of pixels with samples that failed.
  virtual std::uint32_t Fill(const XRaySource& source, const XRayDetector& detector,
    int fields) = 0;

  /// Throws InputError when there is no surface.
  void RequireSurface() const;
  /// An image of so many pixels without contents.
  PathLengthImage MakeImage(int columns, int rows) const;
  /// Bytes that a buffer for work in bands or batches may have at the most.
  std::uint64_t MostBytes() const;
  /// Reserves a buffer; the shaders' bindings are stale when it was made anew.
  void Ensure(Buffer& buffer, vk::DeviceSize bytes, vk::BufferUsageFlags usage, MemoryUse use);
  void Ensure(ResultBuffer& buffer, vk::DeviceSize bytes);
  /// Makes room for the results of so many pixels or rays.
  void ReserveOutput(std::uint64_t pixels, int fields);
  /// Records that the number of failed pixels, which shaders count behind Failures' last pixel, is
  /// 0; a barrier must follow.
  void RecordClearing(const vk::raii::CommandBuffer& commands, std::uint64_t pixels) const;
  /// Records that what shaders of this stage and transfers have written can be read, and that the
  /// number of failed pixels goes to the host.
  void RecordResults(const vk::raii::CommandBuffer& commands, vk::PipelineStageFlagBits stage,
    std::uint64_t pixels) const;
  /// What was counted.
  std::uint32_t FailedPixels() const { return *this->FailedCount.Data<std::uint32_t>(); }
  /// Failures of so many pixels, on the host.
  const std::uint32_t* FetchFailures(std::uint64_t pixels);
  /// Path lengths and, where there are any, failures of so many pixels, on the host.
  ProjectionOutput FetchOutput(std::uint64_t pixels, std::uint32_t failed);
  /// Notes that Lengths are no longer those of an image.
  void Forget()
  {
    this->LastImage.reset();
    this->LastInStrips.reset();
  }

  std::unique_ptr<VulkanDevice> OwnedDevice;
  VulkanDevice& Device;
  bool Doubles = false;
  DeviceSurface Surface;
  ResultBuffer Lengths;
  /// A number for each pixel, then that of all pixels that have failures.
  ResultBuffer Failures;
  Buffer Velocities;
  ResultBuffer Rates;
  bool BindingsStale = true;

private:
  /// Rows [FirstRow, FirstRow + Part.Rows) of a detector.
  struct Strip
  {
    int FirstRow = 0;
    XRayDetector Part;

    PixelRange Pixels() const;
  };

  /// Rows of the detector whose lengths one buffer of the device holds.
  int RowsAtOnce(const XRayDetector& detector) const;
  Strip StripAt(const XRayDetector& detector, int firstRow) const;
  /// Throws InputError where no image can be made.
  void CheckImage(const XRaySource& source, const XRayDetector& detector) const;
  /// Calls render(strip), which gives the number of failed pixels, for the detector's strips and
  /// reads the path lengths that each leaves.
  template <typename Work>
  PathLengthImage ProjectStrips(const XRayDetector& detector, const Work& render);
  std::uint32_t FillStrip(const XRaySource& source, const XRayDetector& part, int fields);
  /// Rates of a batch, but for those in air, on the host.
  const float* FetchRates(std::uint64_t pixels, int fields);
  /// Fields that are done in one pass; throws InputError when there is no room for one.
  int FieldsAtOnce(const XRayDetector& part, int fields) const;

  vk::BufferUsageFlags SurfaceUsage;
  Buffer FailedCount;
  bool HasSurface = false;
  /// Made when first used.
  std::optional<DeviceBeam> BeamOnDevice;
  /// What the last Project left; empty when there is nothing.
  std::optional<DeviceImage> LastImage;
  /// The last image where Lengths could not hold it at once.
  std::optional<PathLengthImage> LastInStrips;
};
}

#endif
