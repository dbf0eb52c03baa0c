// SPDX-License-Identifier: Apache-2.0
// What the projectors share.
#ifndef mammoray_ProjectionHelpers_h
#define mammoray_ProjectionHelpers_h

#include "Private/VulkanDevice.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
/// Throws InputError on a degenerate detector, or a source from which it cannot be seen.
void CheckGeometry(const XRaySource& source, const XRayDetector& detector);

/// Throws InputError unless there are 1 to 2^31 - 1 rays, all finite and longer than nothing.
void CheckRays(const std::vector<XRayLine>& rays);

/// Throws InputError unless there are finite coordinates for `pointCount` points.
void CheckMovedPoints(const std::vector<double>& points, std::size_t pointCount);

/// Throws InputError unless there are finite velocities of `pointCount` points in 1 field or more.
void CheckVelocities(const std::vector<double>& velocities, int fields, std::size_t pointCount);

/// Fields per pass when at most `most` fit into one: all passes equally large, as near as can be.
int FieldsAtOnce(int fields, int most);

/// Sizes of the derivatives of an image.
void PrepareDerivatives(const PathLengthImage& image, int fields,
  PathLengthDerivatives& derivatives);

/// Largest speed of a field, mm per unit of its parameter.
double LargestSpeed(const std::vector<double>& velocities, std::size_t pointCount, int field);

/**
 * Fields [first, first + factors.size()) in the devices' order, value[(point * count + field) * 3 +
 * axis], each times its factor.
 */
void WriteVelocities(const std::vector<double>& velocities, std::size_t pointCount, int first,
  const std::vector<double>& factors, float* target);

/// What a device's pass wrote; all of it pixelCount values per plane.
struct ProjectionOutput
{
  const float* Lengths = nullptr;          ///< mm; by material
  const std::uint32_t* Failures = nullptr; ///< samples per pixel that failed
};

/// Sizes of the image and its contents, pixels without any trusted ray left for FillHoles, which
/// are the result.
std::vector<std::size_t> ReadImage(const ProjectionOutput& output, const XRayDetector& detector,
  PathLengthImage& image);

/// Copies fields [first, first + factors.size()), planes of field and material, each field times
/// its factor.
void ReadRates(const float* rates, int first, const std::vector<double>& factors,
  PathLengthDerivatives& derivatives);

/**
 * Gives pixels without any trusted ray the mean of the nearest pixels that have one: ring by ring
 * inwards, each from its neighbours of the rings before. In every plane.
 */
void FillFromNeighbours(std::vector<float>& planes, int columns, int rows,
  std::vector<std::size_t> holes);

/// A shader from its SPIR-V words.
vk::raii::ShaderModule Module(const VulkanDevice& device, const uint32_t* words, std::size_t bytes);
}

#endif
