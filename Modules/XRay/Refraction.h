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
 * delta of the refractive index n = 1 - delta of a composition (see FindComposition), from
 * xraylib's scattering factors. `densityGPerCm3` 0 takes the composition's own. Throws InputError
 * on a text that is no composition and where xraylib has no value.
 */
MAMMORAYXRAY_EXPORT double RefractiveDecrement(const std::string& composition, double energyKeV,
  double densityGPerCm3 = 0);

/**
 * Those of the table's materials, by what they are called in it as attenuation, at the energies of
 * a spectrum with photons: as Refract takes them of a beam of both. Throws InputError, with the
 * material, where that is no composition.
 */
MAMMORAYXRAY_EXPORT std::vector<double> RefractiveDecrements(const Spectrum& spectrum,
  const MaterialTable& materials);

struct MAMMORAYXRAY_EXPORT RefractionOptions
{
  enum class Law
  {
    /// Geometric optics: every ray carries its intensity to where it goes.
    Geometric,
    /// The near field of the transport of intensity: the intensity T and the displacement s that
    /// rays have at the detector make T - div(T s).
    NearField
  };
  Law Method = Law::Geometric;
  /**
   * From the plane in which rays are bent, parallel to the detector, to the detector, mm; not
   * negative. Bodies are taken to be thin before it. Of a point source at a distance z1 before that
   * plane, the magnification (z1 + z2) / z1 of the displacement is in the detector's coordinates.
   */
  double DistanceMm = 0;
};

/// What refraction does to an image.
struct MAMMORAYXRAY_EXPORT RefractedImage
{
  int Columns = 0;
  int Rows = 0;
  /**
   * Angles by which rays are bent, along the detector's columns (first plane) and rows (second),
   * radians, Rows * Columns values each; of several energies the mean, weighted as they are
   * detected in the open beam.
   */
  std::vector<float> Deflection;
  /// I / I0 with refraction; Rows * Columns values.
  std::vector<float> Transmission;
  /// Path lengths, as of PathLengthProjector::Project.
  PathLengthImage Lengths;
};

/// The same as an exposure: what reaches the detector, without its noise.
MAMMORAYXRAY_EXPORT Exposure ToExposure(const RefractedImage& refracted);

/**
 * Projects the projector's surface of `pointCount` points, and how its path lengths change with
 * shifts of the body along the detector's columns and rows: two velocity fields in one pass. The
 * gradient of sum_m delta_m L_m across the ray bends it, by alpha = -grad sum_m delta_m L_m: away
 * from where there is more of a body, whose index is below 1. (A shift of the body along the ray
 * changes nothing, so that two derivatives tell the whole vector.)
 *
 * `decrements[e * beam.NumberOfMaterials() + m]`: delta of material m at the energy of
 * beam.EnergyWeights()[e]. detector.Samples^2 rays per pixel are followed; rays are followed up to
 * 16 pixels beyond the detector's edges. Where a ray grazes a surface its deflection is bounded as
 * PathLengthDerivatives says. Rays are bent once, at first order in delta: an error of delta^2.
 *
 * Throws InputError on options out of range and on decrements of another number.
 */
MAMMORAYXRAY_EXPORT RefractedImage Refract(PathLengthProjector& projector, std::size_t pointCount,
  const XRaySource& source, const XRayDetector& detector, const Beam& beam,
  const std::vector<double>& decrements, const RefractionOptions& options,
  const ProgressCallback& progress = {});
}

#endif
