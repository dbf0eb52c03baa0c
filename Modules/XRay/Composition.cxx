// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Composition.h"

#include "Private/MaterialNames.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/Foundation/ValidRange.h"

#include <xraylib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

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

bool IsSymbol(const std::string& text)
{
  return SymbolToAtomicNumber(text.c_str(), nullptr) > 0;
}

/// Heavier elements than lead and bismuth, which no part is made of, are not taken for a mistake.
constexpr int HeaviestUsual = 83;
constexpr int HeaviestNamed = 92;

/// "phosphorus and boron", of a formula's symbols.
std::string ElementsIn(const std::vector<std::string>& symbols)
{
  std::vector<std::string> names;
  for (const std::string& symbol : symbols)
  {
    const int number = SymbolToAtomicNumber(symbol.c_str(), nullptr);
    const std::string name = number > 0 && number <= HeaviestNamed ? ElementName(number) : symbol;
    if (std::find(names.begin(), names.end(), name) == names.end())
    {
      names.push_back(name);
    }
  }
  std::string text;
  for (std::size_t index = 0; index < names.size(); ++index)
  {
    text += index == 0 ? "" : index + 1 < names.size() ? ", " : " and ";
    text += names[index];
  }
  return text;
}

/// The other element for which a pair of symbols in capitals stands perhaps, "Pb" for PB; empty if
/// there is none. `isWhole`: the formula has no numbers. "CO2", "K2CO3" and organic formulas have
/// pairs that nobody takes for cobalt.
std::string MistakenSymbol(const std::string& text, std::size_t at, bool isWhole)
{
  const std::string symbol{ text[at],
    static_cast<char>(std::tolower(static_cast<unsigned char>(text[at + 1]))) };
  const int number = SymbolToAtomicNumber(symbol.c_str(), nullptr);
  const bool isOrganic = text.find('C') != std::string::npos && text.find('H') != std::string::npos;
  const std::set<std::string> groups{ "Co", "Cs", "Ho", "Os" };
  const bool isPossible = isWhole || (!isOrganic && groups.count(symbol) == 0);
  const int heaviest = text.size() == 2 ? HeaviestNamed : HeaviestUsual;
  return number > 0 && number <= heaviest && isPossible ? symbol : "";
}

/**
 * Throws InputError on a formula that may mean something else: in capitals, a pair that is another
 * element's symbol ("PB", "SIO2"); without numbers, an element twice in a row ("PP") or capitals
 * that begin with P, as the short names of plastics do ("PSU"). With all numbers ("P1B1") a
 * formula has one meaning.
 */
