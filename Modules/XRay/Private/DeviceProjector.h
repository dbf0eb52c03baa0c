// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DeviceProjector_h
#define mammoray_DeviceProjector_h

#include "Private/DeviceBeam.h"

namespace mammoray
{
/**
 * What the projectors of a Vulkan device share, whichever way they find path lengths: the buffers
 * that these end in, how images are read from them, and the beam. Members are declared in creation
 * order.
 */
class DeviceProjector : public PathLengthProjector
{
public:
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) final;
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& velocities, int fields, PathLengthDerivatives& derivatives) final;
  std::vector<float> Transmission(const Beam& beam) final;
  std::string DeviceName() const final { return this->Device.Name(); }

protected:
  DeviceProjector(std::unique_ptr<VulkanDevice> device, const ProjectorOptions& options);

  /// An image of the right size; throws InputError where none can be made.
  virtual PathLengthImage MakeImage(const XRaySource& source,
    const XRayDetector& detector) const = 0;
  /// Most fields that are done at once; throws InputError when there is no room for one.
  virtual int MostFields(const XRayDetector& detector, int fields) const = 0;
  /// Fills Lengths, Failures and, for the fields of Velocities, Rates.
  virtual void Render(const XRaySource& source, const XRayDetector& detector, int fields) = 0;
  /// Renders all fields, at most `atOnce` of them at a time, and reads their rates.
  virtual void RenderFields(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& velocities, int fields, int atOnce,
    PathLengthDerivatives& derivatives) = 0;

  /// Renders fields [first, first + factors.size()), each times its factor.
  void RenderBatch(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& velocities, int first, const std::vector<double>& factors);
  /// Lengths are no longer those of an image.
  void Forget()
  {
    this->LastView.reset();
    this->LastInStrips.reset();
  }

  std::unique_ptr<VulkanDevice> OwnedDevice;
  VulkanDevice& Device;
  bool Doubles = false;
  std::size_t PointCount = 0;
  std::uint32_t TriangleCount = 0;
  std::uint32_t MaterialCount = 0;
  Buffer Lengths;
  Buffer Failures;
  Buffer Velocities;
  Buffer Rates;
  bool DescriptorsStale = true;

private:
  /// Rows of the detector whose lengths one buffer of the device holds.
  int MostRows(const XRayDetector& detector) const;
  PathLengthImage ProjectInStrips(const XRaySource& source, const XRayDetector& detector,
    int rowsAtOnce);
  /// Reads what Render left, but for the pixels of LastView's holes.
  void Read(const XRayDetector& detector, PathLengthImage& image);

  /// Made when first used.
  std::optional<DeviceBeam> BeamOnDevice;
  /// Of the last image; empty when there is none.
  std::optional<ProjectedView> LastView;
  /// The last image where Lengths could not hold it at once.
  std::optional<PathLengthImage> LastInStrips;
};
}

#endif
