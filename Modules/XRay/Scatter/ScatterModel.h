// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterModel_h
#define mammoray_ScatterModel_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scatter/Photons.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct Scene;

/**
 * Scatter of a thin beam of photons through an infinite slab of tissue, at right angles, onto a
 * plane behind it. By photon energy, slab thickness and distance from the slab's back to the plane:
 * the energy that meets rings of the plane around the beam, by angle of incidence, relative to the
 * energy of the unscattered beam.
 */
struct MAMMORAYXRAY_EXPORT ScatterKernels
{
  /// Composition of the slab, and its density, g/cm^3.
  std::string Composition;
  double DensityGPerCm3 = 0;
  /// Ascending: keV; mm; mm.
  std::vector<double> EnergiesKeV;
  std::vector<double> ThicknessesMm;
  std::vector<double> GapsMm;
  /// Edges of the rings, mm, and of the angles from the beam's direction, degrees; ascending from
  /// 0.
  std::vector<double> RadiiMm;
  std::vector<double> AnglesDeg;
  /// [(((energy * thicknesses + thickness) * gaps + gap) * rings + ring) * angles + angle].
  std::vector<float> Shares;
  /// [energy * thicknesses + thickness]: the fraction of the scattered energy behind the slab that
  /// was scattered more than once.
  std::vector<float> Multiple;

  std::size_t NumberOfRings() const { return this->RadiiMm.size() - 1; }
  std::size_t NumberOfAngles() const { return this->AnglesDeg.size() - 1; }
  std::size_t Index(std::size_t energy, std::size_t thickness, std::size_t gap) const
  {
    return ((energy * this->ThicknessesMm.size() + thickness) * this->GapsMm.size() + gap) *
      this->NumberOfRings() * this->NumberOfAngles();
  }
  /// Shares by ring and angle, interpolated linearly in energy and gap, constant beyond the table.
  std::vector<double> At(double energyKeV, std::size_t thickness, double gapMm) const;
  /// Multiple, interpolated in energy.
  double MultipleAt(double energyKeV, std::size_t thickness) const;
  /// Throws InputError unless sizes fit and axes ascend.
  void Validate() const;
  bool operator==(const ScatterKernels&) const = default;
};

/**
 * Sets Shares and Multiple of a table with axes by Monte Carlo, with `photons`, at least 1, for
 * each energy and thickness. The same numbers give the same table on any number of cores. Where a
 * slab lets less than exp(-80) of the photons through, the shares are 0. Throws InputError on axes
 * and a composition that cannot be used.
 */
MAMMORAYXRAY_EXPORT void FillScatterKernels(ScatterKernels& kernels, std::int64_t photons,
  std::uint64_t seed, const ProgressCallback& progress = {});

/**
 * Axes and material of kernels for what a scene shows: thicknesses up to the longest path through
 * its materials, which is rounded up; the energies that pass them; gaps that thinner places have;
 * rings as wide as the detector. The material is the mean of those along the rays, by mass, in
 * hundredths of their volumes. Throws InputError on a material that rays meet without a known
 * composition, and where they meet none. Fill it with FillScatterKernels.
 */
MAMMORAYXRAY_EXPORT ScatterKernels KernelAxesOf(const Scene& scene, const PathLengthImage& lengths);
/// Photons for each energy and thickness, if the table is made with about `photons` in all.
MAMMORAYXRAY_EXPORT std::int64_t PhotonsPerSlab(const ScatterKernels& kernels, double photons);

/**
 * Scatter of a breast between plates, or of another flat body, by superposition of kernels: the
 * primary signal at each place sends a share to all places around, which depends on the thickness
 * of the tissue there. Shares are those of slabs (ScatterKernels), averaged over the spectrum
 * behind that thickness, and behind the grid if there is one.
 *
 * Where the breast is thinner than at its thickest place, both of its surfaces are assumed to
 * recede by the same amount: half of the missing thickness widens the gap. Multiple scatter is
 * assumed to need tissue within two mean free paths: its share falls with the tissue that is
 * missing there. The divergence of the beam shifts the origin of scatter, at half the thickness,
 * towards the foot of the source. Plates, and photons that leave through the breast's side and meet
 * the detector beside it, are neglected. A scattered photon's signal is taken to be in proportion
 * to its energy.
 */
class MAMMORAYXRAY_EXPORT ScatterModel
{
public:
  /// `gapMm`: from the back of the tissue, where it is thickest, to the detector, 0 to 200 or to
  /// the largest gap of the table. Throws InputError on a gap out of range, and if the table lacks
  /// the mean energy of the spectrum.
  ScatterModel(const ScatterKernels& kernels, const Spectrum& spectrum,
    const DetectorResponse& response, double gapMm,
    const std::optional<AntiscatterGrid>& grid = {});

  /**
   * The scattered signal of each pixel, Rows * Columns values, in the units of `primary`, the
   * signal of the primary photons. With a grid, both are behind it and relative to the open field
   * behind it. `thicknessesMm` is the thickness of tissue along the ray of each pixel. Outside the
   * picture the tissue continues, but there is no beam. Computed on cells of about 2 mm.
   */
  std::vector<double> Scatter(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& thicknessesMm, const std::vector<double>& primary) const;

  /// Derivatives of the thickness, mm, and the primary signal of each pixel with a parameter.
  struct SignalRates
  {
    std::vector<double> ThicknessesMm;
    std::vector<double> Primary;
  };
  /**
   * Derivatives of the scattered signal of each pixel with each of these parameters. They are exact
   * except at kinks of Scatter: at thicknesses of the table, at the thickness between the plates,
   * and where a pixel lies at the centre of a cell. Throws InputError on sizes that do not fit.
   */
  std::vector<std::vector<double>> Differentiate(const XRaySource& source,
    const XRayDetector& detector, const std::vector<double>& thicknessesMm,
    const std::vector<double>& primary, const std::vector<SignalRates>& rates) const;

  /// Scatter-to-primary ratio on the axis of a parallel beam of this diameter, mm, through an
  /// infinite slab.
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
  /// Fraction of tissue around each cell, within the range of multiple scatter.
  std::vector<double> TissueAround(const Geometry& geometry,
    const std::vector<double>& tissue) const;
  /// The share of each ring for a thickness of the table, `missingMm` thinner than the thickest.
  RingShares RingsAt(std::size_t node, double missingMm) const;
  /// Derivative of RingsAt with respect to `missingMm`, 1/mm.
  RingShares RingRatesAt(std::size_t node, double missingMm) const;

  std::vector<double> Radii;
  /// The first is 0, without scatter.
  std::vector<double> Thicknesses;
  std::vector<double> Gaps;
  double GapMm;
  /// By thickness: fraction of scatter that is multiple.
  std::vector<double> Multiple;
  /// Distance along the body from which multiple scatter comes (one standard deviation), mm.
  double ReachMm = 0;
  /// By thickness and gap.
  std::vector<std::vector<RingShares>> Rings;
};

/// The sum over materials of each pixel's path lengths, mm.
MAMMORAYXRAY_EXPORT std::vector<double> TissueThickness(const PathLengthImage& image);
}

#endif
