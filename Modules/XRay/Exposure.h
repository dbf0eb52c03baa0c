// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Exposure_h
#define mammoray_Exposure_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// Computes the scattered signal of each pixel from the mean path lengths and the primary signal:
/// Rows * Columns values, not negative, in the units of the latter.
using ScatterFunction =
  std::function<std::vector<double>(const PathLengthImage&, const std::vector<double>&)>;

/// A detector's line spread function, symmetric: values in any common unit, not negative, at
/// distances from the line, mm, ascending from 0; linear in between, and 0 beyond the last.
struct MAMMORAYXRAY_EXPORT LineSpread
{
  std::vector<double> DistancesMm;
  std::vector<double> Values;

  /// The modulation transfer at a frequency, cycles per mm; 1 at 0.
  double Transfer(double cyclesPerMm) const;
  /// Throws InputError unless it is as above, with an area. An empty one is.
  void Validate() const;
  bool operator==(const LineSpread&) const = default;
};

/// What a real exposure adds to path lengths and the Beer-Lambert law.
struct MAMMORAYXRAY_EXPORT ExposureOptions
{
  /// Edges of the focal spot along the detector's columns and rows, mm; 0 is a point. Not negative.
  double FocalSpotColumnMm = 0;
  double FocalSpotRowMm = 0;
  /// A centred grid of n x n source points of equal weight represents the spot; 1 to 32.
  int FocalSpotSamples = 5;
  /// Mean number of photons that meet a pixel without the object, at most 1e12. 0: no quantum
  /// noise.
  double PhotonsPerPixel = 0;
  /**
   * The signal of each pixel without the object, relative to that of PhotonsPerPixel (see the
   * function OpenField); Rows * Columns values, finite and not negative. Empty: 1 everywhere.
   * Transmissions are multiplied by it.
   */
  std::vector<float> OpenField;
  /// The scattered signal to add; its primary signal includes the open field. Quantum noise is that
  /// of primary photons. Unset: none.
  ScatterFunction Scatter;
  /// Frequency at which the detector's modulation transfer function, exp(-ln 2 (f / half)^2), is
  /// 1/2, cycles per mm, 0.1 to 1000. The pixel's aperture comes from its samples. Blurs signal and
  /// quantum noise. 0: no blur.
  double HalfModulationPerMm = 0;
  /// Blurs as it does, in its place, by the detector's modulation transfer up to 64 pixels far.
  LineSpread Spread;
  /// Standard deviation of the pixels' gains, relative to 1, 0 to 0.5, and the fraction of pixels
  /// that give no signal, 0 to 0.5. Both are the detector's: the same in every picture. They act
  /// on what is detected, before electronic noise.
  double GainSpread = 0;
  double DeadPixels = 0;
  /// Signal without photons, which is added last, relative to that of the open beam, 0 to 10.
  double DarkLevel = 0;
  /// The signal becomes a number of so many bits, 8 to 16, where the open beam has 4/5 of the
  /// largest; it stays relative to the open beam. 0: it stays as it is.
  int Bits = 0;
  /// Standard deviation of the electronic noise, in mean signals of one photon; needs
  /// PhotonsPerPixel. 0 to 1e6.
  double ElectronicNoisePhotons = 0;
  /// Seed of the noise. The same seed gives the same image for any number of threads.
  std::uint64_t Seed = 0;

  bool HasBlur() const
  {
    return this->HalfModulationPerMm > 0 || !this->Spread.DistancesMm.empty();
  }
  /// Whether pixels differ from each other, or from what they detect.
  bool HasPixelErrors() const
  {
    return this->GainSpread > 0 || this->DeadPixels > 0 || this->DarkLevel > 0 || this->Bits > 0;
  }
  /// Throws InputError, which names the value, if one is out of its range.
  void Validate() const;
};

/// Refraction of the rays.
struct MAMMORAYXRAY_EXPORT RefractionOptions
{
  enum class Law
  {
    /// Geometric optics: every ray carries its intensity to its displaced place.
    Geometric,
    /// Near field of the transport-of-intensity equation: T - div(T s), with the transmission T and
    /// the displacement s of rays at the detector.
    NearField
  };
  Law Method = Law::Geometric;
  /**
   * Distance from the plane in which rays are bent to the detector, to which it is parallel, mm;
   * not negative. Bodies are assumed to be thin compared with it. For a point source at a distance
   * z1 from that plane, the detector's coordinates include the magnification (z1 + z2) / z1 of the
   * displacement.
   */
  double DistanceMm = 0;
};

