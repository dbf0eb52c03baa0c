// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DeviceBeam_h
#define mammoray_DeviceBeam_h

#include "Private/Buffer.h"
#include "mammoray/XRay/Beam.h"

namespace mammoray
{
/// The image that path lengths in a device's buffer belong to.
struct ProjectedView
{
  int Columns = 0;
  int Rows = 0;
  int Materials = 0;
  /// Pixels without a trusted ray.
  std::vector<std::size_t> Holes;
};

/// The Beer-Lambert law as a compute shader on path lengths in a device's buffer. Pipeline and
/// buffers live as long as it does.
class DeviceBeam
{
public:
  explicit DeviceBeam(VulkanDevice& device);

  /// `lengths`: mm, value[(material * Rows + row) * Columns + column], air included. Holes take the
  /// mean of their neighbours. Throws InputError when the beam has fewer materials, or when there
  /// is no view.
  std::vector<float> Transmission(const Buffer& lengths, const std::optional<ProjectedView>& view,
    const Beam& beam);

private:
  VulkanDevice& Device;
  std::optional<vk::raii::DescriptorSetLayout> SetLayout;
  std::optional<vk::raii::PipelineLayout> Layout;
  std::optional<vk::raii::DescriptorPool> DescriptorPool;
  std::optional<vk::raii::DescriptorSet> Set;
  std::optional<vk::raii::Pipeline> Pipeline;
  Buffer Table;
  Buffer Transmitted;
};
}

#endif
