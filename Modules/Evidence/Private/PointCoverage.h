// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_PointCoverage_h
#define mammoray_Private_PointCoverage_h

#include "mammoray/Study/RegisteredBreast.h"

#include <vector>

namespace mammoray
{
/// Counts the coordinates of points that were found within two of their standard deviations.
class PointCoverage
{
public:
  explicit PointCoverage(const BreastInUnit& breast)
    : Breast(breast)
  {
  }

  /// `point`: of the volume; `error`: by how much it was found elsewhere, gantry frame, mm. A point
  /// that the mesh leaves out by more than a millimetre does not count.
  void Add(const Vector3& point, const Vector3& error);
  /// Of those that count, [0, 1]; NaN of none.
  double Share() const;

  /// Of each coordinate: what the model's own error (ModelErrorMm of Case) must be multiplied by
  /// for it to be within two deviations. 0: it is by the covariance of the parameters alone.
  std::vector<double> ModelErrorNeeded;

private:
  RegisteredBreast Breast;
  double Within = 0;
  double All = 0;
};
}

#endif
