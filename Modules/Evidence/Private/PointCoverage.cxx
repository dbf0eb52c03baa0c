// SPDX-License-Identifier: Apache-2.0
#include "Private/PointCoverage.h"

#include "mammoray/Foundation/Error.h"

#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
std::optional<std::array<double, 9>> CovarianceAt(const RegisteredBreast& breast,
  const Vector3& point)
{
  try
  {
    return breast.ToMammogram(point).Covariance;
  }
  catch (const InputError&) // outside the mesh
  {
    return std::nullopt;
  }
}
}

void PointCoverage::Add(const Vector3& point, const Vector3& error)
{
  const auto covariance = CovarianceAt(this->Breast, point);
  for (std::size_t axis = 0; covariance && axis < 3; ++axis)
  {
    this->All += 1;
    this->Within += std::abs(error[axis]) <= 2 * std::sqrt((*covariance)[4 * axis]) ? 1 : 0;
  }
}

double PointCoverage::Share() const
{
  return this->All > 0 ? this->Within / this->All : std::numeric_limits<double>::quiet_NaN();
}
}
