// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MaterialNames_h
#define mammoray_Private_MaterialNames_h

#include <string>
#include <vector>

namespace mammoray
{
/// What a name that people use stands for.
struct NamedMaterial
{
  /// The name as it is listed.
  std::string Name;
  /// A compound of xraylib's by its exact name, an element's symbol, or mass fractions.
  std::string Composition;
  /// Of mass fractions, g/cm^3; 0: that of the compound or element.
  double DensityGPerCm3 = 0;
};

/**
 * The material of a name: an element's ("Aluminium", "aluminum"), a compound of xraylib's list or
 * of NIST's pages on attenuation, or a common one (PMMA, acrylic, Teflon, water). Case, the order
 * of words, brackets and what stands between words do not matter; parts of a compound's name
 * ("Water", "Lucite") count where only one has them. Null if there is none.
 */
const NamedMaterial* FindNamedMaterial(const std::string& text);

/// The English name of an element in lower case, "aluminum" of 13. `number`: 1 to 92.
std::string ElementName(int number);

/// The names of all materials that FindNamedMaterial knows, each once as it is listed.
std::vector<std::string> NamesOfMaterials();
}

#endif
