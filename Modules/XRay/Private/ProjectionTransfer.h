// SPDX-License-Identifier: Apache-2.0
// Velocity fields on their way to the device; path lengths and their derivatives on their way back.
#ifndef mammoray_ProjectionTransfer_h
#define mammoray_ProjectionTransfer_h

#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/// The pixels [First, First + Count) of an image, row by row.
struct PixelRange
{
  std::size_t First = 0;
  std::size_t Count = 0;
};

/// Results of a pass over some pixels: planes with one value per pixel.
struct ProjectionOutput
{
  /// mm, a plane for each material; that of air is not written.
  const float* Lengths = nullptr;
  /// Number of failed samples of each pixel; null if none failed.
  const std::uint32_t* Failures = nullptr;
};

/**
 * Copies the results for a range of pixels, samples x samples rays each, into an image whose
 * Columns, Rows and Materials are set, and resizes its arrays. Returns the pixels of the range that
 * have no consistent ray, for FillFromNeighbours.
 */
MAMMORAYXRAY_EXPORT std::vector<std::size_t> ReadLengths(const ProjectionOutput& output,
  const PixelRange& range, int samples, PathLengthImage& image);

/// The pixels among the first `count` of which all samples x samples rays failed.
MAMMORAYXRAY_EXPORT std::vector<std::size_t> FindHoles(const std::uint32_t* failures,
  std::size_t count, int samples);

/**
 * Sets pixels without a consistent ray to the mean of their neighbours, in every plane. Holes are
 * filled ring by ring, from their borders inwards.
 */
MAMMORAYXRAY_EXPORT void FillFromNeighbours(std::vector<float>& planes, int columns, int rows,
  std::vector<std::size_t> holes);

/// Largest number of velocity fields per pass.
constexpr int MostFieldsPerPass = 8;

/// The fields [First, First + Count) of a pass. The device receives each field multiplied by its
/// Factor; its results multiplied by Unit are mm per unit of the parameter.
struct FieldBatch
{
  int First = 0;
  int Count = 0;
  std::array<double, MostFieldsPerPass> Factor{ 1, 1, 1, 1, 1, 1, 1, 1 };
  std::array<double, MostFieldsPerPass> Unit{ 1, 1, 1, 1, 1, 1, 1, 1 };
};

/// Number of fields per pass, at most `most` (at least 1), so that passes are equal if possible.
MAMMORAYXRAY_EXPORT int FieldsPerPass(int fields, int most);

/// Sizes the derivatives of an image of so many materials.
MAMMORAYXRAY_EXPORT void PrepareDerivatives(const XRayDetector& detector, int materials, int fields,
  PathLengthDerivatives& derivatives);

/// Largest speed of a field, mm per unit of its parameter.
MAMMORAYXRAY_EXPORT double LargestSpeed(std::span<const double> field);

/// Writes the fields of a batch in the devices' order, value[(point * Count + field) * 3 + axis],
/// each times its factor.
MAMMORAYXRAY_EXPORT void WriteVelocities(const VectorFields& velocities, const FieldBatch& batch,
  float* target);

/// Copies the rates of a batch, planes of field and material of range.Count values each, to a range
/// of the pixels, each field times its unit.
MAMMORAYXRAY_EXPORT void ReadRates(const float* rates, const FieldBatch& batch,
  const PixelRange& range, PathLengthDerivatives& derivatives);

/// Writes the losses of a range of pixels, planes of each material, times `units`.
MAMMORAYXRAY_EXPORT void WriteLosses(const std::vector<float>& losses, std::size_t pixels,
  const PixelRange& range, double units, float* target);
}

#endif
