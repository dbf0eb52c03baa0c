// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_KilovoltageSpectrum_h
#define mammoray_KilovoltageSpectrum_h

#include "mammoray/XRay/Beam.h"
#include "mammorayAppModule.h"

namespace mammoray
{
/// The tube voltage of a spectrum: the first whole kV above its photons.
MAMMORAYAPP_EXPORT double KilovoltageOf(const Spectrum& spectrum);

/**
 * The spectrum of the same tube and filter at another voltage, kV. The photons of each energy E are
 * scaled as the thick target's bremsstrahlung, proportional to (kVp - E) / E (Kramers, Phil. Mag.
 * 46, 1923); above the given spectrum's last 2 keV the rest of the law is taken for constant. Good
 * for a few kV either way: between the shipped spectra of 28 and 30 kV the mean energy is met to a
 * third of its change. Throws InputError unless `kilovoltage` leaves photons and is at most 10 kV
 * above the spectrum's.
 */
MAMMORAYAPP_EXPORT Spectrum AtKilovoltage(const Spectrum& spectrum, double kilovoltage);
}

#endif
