// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_GlandOverlap_h
#define mammoray_Validation_GlandOverlap_h

#include "ValidationRuns.h"

class vtkUnstructuredGrid;

namespace mammoray
{
/// Dice coefficients of gland with the true gland, counted in cubes of 0.8 mm of the gantry frame
/// of which at least half is gland.
struct GlandOverlap
{
  double Registered = 0;
  /// Of the uncompressed gland.
  double AtRest = 0;
};

/**
 * Compares the registered gland with the one in the truth's volume; what lies outside that volume
 * is not counted. `uncompressed`: the uncompressed body with the point array "Displacement" (mm).
 * Throws InputError if a volume cannot be read.
 */
GlandOverlap MeasureGland(const LandmarkCase& input, const RegistrationCaseResult& result,
  vtkUnstructuredGrid* uncompressed);
}

#endif
