// SPDX-License-Identifier: Apache-2.0
#include "Private/VelocityFields.h"

#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace mammoray
{
namespace
{
/// What is worth a core of its own: a tenth of a millisecond.
constexpr std::size_t PointsAtOnce = 1u << 15;
constexpr std::size_t PixelsAtOnce = 1u << 18;
}

int FieldsPerPass(int fields, int most)
{
  const int passes = (fields + most - 1) / most;
  return (fields + passes - 1) / passes;
}

void PrepareDerivatives(const XRayDetector& detector, int materials, int fields,
  PathLengthDerivatives& derivatives)
{
  derivatives.Columns = detector.Columns;
  derivatives.Rows = detector.Rows;
  derivatives.Materials = materials;
  derivatives.Fields = fields;
  derivatives.Lengths.resize(static_cast<std::size_t>(fields) *
    static_cast<std::size_t>(materials) * detector.NumberOfPixels());
}

double LargestSpeed(std::span<const double> field)
{
  const double* first = field.data();
  std::atomic<double> largest = 0;
  ParallelRanges(field.size() / 3, PointsAtOnce,
    [&](std::size_t begin, std::size_t end)
    {
      double own = 0;
      for (const double* velocity = first + 3 * begin; velocity != first + 3 * end; velocity += 3)
      {
        own = std::max(own,
          velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]);
      }
      for (double known = largest; own > known && !largest.compare_exchange_weak(known, own);)
      {
      }
    });
  return std::sqrt(largest);
}

void WriteVelocities(const VectorFields& velocities, const FieldBatch& batch, float* target)
{
  const auto first = static_cast<std::size_t>(batch.First);
  const auto count = static_cast<std::size_t>(batch.Count);
  ParallelRanges(velocities.Length / 3, PointsAtOnce / count,
    [&](std::size_t begin, std::size_t end)
    {
      float* value = target + 3 * count * begin;
      for (std::size_t point = begin; point < end; ++point)
      {
        for (std::size_t field = 0; field < count; ++field)
        {
          const double* velocity = &velocities[first + field][3 * point];
          for (std::size_t axis = 0; axis < 3; ++axis)
          {
            *value++ = static_cast<float>(batch.Factor[field] * velocity[axis]);
          }
        }
      }
    });
}

void ReadRates(const float* rates, const FieldBatch& batch, const PixelRange& range,
  PathLengthDerivatives& derivatives)
{
  const std::size_t pixelCount = static_cast<std::size_t>(derivatives.Rows) * derivatives.Columns;
  const auto materials = static_cast<std::size_t>(derivatives.Materials);
  float* target = derivatives.Lengths.data() +
    static_cast<std::size_t>(batch.First) * materials * pixelCount + range.First;
  for (std::size_t field = 0; field < static_cast<std::size_t>(batch.Count); ++field)
  {
    const auto unit = static_cast<float>(batch.Unit[field]);
    for (std::size_t material = 0; material < materials; ++material)
    {
      if (material == 0)
      {
        std::fill_n(target, range.Count, 0.0f); // air
      }
      else
      {
        ParallelRanges(range.Count, PixelsAtOnce,
          [=](std::size_t begin, std::size_t end)
          {
            std::transform(rates + begin, rates + end, target + begin,
              [unit](float rate) { return unit * rate; });
          });
      }
      rates += range.Count;
      target += pixelCount;
    }
  }
}
}
