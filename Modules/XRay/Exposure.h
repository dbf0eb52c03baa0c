// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Exposure_h
#define mammoray_Exposure_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <cstdint>
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
  /// I / I0; Rows * Columns values, row by row. With noise it may exceed 1.
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
 * Methods A 748, 2014). No electronic noise, no scatter, no correlation between pixels.
 *
 * Throws InputError on options out of range and on a focal spot with a parallel beam.
 */
MAMMORAYXRAY_EXPORT Exposure Expose(PathLengthProjector& projector, const XRaySource& source,
  const XRayDetector& detector, const Beam& beam, const ExposureOptions& options = {},
  const ProgressCallback& progress = {});
}

#endif
