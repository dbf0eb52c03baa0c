// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Composition.h"

#include "Private/MaterialNames.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/Foundation/ValidRange.h"

#include <xraylib.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <sstream>

namespace mammoray
{
namespace
{
constexpr double LowestKeV = 1;
constexpr double HighestKeV = 500;
/// xraylib parses brackets by unlimited recursion; formulas of tissues and metals are shorter.
constexpr std::size_t MostLetters = 200;

/// Mass fraction by atomic number.
using MassFractions = std::map<int, double>;

/// Mass fractions of a formula or an element; empty if the text is neither.
MassFractions ParseFormula(const std::string& text)
{
  // xraylib's parser leaks memory on texts that are no formula, so it gets possible ones only.
  const bool mayBeFormula = !text.empty() && text.size() <= MostLetters &&
    (std::isupper(static_cast<unsigned char>(text[0])) != 0 || text[0] == '(') &&
    std::all_of(text.begin(), text.end(),
      [](unsigned char letter)
      { return std::isalnum(letter) != 0 || letter == '.' || letter == '(' || letter == ')'; });
  if (!mayBeFormula)
  {
    return {};
  }
  const std::unique_ptr<compoundData, decltype(&FreeCompoundData)> compound(
    CompoundParser(text.c_str(), nullptr), FreeCompoundData);
  MassFractions fractions;
  for (int element = 0; compound && element < compound->nElements; ++element)
  {
    fractions[compound->Elements[element]] += compound->massFractions[element];
  }
  return fractions;
}

/// "H:0.11 O:0.89"
MassFractions ParseMixture(const std::string& text)
{
  const auto refuse = [&](const std::string& found)
  {
    throw InputError("mass fractions '" + text +
      "': expected elements or formulas with fractions that sum to 1, as in 'H:0.112 O:0.888', "
      "found " +
      found);
  };
  MassFractions fractions;
  std::set<std::string> seen;
  double sum = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;)
  {
    const std::size_t colon = std::min(word.find(':'), word.size());
    const std::string name = word.substr(0, colon);
    double fraction = 0;
    const MassFractions part = ParseFormula(name);
    if (!ToNumber(word.substr(std::min(colon + 1, word.size())), fraction) ||
      !(fraction > 0 && fraction <= 1) || part.empty())
    {
      refuse("'" + word + "'");
    }
    if (!seen.insert(name).second)
    {
      refuse("'" + name + "' twice");
    }
    for (const auto& [element, share] : part)
    {
      fractions[element] += fraction * share;
    }
    sum += fraction;
  }
  if (!(std::abs(sum - 1) <= 0.01))
  {
    std::ostringstream found;
    found << "a sum of " << sum;
    refuse(found.str());
  }
  for (auto& [element, fraction] : fractions)
  {
    fraction /= sum;
  }
  return fractions;
}

/// Mass fractions of NIST's compound of this name; empty if there is none.
MassFractions ParseNistName(const std::string& text, double& densityGPerCm3)
{
  const std::unique_ptr<compoundDataNIST, decltype(&FreeCompoundDataNIST)> compound(
    GetCompoundDataNISTByName(text.c_str(), nullptr), FreeCompoundDataNIST);
  MassFractions fractions;
  for (int element = 0; compound && element < compound->nElements; ++element)
  {
    fractions[compound->Elements[element]] += compound->massFractions[element];
    densityGPerCm3 = compound->density;
  }
  return fractions;
}

/// A hundred energies per decade, and one on each side of every absorption edge.
std::vector<double> EnergyGrid(const MassFractions& fractions)
{
  std::set<double> energies;
  const int steps = static_cast<int>(100 * std::log10(HighestKeV / LowestKeV));
  for (int step = 0; step <= steps; ++step)
  {
    energies.insert(LowestKeV * std::pow(HighestKeV / LowestKeV, double(step) / steps));
  }
  energies.insert({ LowestKeV, HighestKeV }); // whatever pow rounds to
  for (const auto& [element, fraction] : fractions)
  {
    for (const int shell : { K_SHELL, L1_SHELL, L2_SHELL, L3_SHELL, M1_SHELL, M5_SHELL })
    {
      const double edge = EdgeEnergy(element, shell, nullptr);
      if (edge > LowestKeV * 1.001 && edge < HighestKeV * 0.999)
      {
        // The cross sections jump up to 1e-4 beside the edge that xraylib states.
        energies.insert({ edge * (1 - 2e-4), edge * (1 + 2e-4) });
      }
    }
  }
  return { energies.begin(), energies.lower_bound(std::nextafter(HighestKeV, 1e9)) };
}

/// Parses any of the forms; no fractions if the text has none of them.
CompositionParts Parse(const std::string& text)
{
  CompositionParts found;
  found.MassFractions = ParseNistName(text, found.DensityGPerCm3);
  if (found.MassFractions.empty() && text.find(':') != std::string::npos)
  {
    found.MassFractions = ParseMixture(text);
  }
  if (found.MassFractions.empty())
  {
    found.MassFractions = ParseFormula(text);
    if (found.MassFractions.size() == 1)
    {
      found.DensityGPerCm3 = ElementDensity(found.MassFractions.begin()->first, nullptr);
    }
  }
  const NamedMaterial* const named =
    found.MassFractions.empty() ? FindNamedMaterial(text) : nullptr;
  if (named && named->Composition != text)
  {
    found = Parse(named->Composition);
    found.DensityGPerCm3 = named->DensityGPerCm3 > 0 ? named->DensityGPerCm3 : found.DensityGPerCm3;
  }
  return found;
}

InputError NoComposition(const std::string& text, const std::string& who)
{
  const std::vector<std::string> near = SpellingSuggestions(text, CompositionNames());
  return InputError(who +
    ": expected an element, a formula, mass fractions or a NIST compound, found '" + text + "'" +
    (near.empty() ? "" : "; " + SpellingHint(text, near)));
}
}

