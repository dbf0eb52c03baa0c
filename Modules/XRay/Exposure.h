// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Exposure_h
#define mammoray_Exposure_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace mammoray
{
/// What a real exposure adds to path lengths and the Beer-Lambert law.
struct MAMMORAYXRAY_EXPORT ExposureOptions
{
  /// Edges of the focal spot along the detector's columns and rows, mm; 0 is a point. Not negative.
  double FocalSpotColumnMm = 0;
  double FocalSpotRowMm = 0;
  /// A centred grid of n x n source points stands for the spot, all of the same weight; 1 to 32.
  int FocalSpotSamples = 5;
  /// Mean number of photons that meet a pixel without the object; 0 leaves quantum noise out. At
  /// most 1e12.
  double PhotonsPerPixel = 0;
  /**
   * The signal by pixel without the object, relative to that of PhotonsPerPixel: see OpenField.
   * Rows * Columns values, finite and not negative; empty: 1 everywhere. Transmissions are
   * multiplied by it.
   */
  std::vector<float> OpenField;
  /**
   * What else reaches the pixels, as scatter (ScatterModel): called with the mean path lengths and
   * the mean transmissions, the open field's included, of which it returns what is to be added,
   * Rows * Columns values that are not negative. Quantum noise is that of primary photons.
   */
  std::function<std::vector<double>(const PathLengthImage&, const std::vector<double>&)> Secondary;
  /// Frequency at which the detector's modulation transfer is 1/2, cycles per mm, besides that of
  /// its pixels (which their samples make); exp(-ln 2 (f / half)^2). It blurs signal and quantum
  /// noise. 0 leaves it out; else 0.1 to 1000.
  double HalfModulationPerMm = 0;
  /// Standard deviation of the detector's own noise, in mean signals of one photon; needs
  /// PhotonsPerPixel. 0 to 1e6.
  double ElectronicNoisePhotons = 0;
  /// Starts the noise: the same seed gives the same image, whatever the number of threads.
  std::uint64_t Seed = 0;

  /// Throws InputError, which names the value, when one is out of its range.
  void Validate() const;
};

/// An image as the detector sees it.
struct MAMMORAYXRAY_EXPORT Exposure
{
  /// Mean over all rays of a pixel; inconsistent where one of them is.
  PathLengthImage Lengths;
  /// I / I0; Rows * Columns values, row by row. With noise it may exceed 1; never negative.
  std::vector<float> Transmission;
  /// -ln of it. With noise, a pixel that detects nothing is taken for half a photon.
  std::vector<float> LogAttenuation;
};

/**
 * Projects the projector's mesh from every point of the focal spot to every sample of each pixel
 * (detector.Samples x detector.Samples) and averages intensities, not path lengths: at an edge the
 * mean transmission is not that of the mean path.
 *
 * Quantum noise: detected photons are Poisson distributed. Counting detectors and single energies
 * get that distribution; an energy-integrating one's sum over energies is given its mean and
 * variance exactly and the shape of a scaled Poisson distribution (Bohm and Zech, Nucl. Instrum.
 * Methods A 748, 2014). The detector's blur
 * then joins pixels, its own noise comes last.
 *
 * Throws InputError on options out of range, on an open field or secondary radiation of another
 * size and on a focal spot with a parallel beam.
 */
MAMMORAYXRAY_EXPORT Exposure Expose(PathLengthProjector& projector, const XRaySource& source,
  const XRayDetector& detector, const Beam& beam, const ExposureOptions& options = {},
  const ProgressCallback& progress = {});

/// The same with nothing in the beam: a flat field. Throws as Expose.
MAMMORAYXRAY_EXPORT Exposure ExposeAir(const XRaySource& source, const XRayDetector& detector,
  const Beam& beam, const ExposureOptions& options = {});
}

#endif
