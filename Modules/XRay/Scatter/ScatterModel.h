// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterModel_h
#define mammoray_ScatterModel_h

#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scatter/AntiscatterGrid.h"
#include "mammoray/XRay/Scatter/ScatterKernels.h"
#include "mammorayXRayModule.h"

#include <array>
#include <optional>
#include <vector>

namespace mammoray
{
/**
 * Scatter of a breast between plates as a sum over its picture: what comes through at a place sends
 * a share to all places around, by the thickness of the tissue there. The shares are those of slabs
 * (ScatterKernels), averaged over the photons that come through that thickness, behind a grid where
 * there is one. Where the breast is thinner than at its thickest, it is taken to be rounded to both
 * plates alike: half of what is missing is a wider gap. What is scattered more than once is taken
 * to need tissue within two mean free paths around: its share falls with the tissue that is missing
 * there. The beam's divergence moves what scatters, at half the thickness, towards the foot of the
 * source. Left out: plates, and photons that leave by the breast's side and meet the detector
 * beside it. For soft tissue.
 */
class MAMMORAYXRAY_EXPORT ScatterModel
{
public:
  /// `gapMm`: from the back of the tissue, where it is thickest, to the detector, 0 to 200. Throws
  /// InputError on a gap out of range.
  ScatterModel(const ScatterKernels& kernels, const Spectrum& spectrum,
    const DetectorResponse& response, double gapMm,
    const std::optional<AntiscatterGrid>& grid = {});

  /**
   * The scattered signal of each pixel, Rows * Columns values, in the units of `primary`, the
   * signal of the primary photons (with a grid: both behind it, relative to the open field behind
   * it). `thicknessesMm`: of the tissue along the ray of each pixel. Outside of the picture is no
   * beam, but the tissue goes on. Computed on cells of about 2 mm.
   */
  std::vector<double> Scatter(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& thicknessesMm, const std::vector<double>& primary) const;

  /// How thickness, mm, and primary signal of each pixel change with a parameter.
  struct SignalRates
  {
    std::vector<double> ThicknessesMm;
    std::vector<double> Primary;
  };
  /**
   * How the scattered signal of each pixel changes with each of these parameters, for the rays of
   * `source` and `detector`: exact but for where Scatter has kinks, which is where a thickness is
   * one of the table's, or that between the plates, and where a pixel's place meets the middle of a
   * cell. Throws InputError on sizes that do not fit.
   */
  std::vector<std::vector<double>> Differentiate(const XRaySource& source,
    const XRayDetector& detector, const std::vector<double>& thicknessesMm,
    const std::vector<double>& primary, const std::vector<SignalRates>& rates) const;

  /// Scattered over primary signal on the axis of a parallel beam of this diameter, mm, through a
  /// slab without end.
  double ScatterToPrimary(double thicknessMm, double diameterMm) const;

private:
  using RingShares = std::vector<double>;
  struct Geometry;
  struct SentSignal;
  struct SendingPixel;
  /// add(column, row, pixel, signal) of the pixels that see tissue, on several threads.
  template <typename Add>
  SentSignal SumOfBands(const Geometry& geometry, const std::vector<double>& thicknessesMm,
    const Add& add) const;
  SentSignal Gather(const Geometry& geometry, const std::vector<double>& thicknessesMm,
    const std::vector<double>& primary) const;
  SentSignal GatherRates(const Geometry& geometry, const std::vector<double>& thicknessesMm,
    const std::vector<double>& primary, const SignalRates& rates) const;
  /// How much of the space around each cell, as far as photons fly that are scattered more than
  /// once, is tissue; of two fields.
  std::array<std::vector<double>, 2> TissueAround(const Geometry& geometry,
    const std::array<const std::vector<double>*, 2>& tissue) const;
  /// The share of each ring at a node of the thickness, `missingMm` less than the thickest.
  RingShares RingsAt(std::size_t node, double missingMm) const;
  /// Its derivative with what is missing, 1/mm.
  RingShares RingRatesAt(std::size_t node, double missingMm) const;

  std::vector<double> Radii;
  /// 0 first, where nothing scatters.
  std::vector<double> Thicknesses;
  std::vector<double> Gaps;
  double GapMm;
  /// By thickness: what has been scattered more than once, of all.
  std::vector<double> Multiple;
  /// Between collisions, of the photons that come through 40 mm, mm.
  double FreePathMm = 0;
  /// By thickness and gap.
  std::vector<std::vector<RingShares>> Rings;
};

/// The sum over materials of each pixel's path lengths, mm.
MAMMORAYXRAY_EXPORT std::vector<double> TissueThickness(const PathLengthImage& image);
}

#endif