std::vector<std::string> CompositionNames()
{
  return NamesOfMaterials();
}

CompositionParts ParseComposition(const std::string& text, const std::string& who)
{
  CompositionParts found = Parse(text);
  if (found.MassFractions.empty())
  {
    throw NoComposition(text, who);
  }
  return found;
}

double TakeDensity(std::string& material, const std::string& who)
{
  const std::size_t at = material.rfind('@');
  if (at == std::string::npos)
  {
    return 0;
  }
  double density = 0;
  if (at == 0 || !ToNumber(material.substr(at + 1), density))
  {
    throw InputError(
      who + ": expected MATERIAL[@DENSITY], the density in g/cm3, found '" + material + "'");
  }
  CheckValidRange(ValidRanges::PartDensity, density, who + ": '" + material + "'", {});
  material.resize(at);
  return density;
}

AttenuationTable RequireComposition(const std::string& text, const std::string& who)
{
  AttenuationTable table;
  if (!FindComposition(text, table))
  {
    throw NoComposition(text, who);
  }
  return table;
}

bool FindComposition(const std::string& text, AttenuationTable& table)
{
  const auto [fractions, density] = Parse(text);
  if (fractions.empty())
  {
    return false;
  }
  table = {};
  table.Name = text;
  table.HasDensity = density > 0;
  table.NominalDensityGPerCm3 = table.HasDensity ? density : 1;
  table.EnergiesKeV = EnergyGrid(fractions);
  for (const double energy : table.EnergiesKeV)
  {
    double massAttenuation = 0; // cm^2/g
    for (const auto& [element, fraction] : fractions)
    {
      xrl_error* failure = nullptr;
      massAttenuation += fraction * CS_Total(element, energy, &failure);
      if (failure)
      {
        const std::string reason = failure->message;
        xrl_error_free(failure);
        throw InputError("composition '" + text + "': no cross section of element " +
          std::to_string(element) + ": " + reason);
      }
    }
    table.MuPerMm.push_back(0.1 * table.NominalDensityGPerCm3 * massAttenuation);
  }
  table.Validate();
  return true;
}

AttenuationTable WithIodine(const AttenuationTable& table, double densityGPerCm3,
  double iodineMgPerMl)
{
  if (!(densityGPerCm3 > 0) || !std::isfinite(densityGPerCm3) || !(iodineMgPerMl >= 0) ||
    !std::isfinite(iodineMgPerMl))
  {
    throw InputError("iodine: expected a positive density and mg per ml of at least 0");
  }
  const AttenuationTable iodine = RequireComposition("I", "iodine");
  const double lowest = std::max(table.EnergiesKeV.front(), iodine.EnergiesKeV.front());
  const double highest = std::min(table.EnergiesKeV.back(), iodine.EnergiesKeV.back());
  std::set<double> energies{ lowest, highest };
  for (const AttenuationTable* part : { &table, &iodine })
  {
    std::copy_if(part->EnergiesKeV.begin(), part->EnergiesKeV.end(),
      std::inserter(energies, energies.end()),
      [&](double energy) { return energy > lowest && energy < highest; });
  }
  AttenuationTable mixed;
  mixed.Name = table.Name + " with iodine";
  mixed.NominalDensityGPerCm3 = densityGPerCm3;
  mixed.EnergiesKeV.assign(energies.begin(), energies.end());
  for (const double energy : mixed.EnergiesKeV)
  {
    mixed.MuPerMm.push_back(
      table.MuAt(energy, densityGPerCm3) + iodine.MuAt(energy, 1e-3 * iodineMgPerMl));
  }
  return mixed;
}
}
