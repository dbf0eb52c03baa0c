// SPDX-License-Identifier: Apache-2.0
// What the projectors share.
#ifndef mammoray_ProjectionHelpers_h
#define mammoray_ProjectionHelpers_h

#include "VulkanDevice.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
/// Throws InputError on a degenerate detector, or a source from which it cannot be seen.
void CheckGeometry(const XRaySource& source, const XRayDetector& detector);

/// Throws InputError unless there are finite coordinates for `pointCount` points.
void CheckMovedPoints(const std::vector<double>& points, std::size_t pointCount);

/**
 * Gives pixels without any trusted ray the mean of the nearest pixels that have one: ring by ring
 * inwards, each from its neighbours of the rings before.
 */
void FillFromNeighbours(PathLengthImage& image, std::vector<std::size_t> holes);

/// A shader from its SPIR-V words.
vk::raii::ShaderModule Module(const VulkanDevice& device, const uint32_t* words, std::size_t bytes);
}

#endif
