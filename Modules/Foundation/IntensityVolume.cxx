// SPDX-License-Identifier: Apache-2.0
#include "IntensityVolume.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mammoray
{
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