void RefuseAmbiguousFormula(const std::string& text)
{
  std::vector<std::string> symbols;
  std::string withNumbers;
  bool isTwice = false;
  for (std::size_t at = 0; at < text.size();)
  {
    std::string symbol(1, text[at++]);
    if (std::isupper(static_cast<unsigned char>(symbol[0])) == 0)
    {
      withNumbers += symbol;
      continue;
    }
    while (at < text.size() && std::islower(static_cast<unsigned char>(text[at])) != 0)
    {
      symbol += text[at++];
    }
    isTwice = isTwice || (!symbols.empty() && symbols.back() == symbol);
    symbols.push_back(symbol);
    const bool hasNumber =
      at < text.size() && (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.');
    withNumbers += symbol + (hasNumber ? "" : "1");
  }
  const bool isWhole = std::all_of(text.begin(), text.end(),
    [](unsigned char letter) { return std::isalpha(letter) != 0; });
  const bool isCapital = std::none_of(text.begin(), text.end(),
    [](unsigned char letter) { return std::islower(letter) != 0; });
  std::string problem;
  for (std::size_t at = 0; isCapital && problem.empty() && at + 1 < text.size(); ++at)
  {
    const bool isPair = std::isupper(static_cast<unsigned char>(text[at])) != 0 &&
      std::isupper(static_cast<unsigned char>(text[at + 1])) != 0;
    const std::string other = isPair ? MistakenSymbol(text, at, isWhole) : "";
    if (!other.empty())
    {
      problem = "; " + ElementsIn({ other }) + " is '" + other + "'";
    }
  }
  if (problem.empty() && isWhole && isTwice)
  {
    problem = ", one of them twice in a row";
  }
  if (problem.empty() && isWhole && isCapital && text.size() > 1 && text[0] == 'P')
  {
    problem = "; if it is a plastic, its full name or composition is needed";
  }
  if (!problem.empty())
  {
    throw InputError("'" + text + "' is a formula of " + ElementsIn(symbols) + problem +
      " (as a formula: '" + withNumbers + "')");
  }
}

/// Mass fractions of a formula or an element; empty if the text is neither. Throws InputError on an
/// ambiguous formula.
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
  if (!fractions.empty())
  {
    RefuseAmbiguousFormula(text);
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

/// The energies just below and above the jump of an element's cross section, keV, which is up to
/// 1e-4 beside the edge that xraylib states.
std::array<double, 2> SidesOfEdge(int element, double edge)
{
  double below = edge * (1 - 2e-4);
  double above = edge * (1 + 2e-4);
  const double middle =
    std::sqrt(CS_Total(element, below, nullptr) * CS_Total(element, above, nullptr));
  while (above - below > 1e-9 * edge)
  {
    const double half = 0.5 * (below + above);
    (CS_Total(element, half, nullptr) < middle ? below : above) = half;
  }
  return { below, above };
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
    for (const int shell :
      { K_SHELL, L1_SHELL, L2_SHELL, L3_SHELL, M1_SHELL, M2_SHELL, M3_SHELL, M4_SHELL, M5_SHELL })
    {
      const double edge = EdgeEnergy(element, shell, nullptr);
      if (edge > LowestKeV * 1.001 && edge < HighestKeV * 0.999)
      {
        const std::array<double, 2> sides = SidesOfEdge(element, edge);
        energies.insert(sides.begin(), sides.end());
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
  if (!found.MassFractions.empty())
  {
    return found;
  }
  // Names come before formulas, since PVC is none of phosphorus, vanadium and carbon; elements come
  // before names, which count in any case: Pa is no polyamide.
  const NamedMaterial* const named = IsSymbol(text) ? nullptr : FindNamedMaterial(text);
  if (named && named->Composition != text)
  {
    found = Parse(named->Composition);
    found.DensityGPerCm3 = named->DensityGPerCm3 > 0 ? named->DensityGPerCm3 : found.DensityGPerCm3;
    return found;
  }
  found.MassFractions = ParseFormula(text);
  if (found.MassFractions.size() == 1)
  {
    found.DensityGPerCm3 = ElementDensity(found.MassFractions.begin()->first, nullptr);
  }
  return found;
}

/// The symbol or the formula that a text is but for capitals: "Fe" of "FE" and "fe", "CaCO3" of
/// "CACO3", with as few symbols of two letters as possible. Empty if it is none, and of words such
/// as BRASS: more than two symbols without a number.
std::string WithSmallLetters(const std::string& text)
{
  const auto cased = [&text](std::size_t at, std::size_t count)
  {
    std::string symbol = text.substr(at, count);
    std::transform(symbol.begin(), symbol.end(), symbol.begin(),
      [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    symbol[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(symbol[0])));
    return symbol;
  };
  if ((text.size() == 1 || text.size() == 2) && IsSymbol(cased(0, text.size())))
  {
    return cased(0, text.size());
  }
  const auto isOther = [](unsigned char letter)
  { return std::isdigit(letter) != 0 || letter == '.' || letter == '(' || letter == ')'; };
  if (text.size() > MostLetters ||
    !std::all_of(text.begin(), text.end(),
      [&](unsigned char letter) { return isOther(letter) || std::isupper(letter) != 0; }))
  {
    return {};
  }
  // From the end: the best way to read what begins at each letter, with its pairs.
  std::vector<std::optional<std::pair<int, std::string>>> best(text.size() + 1);
  best[text.size()].emplace();
  for (std::size_t at = text.size(); at-- > 0;)
  {
    for (const std::size_t count : { 1U, 2U })
    {
      const auto& rest = best[std::min(at + count, text.size())];
      const std::string symbol = cased(at, count);
      const int number = SymbolToAtomicNumber(symbol.c_str(), nullptr);
      const bool isPart = symbol.size() == count &&
        ((number > 0 && number <= HeaviestUsual) || (count == 1 && isOther(symbol[0])));
      const int pairs = rest ? rest->first + static_cast<int>(count) - 1 : 0;
      if (isPart && rest && (!best[at] || pairs < best[at]->first))
      {
        best[at].emplace(pairs, symbol + rest->second);
      }
    }
  }
  const std::string formula = best[0] ? best[0]->second : "";
  const auto symbols = std::count_if(formula.begin(), formula.end(),
    [](unsigned char letter) { return std::isupper(letter) != 0; });
  const bool hasNumber = formula.find_first_of("0123456789") != std::string::npos;
  return symbols > 0 && (symbols <= 2 || hasNumber) ? formula : "";
}

InputError NoComposition(const std::string& text, const std::string& who)
{
  const std::vector<std::string> near = SpellingSuggestions(text, CompositionNames(text));
  return InputError(who +
    ": expected an element, a formula, mass fractions or a NIST compound, found '" + text + "'" +
    (near.empty() ? "" : "; " + SpellingHint(text, near)));
}
}

std::vector<std::string> CompositionNames(const std::string& unknown)
{
  std::vector<std::string> names = NamesOfMaterials();
  if (std::string formula = WithSmallLetters(unknown); !formula.empty())
  {
    names.push_back(std::move(formula));
  }
  return names;
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

std::string MixtureText(const std::map<int, double>& massFractions)
{
  std::string text;
  for (const auto& [element, fraction] : massFractions)
  {
    const std::unique_ptr<char, decltype(&xrlFree)> symbol(AtomicNumberToSymbol(element, nullptr),
      xrlFree);
    text += text.empty() ? "" : " ";
    text += symbol ? symbol.get() : "";
    text += ':';
    text += NumberText(fraction);
  }
  return text;
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
