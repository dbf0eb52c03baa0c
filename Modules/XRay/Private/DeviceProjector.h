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
 * The steps that both projectors share: it uploads the surface, computes an image in strips of rows
 * (one strip if a buffer can hold it) and derivatives in batches of fields, and reads them back.
 * Derived classes compute a strip. All buffers except those of the surface are kept between images.
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
  std::vector<double> Backward(const XRaySource& source, const XRayDetector& detector,
    const std::vector<float>& lossByLength) final;
  std::vector<float> Transmission(const Beam& beam) final;
  std::string DeviceName() const final { return this->Device.Name(); }

protected:
  /// `surfaceUsage`: usage flags of the surface's buffers.
  DeviceProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options,
    vk::BufferUsageFlags surfaceUsage);

  /// Order of the triangles on the device: order[n] is the index of the nth one. Empty: unchanged.
  virtual std::vector<std::uint32_t> TriangleOrder(const SurfaceMesh&) const { return {}; }
  /// Called when the device's buffers hold a new surface or, with `moved`, new points of the same
  /// one.
  virtual void SurfaceChanged(const std::vector<double>& points, bool moved) = 0;
  /// True if the device can compute an image of this detector at once.
  virtual bool HasRoomFor(const XRayDetector& detector) const = 0;
  /// Largest number of fields per pass, whatever the memory for results; may be 0.
  virtual int MostFields(const XRayDetector& detector) const = 0;
  /// The batch of at most `atOnce` fields that contains field `next`.
  virtual FieldBatch NextBatch(const VectorFields& velocities, int next, int atOnce) const = 0;
  /// Computes Lengths, Failures and, for the fields in Velocities, Rates, whose buffers are large
  /// enough. Returns the number of pixels with failed samples.
  virtual std::uint32_t Fill(const XRaySource& source, const XRayDetector& detector,
    int fields) = 0;
  /// Adds to the gradient in Rates, [point][axis] as 64-bit integers, what the losses in Velocities
  /// give: dLoss / dLength in units of these integers, in the order of Lengths.
  virtual void AddGradient(const XRaySource& source, const XRayDetector& detector) = 0;

  /// Sets a vector of the shaders' parameters.
  template <typename Real>
  static void SetReal4(Real (&target)[4], const Vector3& value, double fourth = 0)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      target[axis] = static_cast<Real>(value[axis]);
    }
    target[3] = static_cast<Real>(fourth);
  }
  /// Throws InputError when there is no surface.
  void RequireSurface() const;
  /// An image of this size without values.
  PathLengthImage MakeImage(int columns, int rows) const;
  /// Largest size of a work buffer, bytes; larger work is divided.
  std::uint64_t MostBytes() const;
  /// Enlarges a buffer if necessary, which makes the shaders' bindings stale.
  void Ensure(Buffer& buffer, vk::DeviceSize bytes, vk::BufferUsageFlags usage, MemoryUse use);
  void Ensure(ResultBuffer& buffer, vk::DeviceSize bytes);
  /// Enlarges the buffers of results for a number of pixels.
  void ReserveOutput(std::uint64_t pixels, int fields);
  /// Records clearing the counter of failed pixels, which follows the last pixel in Failures. A
  /// barrier must follow.
  void RecordClearing(const vk::raii::CommandBuffer& commands, std::uint64_t pixels) const;
  /// Records the barriers after which results of a shader stage can be read, and a copy of the
  /// counter of failed pixels to the host.
  void RecordResults(const vk::raii::CommandBuffer& commands, vk::PipelineStageFlagBits stage,
    std::uint64_t pixels) const;
  /// Value of the counter after the last commands.
  std::uint32_t FailedPixels() const { return *this->FailedCount.Data<std::uint32_t>(); }
  /// Reads back the failures of a number of pixels.
  const std::uint32_t* FetchFailures(std::uint64_t pixels);
  /// Reads back path lengths and, if there are any, failures of a number of pixels.
  ProjectionOutput FetchOutput(std::uint64_t pixels, std::uint32_t failed);
  /// Marks the path lengths on the device as not belonging to an image.
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
  /// Number of failed samples of each pixel, then the number of pixels that have any.
  ResultBuffer Failures;
  /// Velocities of a batch of fields, or losses.
  Buffer Velocities;
  /// Rates of a batch of fields, or the gradient.
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

  /// Number of rows whose path lengths fit into one buffer of the device.
  int RowsAtOnce(const XRayDetector& detector) const;
  Strip StripAt(const XRayDetector& detector, int firstRow) const;
  /// Throws InputError if no image can be computed.
  void CheckImage(const XRaySource& source, const XRayDetector& detector) const;
  /// Calls render(strip), which returns the number of failed pixels, for each strip of the
  /// detector, and reads back its path lengths.
  template <typename Work>
  PathLengthImage ProjectStrips(const XRayDetector& detector, const Work& render);
  std::uint32_t FillStrip(const XRaySource& source, const XRayDetector& part, int fields);
  /// Reads back the rates of a batch, except those of air.
  const float* FetchRates(std::uint64_t pixels, int fields);
  /// Number of fields per pass. Throws InputError if there is no room for one.
  int FieldsAtOnce(const XRayDetector& part, int fields) const;

  vk::BufferUsageFlags SurfaceUsage;
  Buffer FailedCount;
  bool HasSurface = false;
  /// Made when first used.
  std::optional<DeviceBeam> BeamOnDevice;
  /// The image that the path lengths on the device belong to, if any.
  std::optional<DeviceImage> LastImage;
  /// The last image, if it was computed in several strips.
  std::optional<PathLengthImage> LastInStrips;
};
}

#endif
