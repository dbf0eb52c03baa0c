// SPDX-License-Identifier: Apache-2.0
#include "Private/ProjectionTransfer.h"

#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace mammoray
{
namespace
{
/// Work for one core that takes a tenth of a millisecond.
constexpr std::size_t PointsAtOnce = 1u << 15;
constexpr std::size_t PixelsAtOnce = 1u << 18;
}

std::vector<std::size_t> ReadLengths(const ProjectionOutput& output, const PixelRange& range,
  int samples, PathLengthImage& image)
{
  const std::size_t pixelCount = image.NumberOfPixels();
  const auto materials = static_cast<std::size_t>(image.Materials);
  if (range.Count == pixelCount)
  {
    // All at once: every value is written once, and none is set to 0 before.
    image.Lengths.reserve(materials * pixelCount);
    image.Lengths.assign(pixelCount, 0.0f); // air
    image.Lengths.insert(image.Lengths.end(), output.Lengths + pixelCount,
      output.Lengths + materials * pixelCount);
  }
  else
  {
    image.Lengths.resize(materials * pixelCount);
    for (std::size_t material = 1; material < materials; ++material)
    {
      std::copy_n(output.Lengths + material * range.Count, range.Count,
        image.Lengths.data() + material * pixelCount + range.First);
    }
  }
  image.Inconsistent.resize(pixelCount);
  if (!output.Failures)
  {
    return {};
  }
  std::transform(output.Failures, output.Failures + range.Count,
    image.Inconsistent.data() + range.First,
    [](std::uint32_t failed) -> unsigned char { return failed > 0 ? 1 : 0; });
  std::vector<std::size_t> holes = FindHoles(output.Failures, range.Count, samples);
  for (std::size_t& pixel : holes)
  {
    pixel += range.First;
  }
  return holes;
}

std::vector<std::size_t> FindHoles(const std::uint32_t* failures, std::size_t count, int samples)
{
  const auto most = static_cast<std::uint32_t>(samples * samples);
  std::vector<std::size_t> holes;
  for (std::size_t pixel = 0; pixel < count; ++pixel)
  {
    if (failures[pixel] == most)
    {
      holes.push_back(pixel);
    }
  }
  return holes;
}

void FillFromNeighbours(std::vector<float>& planes, int columns, int rows,
  std::vector<std::size_t> holes)
{
  if (holes.empty())
  {
    return;
  }
  const std::size_t pixelCount = static_cast<std::size_t>(rows) * columns;
  std::vector<unsigned char> known(pixelCount, 1);
  for (const std::size_t pixel : holes)
  {
    known[pixel] = 0;
  }
  while (!holes.empty())
  {
    std::vector<std::size_t> filled;
    std::vector<std::size_t> left;
    for (const std::size_t pixel : holes)
    {
      const int row = static_cast<int>(pixel / columns);
      const int column = static_cast<int>(pixel % columns);
      std::vector<std::size_t> neighbours;
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows - 1); ++r)
      {
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns - 1); ++c)
        {
          const std::size_t neighbour = static_cast<std::size_t>(r) * columns + c;
          if (known[neighbour] != 0)
          {
            neighbours.push_back(neighbour);
          }
        }
      }
      if (neighbours.empty())
      {
        left.push_back(pixel);
        continue;
      }
      for (std::size_t plane = 0; plane < planes.size(); plane += pixelCount)
      {
        double sum = 0;
        for (const std::size_t neighbour : neighbours)
        {
          sum += planes[plane + neighbour];
        }
        planes[plane + pixel] = static_cast<float>(sum / static_cast<double>(neighbours.size()));
      }
      filled.push_back(pixel);
    }
    if (filled.empty())
    {
      return; // no trusted pixel at all: zeros stay, everything is marked
    }
    for (const std::size_t pixel : filled)
    {
      known[pixel] = 1;
    }
    holes = std::move(left);
  }
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

void WriteLosses(const std::vector<float>& losses, std::size_t pixels, const PixelRange& range,
  double units, float* target)
{
  for (std::size_t plane = 0; plane < losses.size(); plane += pixels)
  {
    const float* from = losses.data() + plane + range.First;
    target = std::transform(from, from + range.Count, target,
      [units](float loss) { return static_cast<float>(units * loss); });
  }
}
}
