// SPDX-License-Identifier: Apache-2.0
// From what a device's pass wrote to an image.
#ifndef mammoray_ProjectionReadout_h
#define mammoray_ProjectionReadout_h

#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mammoray
{
/// The pixels [First, First + Count) of an image, row by row.
struct PixelRange
{
  std::size_t First = 0;
  std::size_t Count = 0;
};

/// What a device's pass over some pixels wrote, planes of one value per pixel.
struct ProjectionOutput
{
  /// mm, a plane for each material; that of air is not written.
  const float* Lengths = nullptr;
  /// Number of samples of each pixel that failed; null where none did.
  const std::uint32_t* Failures = nullptr;
};

/**
 * Copies a pass over a range of the pixels, each of so many samples, into an image whose Columns,
 * Rows and Materials are set; its arrays grow where they have to. Returns the pixels of the range
 * that have no trusted ray at all, for FillFromNeighbours.
 */
MAMMORAYXRAY_EXPORT std::vector<std::size_t> ReadLengths(const ProjectionOutput& output,
  const PixelRange& range, int samples, PathLengthImage& image);

/// The pixels among the first `count` all of whose samples failed, so many a row and a column.
MAMMORAYXRAY_EXPORT std::vector<std::size_t> FindHoles(const std::uint32_t* failures,
  std::size_t count, int samples);

/**
 * Gives pixels without any trusted ray the mean of the nearest pixels that have one: ring by ring
 * inwards, each from its neighbours of the rings before. In every plane.
 */
MAMMORAYXRAY_EXPORT void FillFromNeighbours(std::vector<float>& planes, int columns, int rows,
  std::vector<std::size_t> holes);
}

#endif
