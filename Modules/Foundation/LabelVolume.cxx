// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/LabelVolume.h"

namespace mammoray
{
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
}
