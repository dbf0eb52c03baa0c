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
/// Names to suggest in place of an unknown one: of the compounds that NIST lists ("Water, Liquid",
/// "Blood (ICRP)"), of elements, common ones ("PMMA"), and the symbol or formula that the unknown
/// one is but for capitals ("Al" of "AL", "Al2O3" of "AL2O3").
MAMMORAYXRAY_EXPORT std::vector<std::string> CompositionNames(const std::string& unknown);

/**
 * Attenuation of a composition, from xraylib's cross sections (photoelectric, Rayleigh, Compton;
 * Schoonjans et al., Spectrochimica Acta B 66, 2011), 1 to 500 keV, absorption edges resolved:
 *  - a name of CompositionNames, whatever its case and punctuation, or a part of it that no other
 *    has ("water", "Lucite"), with NIST's density as the nominal one;
 *  - an element or a formula, "Al", "CaC2O4", "Ca5(PO4)3OH"; ambiguous ones, such as "PB", "SIO2"
 *    or "PP", need all numbers ("P1B1");
 *  - mass fractions, "H:0.102 C:0.184 N:0.032 O:0.677 S:0.005": elements or formulas, each once,
 *    that sum to 1 within 0.01.
 * Elements and compounds have a density, formulas and fractions none (HasDensity); their table is
 * that of 1 g/cm^3. Returns false if the text has none of these forms. Throws InputError on
 * unusable mass fractions and ambiguous formulas.
 */
MAMMORAYXRAY_EXPORT bool FindComposition(const std::string& text, AttenuationTable& table);

/// FindComposition that throws InputError "WHO: expected an element, ..., found 'TEXT'" instead of
/// returning false.
MAMMORAYXRAY_EXPORT AttenuationTable RequireComposition(const std::string& text,
  const std::string& who);

/// Takes "@DENSITY" off the end of a material's text and returns it, g/cm^3; 0 where there is none.
/// Throws InputError "WHO: ..." on no number, and outside ValidRanges::PartDensity.
MAMMORAYXRAY_EXPORT double TakeDensity(std::string& material, const std::string& who);

/**
 * The material at this density, g/cm^3, which becomes the nominal one, plus iodine, mg per ml of
 * the material: linear attenuations add up. Throws InputError unless both are finite, the density
 * positive and the iodine not negative.
 */
MAMMORAYXRAY_EXPORT AttenuationTable WithIodine(const AttenuationTable& table,
  double densityGPerCm3, double iodineMgPerMl);

/// The elements of a composition.
struct CompositionParts
{
  /// Mass fractions by atomic number; their sum is 1.
  std::map<int, double> MassFractions;
  /// 0: the text implies none.
  double DensityGPerCm3 = 0;
};
/// Throws InputError as RequireComposition does.
MAMMORAYXRAY_EXPORT CompositionParts ParseComposition(const std::string& text,
  const std::string& who);
/// The text of mass fractions by atomic number that sum to 1, "H:0.111894 O:0.888106".
MAMMORAYXRAY_EXPORT std::string MixtureText(const std::map<int, double>& massFractions);
}

#endif
