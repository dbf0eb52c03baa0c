// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Composition_h
#define mammoray_Composition_h

#include "mammoray/XRay/Beam.h"
#include "mammorayXRayModule.h"

#include <map>
#include <string>
#include <vector>

namespace mammoray
{
/// The compounds that can be called by name, as NIST lists them: "Water, Liquid", "Blood (ICRP)".
MAMMORAYXRAY_EXPORT std::vector<std::string> NistCompoundNames();

/**
 * Attenuation of a composition, from xraylib's cross sections (photoelectric, Rayleigh, Compton;
 * Schoonjans et al., Spectrochimica Acta B 66, 2011), 1 to 500 keV, absorption edges resolved:
 *  - a compound of NistCompoundNames, with NIST's density as the nominal one;
 *  - an element or a formula, "Al", "CaC2O4", "Ca5(PO4)3OH";
 *  - mass fractions, "H:0.102 C:0.184 N:0.032 O:0.677 S:0.005": elements or formulas, each once,
 *    that sum to 1 within 0.01.
 * Formulas and fractions have a nominal density of 1 g/cm^3, elements their own. Throws InputError
 * on mass fractions that are unusable; where the text is none of these, answers false.
 */
MAMMORAYXRAY_EXPORT bool FindComposition(const std::string& text, AttenuationTable& table);

/// The same; throws InputError "WHO: expected an element, ..., found 'TEXT'" where it is none.
MAMMORAYXRAY_EXPORT AttenuationTable RequireComposition(const std::string& text,
  const std::string& who);

/**
 * The same material at this density, g/cm^3, which becomes its nominal one, with iodine taken up
 * besides, mg per ml of it: linear attenuations add up. Throws InputError unless both are finite,
 * the density positive and the iodine not negative.
 */
MAMMORAYXRAY_EXPORT AttenuationTable WithIodine(const AttenuationTable& table,
  double densityGPerCm3, double iodineMgPerMl);

/// What such a text is made of.
struct CompositionParts
{
  /// By atomic number; they sum to 1.
  std::map<int, double> MassFractions;
  /// The nominal one.
  double DensityGPerCm3 = 1;
};
/// Throws InputError as RequireComposition does.
MAMMORAYXRAY_EXPORT CompositionParts ParseComposition(const std::string& text,
  const std::string& who);
}

#endif
