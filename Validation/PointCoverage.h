// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_PointCoverage_h
#define mammoray_Validation_PointCoverage_h

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

  /// `point`: in the volume frame, mm; `error`: found minus true position in the gantry frame, mm.
  /// A point more than a millimetre outside the mesh is not counted.
  void Add(const Vector3& point, const Vector3& error);
  /// Fraction of the counted coordinates, [0, 1]; NaN if there are none.
  double Share() const;

  /// Of each counted coordinate: the factor on the model's own error (ModelErrorMm) that makes two
  /// standard deviations cover its error. 0: the covariance of the parameters alone does.
  std::vector<double> ModelErrorNeeded;

private:
  RegisteredBreast Breast;
  double Within = 0;
  double All = 0;
};
}

#endif
