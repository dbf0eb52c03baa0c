// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/IntensityVolume.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mammoray
{
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
