// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DeviceBeam_h
#define mammoray_DeviceBeam_h

#include "Private/ShaderBindings.h"
#include "mammoray/XRay/Beam.h"

#include <vector>

namespace mammoray
{
/// An image whose path lengths are in a buffer of the device.
struct DeviceImage
{
  int Columns = 0;
  int Rows = 0;
  int Materials = 0;
  /// Pixels without a consistent ray.
  std::vector<std::size_t> Holes;
};

/// The Beer-Lambert law as a compute shader. Pipeline and buffers are kept between images.
class DeviceBeam
{
public:
  explicit DeviceBeam(VulkanDevice& device);

  /// `lengths`: mm, value[(material * Rows + row) * Columns + column], air included. Holes take the
  /// mean of their neighbours. Throws InputError when the beam has fewer materials.
  std::vector<float> Transmission(const Buffer& lengths, const DeviceImage& image,
    const Beam& beam);

private:
  VulkanDevice& Device;
  ShaderBindings Bindings;
  std::optional<vk::raii::Pipeline> Pipeline;
  Buffer Table;
  Buffer Transmitted;
};
}

#endif
