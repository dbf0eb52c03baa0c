// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DualEnergy_h
#define mammoray_DualEnergy_h

#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/Exposure.h"
#include "mammorayXRayModule.h"

#include <vector>

namespace mammoray
{
/**
 * The weight w of weighted logarithmic subtraction, A_high - w A_low with A = -ln I / I0 (Lewin et
 * al., Radiology 229, 2003), with which materials `a` and `b` look the same: slabs of `thicknessMm`
 * of either give equal values. With single energies w = (mu_a - mu_b)(high) / (mu_a - mu_b)(low) at
 * any thickness. Throws InputError unless the beams have both materials, these differ at low energy
 * and the thickness is positive.
 */
MAMMORAYXRAY_EXPORT double CancellingWeight(const Beam& low, const Beam& high, int a, int b,
  double thicknessMm);

/// A_high - w A_low of each pixel. Throws InputError if the exposures differ in size.
MAMMORAYXRAY_EXPORT std::vector<float> Recombine(const Exposure& low, const Exposure& high,
  double weight);
}

#endif
