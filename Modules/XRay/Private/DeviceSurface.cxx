// SPDX-License-Identifier: Apache-2.0
#include "Private/DeviceSurface.h"

#include <algorithm>
#include <string>

namespace mammoray
{
void DeviceSurface::Set(const VulkanDevice& device, const SurfaceMesh& mesh,
  const std::vector<std::uint32_t>& order, bool doubles, vk::BufferUsageFlags usage)
{
  const std::uint64_t positionBytes =
    mesh.Points.size() * (doubles ? sizeof(double) : sizeof(float));
  const std::uint64_t triangleBytes = mesh.Triangles.size() * sizeof(std::uint32_t);
  if (std::max(positionBytes, triangleBytes) > device.Limits().maxStorageBufferRange)
  {
    throw DeviceError("Vulkan: " + std::to_string(mesh.NumberOfTriangles()) + " triangles and " +
      std::to_string(mesh.NumberOfPoints()) + " points are more than " + device.Name() +
      " takes in one buffer");
  }
  this->PointCount = mesh.NumberOfPoints();
  this->TriangleCount = static_cast<std::uint32_t>(mesh.NumberOfTriangles());
  this->MaterialCount = static_cast<std::uint32_t>(mesh.NumberOfMaterials());
  Reserve(this->Positions, device, positionBytes, usage, MemoryUse::Upload);
  Reserve(this->Triangles, device, triangleBytes, usage, MemoryUse::Upload);
  Reserve(this->Materials, device, triangleBytes / 3, usage, MemoryUse::Upload);
  this->Move(mesh.Points, doubles);
  std::uint32_t* triangles = this->Triangles.Data<std::uint32_t>();
  std::uint32_t* materials = this->Materials.Data<std::uint32_t>();
  for (std::uint32_t place = 0; place < this->TriangleCount; ++place)
  {
    const std::uint32_t triangle = order.empty() ? place : order[place];
    triangles = std::copy_n(&mesh.Triangles[3 * std::size_t{ triangle }], 3, triangles);
    *materials++ = mesh.FrontMaterials[triangle] |
      static_cast<std::uint32_t>(mesh.BackMaterials[triangle]) << 16;
  }
}

void DeviceSurface::Move(const std::vector<double>& points, bool doubles)
{
  this->Bounds = {};
  for (std::size_t index = 0; index < points.size(); index += 3)
  {
    this->Bounds.Add(Vector3{ points[index], points[index + 1], points[index + 2] });
  }
  this->Center = 0.5 * (this->Bounds.Low + this->Bounds.High);
  if (doubles)
  {
    this->WriteLocal(points, this->Positions.Data<double>());
  }
  else
  {
    this->WriteLocal(points, this->Positions.Data<float>());
  }
}
}
