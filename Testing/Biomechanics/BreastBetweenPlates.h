// SPDX-License-Identifier: Apache-2.0
// A breast of plain shape and the plates of a unit around it.
#ifndef mammoray_Testing_BreastBetweenPlates_h
#define mammoray_Testing_BreastBetweenPlates_h

#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"

#include <cmath>

namespace mammoray::test
{
inline CompressionOptions WithElement(ElementType type, double tolerance)
{
  CompressionOptions options;
  options.Element = type;
  options.RelativeTolerance = tolerance;
  return options;
}

/// Half axes 40, 45, 38 mm: 5.6 mm of chest wall, then the breast; x lateral, y anterior, z up.
inline CompressionSimulation MakeBreast(const CompressionOptions& options = {}, double nu = 0.49,
  int count = 6)
{
  return CompressionSimulation(MakeHalfEllipsoidMesh(40, 45, 38, count),
    { {}, { 6, nu }, { 5, nu } }, { false, false, true }, {}, options);
}

/// Closed to `thicknessMm` about z = 0, the edges 15 mm in front of y = 0.
inline PlatePair MakePlates(double thicknessMm, double rollDeg = 0)
{
  VolumeFromGantry placed;
  const double c = std::cos(rollDeg * M_PI / 180), s = std::sin(rollDeg * M_PI / 180);
  placed.X = { c, 0, -s };
  placed.Z = { s, 0, c };
  placed.Origin = Vector3{ 0, 20, 0 } - (0.5 * thicknessMm) * placed.Z;
  MammographyUnit unit;
  unit.SupportHeightMm = 0;
  return PlatesOf(placed, unit, thicknessMm);
}
}

#endif
