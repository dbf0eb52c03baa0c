// SPDX-License-Identifier: Apache-2.0
#include "Private/ProjectionReadout.h"

#include <algorithm>
#include <utility>

namespace mammoray
{
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
}
