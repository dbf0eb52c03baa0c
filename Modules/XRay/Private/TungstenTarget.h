// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TungstenTarget_h
#define mammoray_TungstenTarget_h

#include "mammoray/XRay/Beam.h"

namespace mammoray
{
/// Mean ionisation potential of tungsten, keV, and its mass per mole, g (ICRU Report 37).
constexpr double TungstenPotentialKeV = 0.727;
constexpr double TungstenMolarMassG = 183.84;
constexpr int TungstenNumber = 74;

/**
 * Photons that a thick tungsten target sends along the central ray, at constant potential, 20 to
 * 450 kV: photons per mm^2 and mAs at a distance of 1 m, without any filter. Energies are U - n h
 * above 5 keV, with a step h of 0.5 keV up to 60 kV and 1 keV above.
 *
 * An electron slows down from T0 = U to T by Bethe's law (ICRU Report 37). The continuum sums
 * formula 3BN of Koch and Motz (Rev. Mod. Phys. 31, 1959, 920) with Elwert's factor (Ann. Phys. 34,
 * 1939, 178) over this path, as Poludniowski does (Med. Phys. 34, 2007, 2175). Directions are not
 * distinguished.
 *  - Depth: electrons of energy T are spread evenly down to 1.5 times the Thomson-Whiddington depth
 *    (T0^2 - T^2) / c, with the constants c of Tucker, Barnes and Chakraborty (Med. Phys. 18, 1991,
 *    211). Photons leave through depth / tan(target angle) of tungsten.
 *  - Electrons that turn back: a share eta of them (Hunger and Kuechler, Phys. Status Solidi A 56,
 *    1979, K45), which keep more than u T0 with probability 1 - u^3, on average 3/4 of their energy
 *    (Bishop, Br. J. Appl. Phys. 18, 1967, 703).
 *  - K lines: photons per electron and depth by Tucker, Barnes and Chakraborty.
 *  - L lines: Bethe's ionisation cross section with Powell's constants (Rev. Mod. Phys. 48, 1976,
 *    33); yields of xraylib.
 */
Spectrum TungstenSpectrum(double kilovolts, double targetAngleDeg);
}

#endif
