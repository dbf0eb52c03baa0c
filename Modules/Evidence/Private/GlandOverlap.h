// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_GlandOverlap_h
#define mammoray_GlandOverlap_h

#include "mammoray/Evidence/RegistrationEvidence.h"

class vtkUnstructuredGrid;

namespace mammoray
{
/// Dice's coefficients of gland with the true gland, counted in cubes of 0.8 mm of the gantry frame
/// that are gland by at least half.
struct GlandOverlap
{
  double Registered = 0;
  /// Of the uncompressed gland.
  double AtRest = 0;
};

/**
 * Compares where a registration puts the gland with where the truth's volume shows it; what lies
 * beyond that volume does not count. `uncompressed`: the uncompressed body with the point array
 * "Displacement" (mm). Throws InputError where a volume cannot be read.
 */
GlandOverlap MeasureGland(const EvidenceLandmarks& input, const RegistrationCaseResult& result,
  vtkUnstructuredGrid* uncompressed);
}

#endif
