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
 * The weight w by which two exposures of the same lengths, at low and high energy, are recombined
 * to A_high - w A_low (A = -ln I / I0; weighted logarithmic subtraction, Lewin et al., Radiology
 * 229, 2003) so that materials `a` and `b` look the same: a slab of `thicknessMm` of the one and
 * one of the other differ by nothing. With single energies w = (mu_a - mu_b at the high one) /
 * (mu_a - mu_b at the low one), at any thickness. Throws InputError unless both are materials of
 * the beams that differ at low energy, and the thickness is positive.
 */
MAMMORAYXRAY_EXPORT double CancellingWeight(const Beam& low, const Beam& high, int a, int b,
  double thicknessMm);

/// A_high - w A_low of each pixel. Throws InputError where they are of different sizes.
MAMMORAYXRAY_EXPORT std::vector<float> Recombine(const Exposure& low, const Exposure& high,
  double weight);
}

#endif