/// The dose that photons leave in the voxels of a scene.
struct MAMMORAYXRAY_EXPORT Dose
{
  /// How many were followed.
  std::int64_t Photons = 0;
  /// Where the air kerma is stated: over the detector, on the ray that meets it at right angles,
  /// mm.
  double HeightMm = 0;
  /// Air kerma there without backscatter for ExposureOptions::PhotonsPerPixel, mGy; 0 without them.
  double AirKermaMgy = 0;
  /// By material: mass, g; mean dose per air kerma, mGy/mGy; its standard error. 0 without mass.
  std::vector<double> MassesG;
  std::vector<double> PerAirKerma;
  std::vector<double> Error;
};

/// A picture as the detector sees it.
struct MAMMORAYXRAY_EXPORT Exposure
{
  /// Mean path lengths over all rays of a pixel. A pixel is inconsistent if one of its rays is.
  /// Never null.
  std::shared_ptr<const PathLengthImage> Lengths;
  /// I / I0; Rows * Columns values, row by row. With noise it may exceed 1; never negative.
  std::vector<float> Transmission;
  /// -ln(I / I0). With noise, a pixel that detects nothing counts as half a photon.
  std::vector<float> LogAttenuation;
  /// With refraction: angles by which rays are bent, along the detector's columns (first plane) and
  /// rows (second), radians, Rows * Columns values each. Of several energies the mean, weighted as
  /// they are detected in the open beam.
  std::vector<float> Deflection;
  /// Where Scene::Dose asks for it.
  std::optional<Dose> Absorbed;
};

/// Gives the path lengths of the rays from one point to one sample of each pixel (Samples is 1).
using PathLengthFunction =
  std::function<std::shared_ptr<const PathLengthImage>(const XRaySource&, const XRayDetector&)>;

/**
 * Takes path lengths from every point of the focal spot to every sample of each pixel
 * (detector.Samples x detector.Samples) and averages intensities, not path lengths: at an edge the
 * mean transmission differs from that of the mean path.
 *
 * Quantum noise: detected photons are Poisson distributed. This is exact for counting detectors and
 * single energies. The sum over energies of an integrating detector has the exact mean and variance
 * and the shape of a scaled Poisson distribution (Bohm and Zech, Nucl. Instrum. Methods A 748,
 * 2014). Then the detector's blur mixes pixels, which have their gains; electronic noise, the dark
 * level and counting come last.
 *
 * Exposer calls it with the path lengths of a scene. Throws InputError on options out of range, on
 * an open field or scatter of another size and on a focal spot with a parallel beam.
 */
MAMMORAYXRAY_EXPORT Exposure Expose(const PathLengthFunction& pathLengths, const XRaySource& source,
  const XRayDetector& detector, const Beam& beam, const ExposureOptions& options = {},
  const ProgressCallback& progress = {});

/**
 * The heel effect: photons arise below the target's surface, and those that leave at grazing angles
 * pass more of the target. Electrons meet the target at right angles to the central ray. With the
 * depth z along the electrons, the angle a between target and central ray and the unit normal n of
 * the target's surface, a ray of direction d passes z cos(a) / (d . n) of the target. No ray leaves
 * below the surface.
 */
struct MAMMORAYXRAY_EXPORT HeelEffect
{
  /// Angle between target and central ray, degrees, in (0, 90). Mammography tubes have 16 to 24,
  /// including their tilt. 0: no heel effect.
  double TargetAngleDeg = 0;
  /// Mean depth at which photons arise, mm. Not negative; 0.0005 is a quarter of the range of
  /// electrons of 28 keV in tungsten (ESTAR). 0.005 at 120 kV, 0.012 at 225 (TungstenTarget.h).
  double DepthMm = 0;
  /// Composition of the target (see FindComposition).
  std::string Target = "W";
};

/// Variation of the open beam over the detector.
struct MAMMORAYXRAY_EXPORT OpenFieldOptions
{
  /// Photons per area fall with the square of the distance from the focus and the cosine of the
  /// angle at which they meet the detector.
  bool InverseSquare = false;
  HeelEffect Heel;
};

/**
 * The detected signal by pixel, Rows * Columns values, relative to that where the ray from the
 * focus meets the detector's plane at right angles. The central ray of the heel effect is that ray;
 * the anode lies in the direction of the detector's columns (a mammography unit's: of the nipple).
 * The heel effect acts on the spectrum of the open beam. Behind tissue, the photons that it removes
 * are assumed to have the same spectrum as all others.
 *
 * Throws InputError on options out of range, on a parallel beam, and if the heel effect removes the
 * signal of every pixel.
 */
MAMMORAYXRAY_EXPORT std::vector<float> OpenField(const XRaySource& source,
  const XRayDetector& detector, const Spectrum& spectrum, const DetectorResponse& response,
  const OpenFieldOptions& options);
}

#endif
