// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Volumes.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

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

std::uint16_t LabelVolume::LabelAt(const Vector3& point) const
{
  const Vector3 index = this->ContinuousIndex(point);
  int voxel[3];
  for (int a = 0; a < 3; ++a)
  {
    const double rounded = std::floor(index[a] + 0.5);
    if (!(rounded >= 0 && rounded < this->Size[a])) // also false for NaN
    {
      return 0;
    }
    voxel[a] = static_cast<int>(rounded);
  }
  return this->Voxels[this->Index(voxel[0], voxel[1], voxel[2])];
}

std::map<int, std::size_t> LabelVolume::CountLabels() const
{
  std::vector<std::size_t> histogram(65536, 0);
  for (const std::uint16_t label : this->Voxels)
  {
    ++histogram[label];
  }
  std::map<int, std::size_t> counts;
  for (std::size_t label = 0; label < histogram.size(); ++label)
  {
    if (histogram[label] > 0)
    {
      counts[static_cast<int>(label)] = histogram[label];
    }
  }
  return counts;
}

void LabelVolume::Validate(const std::string& name) const
{
  this->ValidateGrid(name, this->Voxels.size());
}

std::optional<float> IntensityVolume::ValueAt(const Vector3& point) const
{
  const Vector3 index = this->ContinuousIndex(point);
  int low[3];
  int high[3];
  double part[3];
  for (int a = 0; a < 3; ++a)
  {
    const int last = this->Size[a] - 1;
    if (!(index[a] >= -0.5 && index[a] <= last + 0.5))
    {
      return std::nullopt;
    }
    const double inside = std::clamp(index[a], 0.0, static_cast<double>(last));
    low[a] = static_cast<int>(inside);
    high[a] = std::min(low[a] + 1, last);
    part[a] = inside - low[a];
  }
  double value = 0;
  for (int corner = 0; corner < 8; ++corner)
  {
    int at[3];
    double weight = 1;
    for (int a = 0; a < 3; ++a)
    {
      const bool upper = (corner >> a) & 1;
      at[a] = upper ? high[a] : low[a];
      weight *= upper ? part[a] : 1 - part[a];
    }
    value += weight * this->Voxels[this->Index(at[0], at[1], at[2])];
  }
  return static_cast<float>(value);
}

void IntensityVolume::Validate(const std::string& name) const
{
  this->ValidateGrid(name, this->Voxels.size());
  const auto bad = std::find_if(this->Voxels.begin(), this->Voxels.end(),
    [](float value) { return !std::isfinite(value); });
  if (bad != this->Voxels.end())
  {
    const auto index = static_cast<std::size_t>(bad - this->Voxels.begin());
    throw InputError(name + ": " + this->VoxelName(index) + " holds " + std::to_string(*bad) +
      ", expected a finite number");
  }
}
}
