// SPDX-License-Identifier: Apache-2.0
#include "PointCoverage.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
std::optional<ImagedPoint> PlaceOf(const RegisteredBreast& breast, const Vector3& point)
{
  try
  {
    return breast.ToMammogram(point);
  }
  catch (const InputError&) // outside the mesh
  {
    return std::nullopt;
  }
}
}

void PointCoverage::Add(const Vector3& point, const Vector3& error)
{
  const std::optional<ImagedPoint> found = PlaceOf(this->Breast, point);
  for (std::size_t axis = 0; found && found->Covariance && axis < 3; ++axis)
  {
    const double variance = (*found->Covariance)[4 * axis];
    const double own = found->ModelSigmaMm * found->ModelSigmaMm;
    this->All += 1;
    this->Within += std::abs(error[axis]) <= 2 * std::sqrt(variance) ? 1 : 0;
    this->ModelErrorNeeded.push_back(
      std::sqrt(std::max(0.0, 0.25 * error[axis] * error[axis] - (variance - own)) / own));
  }
}

double PointCoverage::Share() const
{
  return this->All > 0 ? this->Within / this->All : std::numeric_limits<double>::quiet_NaN();
}
}
