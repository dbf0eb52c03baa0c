// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/VolumeGrid.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace mammoray
{
std::string VolumeGrid::VoxelName(std::size_t index) const
{
  const auto columns = static_cast<std::size_t>(this->Size[0]);
  const auto rows = static_cast<std::size_t>(this->Size[1]);
  return "voxel (" + std::to_string(index % columns) + ", " +
    std::to_string(index / columns % rows) + ", " + std::to_string(index / columns / rows) + ")";
}

Vector3 VolumeGrid::PointAt(double i, double j, double k) const
{
  return this->Origin + (i * this->Spacing[0]) * this->Direction[0] +
    (j * this->Spacing[1]) * this->Direction[1] + (k * this->Spacing[2]) * this->Direction[2];
}

Vector3 VolumeGrid::ContinuousIndex(const Vector3& point) const
{
  // The axes are orthonormal (Validate), so the inverse of the direction matrix is its transpose.
  const Vector3 offset = point - this->Origin;
  return { Dot(offset, this->Direction[0]) / this->Spacing[0],
    Dot(offset, this->Direction[1]) / this->Spacing[1],
    Dot(offset, this->Direction[2]) / this->Spacing[2] };
}

std::size_t VolumeGrid::AxisAlong(const Vector3& direction) const
{
  const auto leads = [&direction](const Vector3& axis) { return std::abs(Dot(axis, direction)); };
  return static_cast<std::size_t>(
    std::max_element(this->Direction.begin(), this->Direction.end(),
      [&leads](const Vector3& a, const Vector3& b) { return leads(a) < leads(b); }) -
    this->Direction.begin());
}

void VolumeGrid::ValidateGrid(const std::string& name, std::size_t voxelCount) const
{
  std::ostringstream problem;
  std::size_t expected = 1;
  for (int a = 0; a < 3; ++a)
  {
    if (this->Size[a] < 1)
    {
      problem << "size along axis " << a << " is " << this->Size[a] << ", expected at least 1";
      throw InputError(name + ": " + problem.str());
    }
    if (!(this->Spacing[a] > 0) || !std::isfinite(this->Spacing[a]))
    {
      problem << "spacing along axis " << a << " is " << this->Spacing[a]
              << " mm, expected a positive number";
      throw InputError(name + ": " + problem.str());
    }
    if (!std::isfinite(this->Origin[a]))
    {
      problem << "origin component " << a << " is not a finite number";
      throw InputError(name + ": " + problem.str());
    }
    expected *= static_cast<std::size_t>(this->Size[a]);
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int b = a; b < 3; ++b)
    {
      // 1e-3: header cosines are often written with four digits.
      const double product = Dot(this->Direction[a], this->Direction[b]);
      if (!(std::abs(product - (a == b ? 1.0 : 0.0)) < 1e-3))
      {
        problem << "axes " << a << " and " << b << " have the scalar product " << product
                << ", expected orthonormal axes";
        throw InputError(name + ": " + problem.str());
      }
    }
  }
  if (voxelCount != expected)
  {
    problem << "expected " << expected << " voxels, found " << voxelCount;
    throw InputError(name + ": " + problem.str());
  }
}
}
