// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterKernels_h
#define mammoray_ScatterKernels_h

#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
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
};
}

#endif
