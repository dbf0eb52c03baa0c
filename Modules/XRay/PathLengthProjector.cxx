// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/PathLengthProjector.h"

#include "Private/PriorityProjector.h"
#include "Private/RasterisationProjector.h"
#include "Private/RayTracingProjector.h"

#include <algorithm>
#include <array>
#include <utility>

namespace mammoray
{
namespace
{
using Method = ProjectorOptions::Method;

constexpr std::array<std::pair<Method, const char*>, 3> MethodNames{ {
  { Method::Auto, "auto" },
  { Method::RayTracing, "ray-tracing" },
  { Method::Rasterisation, "rasterisation" },
} };
}

std::size_t PathLengthImage::NumberOfInconsistentRays() const
{
  return static_cast<std::size_t>(std::count(this->Inconsistent.begin(), this->Inconsistent.end(),
    static_cast<unsigned char>(1)));
}

std::string PathLengthImage::InconsistencyWarning() const
{
  const std::size_t count = this->NumberOfInconsistentRays();
  if (count == 0)
  {
    return {};
  }
  int left = this->Columns;
  int right = -1;
  int top = this->Rows;
  int bottom = -1;
  for (int row = 0; row < this->Rows; ++row)
  {
    for (int column = 0; column < this->Columns; ++column)
    {
      if (this->Inconsistent[static_cast<std::size_t>(row) * this->Columns + column] != 0)
      {
        left = std::min(left, column);
        right = std::max(right, column);
        top = std::min(top, row);
        bottom = row;
      }
    }
  }
  return std::to_string(count) + " pixels in columns " + std::to_string(left) + " to " +
    std::to_string(right) + " and rows " + std::to_string(top) + " to " + std::to_string(bottom) +
    " see a mesh that does not close (holes, or triangles that are doubled or turned); they are "
    "estimated from their neighbours and marked in Consistency";
}

std::string MethodName(Method method)
{
  for (const auto& [known, name] : MethodNames)
  {
    if (known == method)
    {
      return name;
    }
  }
  return "unknown";
}

Method MethodFromName(const std::string& name)
{
  for (const auto& [method, known] : MethodNames)
  {
    if (known == name)
    {
      return method;
    }
  }
  throw InputError("projector: expected auto, ray-tracing or rasterisation, found '" + name + "'");
}

std::unique_ptr<PathLengthProjector> MakeProjector(const ProjectorOptions& options)
{
  return WithDeviceErrors(
    [&]() -> std::unique_ptr<PathLengthProjector>
    {
      auto device = std::make_unique<VulkanDevice>(options);
      std::unique_ptr<PathLengthProjector> projector;
      if (device->TracesRays())
      {
        projector = std::make_unique<RayTracingProjector>(std::move(device), options);
      }
      else
      {
        projector = std::make_unique<RasterisationProjector>(std::move(device), options);
      }
      if (options.Priority.empty())
      {
        return projector;
      }
      return std::make_unique<PriorityProjector>(std::move(projector), options.Priority);
    });
}
}
