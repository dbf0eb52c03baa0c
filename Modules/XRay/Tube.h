// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Tube_h
#define mammoray_Tube_h

#include "mammoray/XRay/Beam.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A layer that all photons pass through.
struct MAMMORAYXRAY_EXPORT XRayFilter
{
  /// Composition (see FindComposition).
  std::string Material;
  double ThicknessMm = 0;
  /// g/cm^3; 0: that of the composition (AttenuationTable::DensityOf).
  double DensityGPerCm3 = 0;

  /// Parses MATERIAL[\@DENSITY]:MM: "Rh:0.05", "SiO2@2.2:1". Throws InputError on another form.
  static XRayFilter FromText(const std::string& text, const std::string& what = "filter");
};

/**
 * A tube at constant potential. Mammography tubes, 18 to 42 kV: measured spectra behind a beryllium
 * window, interpolated in the voltage (Boone, Fewell and Jennings, Med. Phys. 24, 1997, 1863), in
 * bins of 0.5 keV. Tungsten tubes of other voltages or with a target angle, 20 to 450 kV: a
 * computed spectrum without window (Private/TungstenTarget.h has the formulas and their sources).
 */
struct MAMMORAYXRAY_EXPORT XRayTube
{
  /// "W", "Mo" or "Rh".
  std::string Anode = "W";
  /// kV; 18 to 42, of tungsten to 450.
  double KilovoltagePeak = 28;
  /// In addition to the window of a measured spectrum.
  std::vector<XRayFilter> Filters;
  /// Angle between target and central ray, degrees, 3 to 60; of tungsten from 20 kV on. 0: the
  /// measured spectra up to 42 kV, 12 degrees above.
  double TargetAngleDeg = 0;

  /// Throws InputError on an unknown anode, and on a voltage or an angle out of range.
  void Validate() const;
  /// "W 28 kVp, 0.05 mm Rh".
  std::string Name() const;
};

/**
 * The spectrum of a tube, in a unit that is the same for all voltages and filters of an anode's
 * measured spectra; computed ones are photons per mm^2 and mAs at 1 m. Photons below 5 keV, the
 * least energy of the attenuation tables, are left out: 30 micrometres of molybdenum transmit 1 in
 * 10^7 of them. Throws InputError on an unusable tube or filter.
 */
MAMMORAYXRAY_EXPORT Spectrum TubeSpectrum(const XRayTube& tube);

/// The spectrum behind a filter. Throws InputError on an unknown material, a negative or infinite
/// thickness, and if no photon is left.
MAMMORAYXRAY_EXPORT Spectrum FilterSpectrum(const Spectrum& spectrum, const XRayFilter& filter);

/// A detector that integrates the energy absorbed in a layer (a scintillator or an amorphous
/// semiconductor): D(E) = E (1 - exp(-mu t)). Escaping fluorescence counts as absorbed. Throws
/// InputError as FilterSpectrum.
MAMMORAYXRAY_EXPORT DetectorResponse AbsorbingDetector(const XRayFilter& layer);

/**
 * The first half-value layer, mm of a composition of its nominal density, which halves the air
 * kerma (energy times mass energy-absorption coefficient of air, xraylib). Throws InputError on an
 * unusable spectrum and a composition that is unknown or has no density.
 */
MAMMORAYXRAY_EXPORT double HalfValueLayerMm(const Spectrum& spectrum,
  const std::string& composition = "Al");
}

#endif
