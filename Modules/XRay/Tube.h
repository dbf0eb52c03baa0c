// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Tube_h
#define mammoray_Tube_h

#include "mammoray/XRay/Beam.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A layer that all photons pass.
struct MAMMORAYXRAY_EXPORT XRayFilter
{
  /// See FindComposition.
  std::string Material;
  double ThicknessMm = 0;
  /// g/cm^3; 0 takes the composition's own.
  double DensityGPerCm3 = 0;

  /// "Rh:0.05", "SiO2@2.2:1": MATERIAL:MM, with \@DENSITY after the material where it is not the
  /// composition's own. Throws InputError on anything else.
  static XRayFilter FromText(const std::string& text);
};

/**
 * A mammography tube at constant potential, after Boone, Fewell and Jennings (Med. Phys. 24, 1997,
 * 1863): measured spectra of tubes with a beryllium window, interpolated in the voltage; bins of
 * 0.5 keV.
 */
struct MAMMORAYXRAY_EXPORT XRayTube
{
  /// "W", "Mo" or "Rh".
  std::string Anode = "W";
  /// kV; 18 to 42.
  double KilovoltagePeak = 28;
  /// Besides the window.
  std::vector<XRayFilter> Filters;

  /// Throws InputError, which names the value, on an unknown anode or what is out of its range.
  void Validate() const;
  /// "W 28 kVp, 0.05 mm Rh".
  std::string Name() const;
};

/**
 * Photons by energy, in a unit that is the same for all voltages and filters of an anode. Photons
 * below 5 keV, where our attenuation tables begin, are left out: 30 micrometres of molybdenum let 1
 * in 10^7 of them pass. Throws InputError on an unusable tube or filter.
 */
MAMMORAYXRAY_EXPORT Spectrum TubeSpectrum(const XRayTube& tube);

/// What a filter leaves of a spectrum. Throws InputError on an unknown material, a thickness that
/// is negative or not finite, or when nothing is left.
MAMMORAYXRAY_EXPORT Spectrum FilterSpectrum(const Spectrum& spectrum, const XRayFilter& filter);

/// A detector that adds up the energy of the photons that a layer of it absorbs (a scintillator, an
/// amorphous semiconductor): D(E) = E (1 - exp(-mu t)). Fluorescence that escapes counts as
/// absorbed. Throws InputError as FilterSpectrum.
MAMMORAYXRAY_EXPORT DetectorResponse AbsorbingDetector(const XRayFilter& layer);

/**
 * The first half-value layer, mm of aluminium (2.70 g/cm^3): so much of it halves the air kerma
 * (energy times mass energy-absorption coefficient of air, xraylib). Throws InputError on an
 * unusable spectrum.
 */
MAMMORAYXRAY_EXPORT double HalfValueLayerMm(const Spectrum& spectrum);
}

#endif
