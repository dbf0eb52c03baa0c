// SPDX-License-Identifier: Apache-2.0
#include "Private/ProjectionHelpers.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

void CheckRays(const std::vector<XRayLine>& rays)
{
  if (rays.empty() || rays.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
  {
    throw InputError(
      "projector: expected 1 to 2^31 - 1 rays, found " + std::to_string(rays.size()));
  }
  for (std::size_t ray = 0; ray < rays.size(); ++ray)
  {
    const auto& [begin, end] = rays[ray];
    if (!IsFinite(begin) || !IsFinite(end) || !(Norm(end - begin) > 0))
    {
      throw InputError("projector: ray " + std::to_string(ray) +
        ": expected two different finite points, found " + Text(begin) + " and " + Text(end) +
        " mm");
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

void CheckVelocities(const std::vector<double>& velocities, int fields, std::size_t pointCount)
{
  if (fields < 1 || velocities.size() != 3 * pointCount * static_cast<std::size_t>(fields))
  {
    throw InputError("projector: expected velocities of " + std::to_string(pointCount) +
      " points in at least one field, 3 values each, found " + std::to_string(velocities.size()) +
      " values for " + std::to_string(fields) + " fields");
  }
  for (std::size_t index = 0; index < velocities.size(); ++index)
  {
    if (!std::isfinite(velocities[index]))
    {
      throw InputError("projector: field " + std::to_string(index / (3 * pointCount)) + ", point " +
        std::to_string(index / 3 % pointCount) + ": expected a finite velocity, found " +
        std::to_string(velocities[index]));
    }
  }
}

int FieldsAtOnce(int fields, int most)
{
  if (most < 1)
  {
    return 0;
  }
  const int passes = (fields + most - 1) / most;
  return (fields + passes - 1) / passes;
}

void PrepareDerivatives(const PathLengthImage& image, int fields,
  PathLengthDerivatives& derivatives)
{
  derivatives.Columns = image.Columns;
  derivatives.Rows = image.Rows;
  derivatives.Materials = image.Materials;
  derivatives.Fields = fields;
  derivatives.Lengths.resize(static_cast<std::size_t>(fields) *
    static_cast<std::size_t>(image.Materials) * image.NumberOfPixels());
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

void WriteVelocities(const std::vector<double>& velocities, std::size_t pointCount, int first,
  const std::vector<double>& factors, float* target)
{
  const std::size_t count = factors.size();
  for (std::size_t point = 0; point < pointCount; ++point)
  {
    for (std::size_t field = 0; field < count; ++field)
    {
      const double* velocity =
        &velocities[((static_cast<std::size_t>(first) + field) * pointCount + point) * 3];
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        *target++ = static_cast<float>(factors[field] * velocity[axis]);
      }
    }
  }
}

std::vector<std::size_t> ReadImage(const ProjectionOutput& output, const XRayDetector& detector,
  PathLengthImage& image)
{
  const std::size_t pixelCount = image.NumberOfPixels();
  const std::size_t valueCount = pixelCount * static_cast<std::size_t>(image.Materials);
  image.Lengths.reserve(valueCount);
  image.Lengths.assign(pixelCount, 0.0f); // air
  image.Lengths.insert(image.Lengths.end(), output.Lengths + pixelCount,
    output.Lengths + valueCount);
  image.Inconsistent.resize(pixelCount);
  const auto samples = static_cast<std::uint32_t>(detector.Samples * detector.Samples);
  std::vector<std::size_t> holes;
  for (std::size_t pixel = 0; pixel < pixelCount; ++pixel)
  {
    image.Inconsistent[pixel] = output.Failures[pixel] > 0 ? 1 : 0;
    if (output.Failures[pixel] == samples)
    {
      holes.push_back(pixel);
    }
  }
  return holes;
}

void ReadRates(const float* rates, int first, const std::vector<double>& factors,
  PathLengthDerivatives& derivatives)
{
  const std::size_t pixelCount = static_cast<std::size_t>(derivatives.Rows) * derivatives.Columns;
  const std::size_t fieldSize = pixelCount * static_cast<std::size_t>(derivatives.Materials);
  for (std::size_t field = 0; field < factors.size(); ++field)
  {
    float* target =
      derivatives.Lengths.data() + (static_cast<std::size_t>(first) + field) * fieldSize;
    std::fill_n(target, pixelCount, 0.0f); // air
    const float* source = rates + field * fieldSize;
    const auto factor = static_cast<float>(factors[field]);
    for (std::size_t index = pixelCount; index < fieldSize; ++index)
    {
      target[index] = factor * source[index];
    }
  }
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

vk::raii::ShaderModule Module(const VulkanDevice& device, const uint32_t* words, std::size_t bytes)
{
  return vk::raii::ShaderModule(device.Device(), vk::ShaderModuleCreateInfo({}, bytes, words));
}
}
