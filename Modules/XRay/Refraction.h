// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Refraction_h
#define mammoray_Refraction_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * The decrement delta of the refractive index n = 1 - delta of a composition (see FindComposition),
 * from xraylib's scattering factors. Density 0 is the composition's nominal one. Throws InputError
 * on an unknown composition and if xraylib has no value.
 */
MAMMORAYXRAY_EXPORT double RefractiveDecrement(const std::string& composition, double energyKeV,
  double densityGPerCm3 = 0);

/**
 * The decrements that Refract takes with a beam of `count` materials: at the energies of the
 * spectrum that have photons, of the materials that are `used`; 0 for others. Throws InputError,
 * with the material's name, where its Attenuation is no composition.
 */
MAMMORAYXRAY_EXPORT std::vector<double> RefractiveDecrements(const Spectrum& spectrum,
  const MaterialTable& materials, int count, const std::vector<bool>& used);

/**
 * Projects the projector's surface of `pointCount` points with the derivatives of its path lengths
 * with respect to shifts of the body along the detector's columns and rows: two velocity fields in
 * one pass. A ray is bent by alpha = -grad sum_m delta_m L_m, the gradient across the ray, away
 * from thicker parts of a body, whose index is below 1. Two derivatives give the whole vector,
 * since a shift along the ray changes nothing. The result has Deflection and no noise.
 *
 * `decrements[e * beam.NumberOfMaterials() + m]`: delta of material m at the energy of
 * beam.EnergyWeights()[e]. detector.Samples^2 rays per pixel are followed, also up to 16 pixels
 * beyond the detector's edges. Where a ray grazes a surface, its deflection is bounded (see
 * PathLengthDerivatives). Rays are bent once, to first order in delta: the error is of order
 * delta^2.
 *
 * Throws InputError on options out of range and on a wrong number of decrements.
 */
MAMMORAYXRAY_EXPORT Exposure Refract(PathLengthProjector& projector, std::size_t pointCount,
  const XRaySource& source, const XRayDetector& detector, const Beam& beam,
  const std::vector<double>& decrements, const RefractionOptions& options,
  const ProgressCallback& progress = {});
}

#endif
