// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterKernels_h
#define mammoray_ScatterKernels_h

#include "mammoray/Foundation/Progress.h"
#include "mammorayXRayModule.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * What a thin beam of photons, at right angles through a slab of tissue without end, scatters onto
 * a plane behind it: by energy, thickness of the slab and distance from its back to the plane, the
 * energy that meets rings of the plane around the beam at certain angles, relative to the energy of
 * the beam that comes through unscattered.
 */
struct MAMMORAYXRAY_EXPORT ScatterKernels
{
  /// What the slab was made of, and its density, g/cm^3.
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
  /// By energy and thickness, the latter first to change: how much of the scattered energy that
  /// leaves the slab's back has been scattered more than once, 0 to 1.
  std::vector<float> Multiple;

  std::size_t NumberOfRings() const { return this->RadiiMm.size() - 1; }
  std::size_t NumberOfAngles() const { return this->AnglesDeg.size() - 1; }
  std::size_t Index(std::size_t energy, std::size_t thickness, std::size_t gap) const
  {
    return ((energy * this->ThicknessesMm.size() + thickness) * this->GapsMm.size() + gap) *
      this->NumberOfRings() * this->NumberOfAngles();
  }
  /// Shares by ring and angle between the table's energies and gaps, linearly, beyond its ends as
  /// at them.
  std::vector<double> At(double energyKeV, std::size_t thickness, double gapMm) const;
  /// Multiple between the table's energies.
  double MultipleAt(double energyKeV, std::size_t thickness) const;
  /// Throws InputError unless the sizes fit and axes ascend.
  void Validate() const;
};

/// The axes and the tissue of the shipped table: 25 % gland and 75 % fat by mass (Hammerstein
/// 1979), 0.955 g/cm^3.
MAMMORAYXRAY_EXPORT ScatterKernels ShippedKernelAxes();

/**
 * Fills the table by Monte Carlo: `photons` for each energy and thickness. Every flight is made to
 * end within the slab and the share that would leave it is counted where it would meet the planes
 * (forced collisions, last-flight estimation); absorption lowers the photon's weight.
 */
MAMMORAYXRAY_EXPORT void FillScatterKernels(ScatterKernels& kernels, std::int64_t photons,
  std::uint64_t seed, const ProgressCallback& progress = {});
}

#endif
