// SPDX-License-Identifier: Apache-2.0
#include "LabelVolume.h"

#include "Error.h"

#include <sstream>

namespace mammoray
{
Vector3 LabelVolume::PointAt(double i, double j, double k) const
{
  return this->Origin + (i * this->Spacing[0]) * this->Direction[0] +
    (j * this->Spacing[1]) * this->Direction[1] + (k * this->Spacing[2]) * this->Direction[2];
}

Vector3 LabelVolume::ContinuousIndex(const Vector3& point) const
{
  // The axes are orthonormal (Validate), so the inverse of the direction matrix is its transpose.
  const Vector3 offset = point - this->Origin;
  return { Dot(offset, this->Direction[0]) / this->Spacing[0],
    Dot(offset, this->Direction[1]) / this->Spacing[1],
    Dot(offset, this->Direction[2]) / this->Spacing[2] };
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
  if (this->Voxels.size() != expected)
  {
    problem << "expected " << expected << " voxels, found " << this->Voxels.size();
    throw InputError(name + ": " + problem.str());
  }
}
}
