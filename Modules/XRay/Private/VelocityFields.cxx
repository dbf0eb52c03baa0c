// SPDX-License-Identifier: Apache-2.0
#include "Private/VelocityFields.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
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
    static_cast<std::size_t>(materials) * static_cast<std::size_t>(detector.Columns) *
    static_cast<std::size_t>(detector.Rows));
}

double LargestSpeed(const std::vector<double>& velocities, std::size_t pointCount, int field)
{
  const double* velocity = velocities.data() + static_cast<std::size_t>(field) * 3 * pointCount;
  double largest = 0;
  for (const double* end = velocity + 3 * pointCount; velocity != end; velocity += 3)
  {
    largest = std::max(largest,
      velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]);
  }
  return std::sqrt(largest);
}

void WriteVelocities(const std::vector<double>& velocities, std::size_t pointCount,
  const FieldBatch& batch, float* target)
{
  const auto first = static_cast<std::size_t>(batch.First);
  const auto count = static_cast<std::size_t>(batch.Count);
  for (std::size_t point = 0; point < pointCount; ++point)
  {
    for (std::size_t field = 0; field < count; ++field)
    {
      const double* velocity = &velocities[((first + field) * pointCount + point) * 3];
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        *target++ = static_cast<float>(batch.Factor[field] * velocity[axis]);
      }
    }
  }
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
        std::transform(rates, rates + range.Count, target,
          [unit](float rate) { return unit * rate; });
      }
      rates += range.Count;
      target += pixelCount;
    }
  }
}
}
