// SPDX-License-Identifier: Apache-2.0
#include "ProjectionHelpers.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mammoray
{
namespace
{
bool IsFinite(const Vector3& vector)
{
  return std::isfinite(vector[0]) && std::isfinite(vector[1]) && std::isfinite(vector[2]);
}

std::string Text(const Vector3& vector)
{
  return "(" + std::to_string(vector[0]) + ", " + std::to_string(vector[1]) + ", " +
    std::to_string(vector[2]) + ")";
}
}

void CheckGeometry(const XRaySource& source, const XRayDetector& detector)
{
  if (detector.Columns < 1 || detector.Rows < 1 || detector.Columns > 65535 ||
    detector.Rows > 65535)
  {
    throw InputError("detector: expected 1 to 65535 columns and rows, found " +
      std::to_string(detector.Columns) + " x " + std::to_string(detector.Rows));
  }
  if (detector.Samples < 1 || detector.Samples > 16)
  {
    throw InputError(
      "detector: expected 1 to 16 samples, found " + std::to_string(detector.Samples));
  }
  const Vector3 normal = Cross(detector.ColumnStep, detector.RowStep);
  const double area = Norm(normal);
  if (!IsFinite(detector.Origin) || !std::isfinite(area) ||
    !(area > 1e-9 * Norm(detector.ColumnStep) * Norm(detector.RowStep)))
  {
    throw InputError(
      "detector: expected finite coordinates and steps that span a plane, found origin " +
      Text(detector.Origin) + ", column step " + Text(detector.ColumnStep) + ", row step " +
      Text(detector.RowStep) + " mm");
  }
  if (source.Type == XRaySource::Kind::Point)
  {
    const double distance = Dot(source.Position - detector.Origin, normal) / area;
    const double step = std::max(Norm(detector.ColumnStep), Norm(detector.RowStep));
    if (!IsFinite(source.Position) || !(std::abs(distance) > 1e-6 * step))
    {
      throw InputError("source: expected a position off the detector's plane, found " +
        Text(source.Position) + " mm");
    }
  }
  else
  {
    const double length = Norm(source.Direction);
    if (!std::isfinite(length) || !(std::abs(Dot(source.Direction, normal)) > 1e-9 * length * area))
    {
      throw InputError("source: expected a direction that crosses the detector's plane, found " +
        Text(source.Direction));
    }
  }
}

void CheckMovedPoints(const std::vector<double>& points, std::size_t pointCount)
{
  if (points.size() != 3 * pointCount)
  {
    throw InputError("projector: expected " + std::to_string(3 * pointCount) +
      " coordinates of the surface's points, found " + std::to_string(points.size()));
  }
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    if (!std::isfinite(points[index]))
    {
      throw InputError("projector: point " + std::to_string(index / 3) +
        ": expected finite coordinates, found " + std::to_string(points[index]));
    }
  }
}

void FillFromNeighbours(PathLengthImage& image, std::vector<std::size_t> holes)
{
  const std::size_t pixelCount = image.NumberOfPixels();
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
      const int row = static_cast<int>(pixel / image.Columns);
      const int column = static_cast<int>(pixel % image.Columns);
      std::vector<std::size_t> neighbours;
      for (int r = std::max(row - 1, 0); r <= std::min(row + 1, image.Rows - 1); ++r)
      {
        for (int c = std::max(column - 1, 0); c <= std::min(column + 1, image.Columns - 1); ++c)
        {
          const std::size_t neighbour = static_cast<std::size_t>(r) * image.Columns + c;
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
      for (int material = 1; material < image.Materials; ++material)
      {
        float* lengths = image.Lengths.data() + material * pixelCount;
        double sum = 0;
        for (const std::size_t neighbour : neighbours)
        {
          sum += lengths[neighbour];
        }
        lengths[pixel] = static_cast<float>(sum / static_cast<double>(neighbours.size()));
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

vk::raii::ShaderModule Module(const VulkanDevice& device, const uint32_t* words, std::size_t bytes)
{
  return vk::raii::ShaderModule(device.Device(), vk::ShaderModuleCreateInfo({}, bytes, words));
}
}
