// SPDX-License-Identifier: Apache-2.0
#include "Private/SpectrumIO.h"

#include "Private/InputFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/ShippedData.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <regex>
#include <set>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
/// A table of an energy and a value per line, as programs and people write it.
struct EnergyTable
{
  /// Numbers of a line.
  struct Row
  {
    std::vector<double> Numbers;
    std::size_t Line = 0;
  };
  std::string Path;
  /// Lines before the first row, and what follows '#' and "//"; in lower case.
  std::string Titles;
  std::string Comments;
  std::vector<Row> Rows;

  std::string NameOf(const Row& row) const { return LineName(this->Path, row.Line); }
};

/// The cells of a line. They are parted by semicolons, otherwise by tabs, commas or blanks; commas
/// are decimal ones between semicolons, and where each of two cells has one, as in quotes: but for
/// "1,200", which may be a thousand.
std::vector<std::string> CellsOf(const std::string& line)
{
  const auto split = [&line](const char* separators)
  {
    std::vector<std::string> cells;
    std::size_t at = 0;
    while ((at = line.find_first_not_of(separators, at)) != std::string::npos)
    {
      const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
      cells.push_back(line.substr(at, end - at));
      at = end;
    }
    return cells;
  };
  const auto withPoints = [](std::vector<std::string> cells)
  {
    for (std::string& cell : cells)
    {
      std::replace(cell.begin(), cell.end(), ',', '.');
    }
    return cells;
  };
  if (line.find(';') != std::string::npos)
  {
    return withPoints(split("; \t\""));
  }
  static const std::regex quoted(
    "\"(-?\\d{1,20},\\d{1,20})\"[, \t]{1,9}\"(-?\\d{1,20},\\d{1,20})\"\\s{0,9}");
  static const std::regex thousands("[1-9]\\d{0,2},\\d{3}");
  if (std::smatch two; std::regex_match(line, two, quoted) &&
      !(std::regex_match(two[1].str(), thousands) || std::regex_match(two[2].str(), thousands)))
  {
    return withPoints({ two[1].str(), two[2].str() });
  }
  const std::vector<std::string> byBlanks = split(" \t\"");
  const auto hasComma = [](const std::string& cell)
  { return std::count(cell.begin() + 1, cell.end() - 1, ',') == 1; };
  const bool isDecimal = byBlanks.size() == 2 &&
    std::all_of(byBlanks.begin(), byBlanks.end(),
      [&](const std::string& cell) { return cell.size() > 2 && hasComma(cell); });
  return isDecimal ? withPoints(byBlanks) : split(", \t\"");
}

/// All numbers of a line. Empty if one of its cells is none.
std::vector<double> RowNumbers(const std::vector<std::string>& cells)
{
  std::vector<double> numbers;
  for (const std::string& cell : cells)
  {
    double number = 0;
    // Fortran writes the exponent of a double as D.
    std::string text = cell;
    const std::size_t exponent = text.find_first_of("Dd");
    if (exponent != std::string::npos && exponent > 0)
    {
      text[exponent] = 'e';
    }
    if (!ToPaddedNumber(text, number))
    {
      return {};
    }
    numbers.push_back(number);
  }
  return numbers;
}

/// `expected`: what a line holds, for messages. `isEnded`: a row with a negative second number is
/// the last one, whatever follows.
EnergyTable ReadEnergyTable(const std::string& path, const char* expected, bool isEnded = false)
{
  EnergyTable table;
  std::string likeRow; // the first line that begins as one
  table.Path = path;
  std::ifstream file = OpenText(path);
  std::string text;
  for (std::size_t line = 1; ReadLine(file, text); ++line)
  {
    if (line == 1 && text.starts_with("\xef\xbb\xbf"))
    {
      text.erase(0, 3);
    }
    if (line == 1 && (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")))
    {
      throw InputError(path + ": expected text in UTF-8 or ASCII, found UTF-16");
    }
    const auto comment = std::min(text.find('#'), text.find("//"));
    if (comment != std::string::npos)
    {
      table.Comments += text.substr(comment) + '\n';
      text.erase(comment);
    }
    const std::vector<std::string> cells = CellsOf(text);
    std::vector<double> numbers = RowNumbers(cells);
    // A number alone may be the count of rows before them, and an edge after them.
    const bool isHeader = table.Rows.empty() && numbers.size() < 2;
    if (isHeader || cells.empty())
    {
      table.Titles += table.Rows.empty() ? text + '\n' : "";
      const bool isLikeRow = !cells.empty() && cells.front().find_first_of("0123456789") < 2;
      if (likeRow.empty() && isLikeRow)
      {
        likeRow = LineName(path, line) + ": expected " + expected + ", found '" + text + "'";
      }
      continue;
    }
    if (numbers.empty())
    {
      throw InputError(LineName(path, line) + ": expected " + expected);
    }
    table.Rows.push_back({ std::move(numbers), line });
    const std::vector<double>& row = table.Rows.back().Numbers;
    if (isEnded && row.size() == 2 && row[1] < 0)
    {
      break;
    }
  }
  for (std::string* const said : { &table.Titles, &table.Comments })
  {
    std::transform(said->begin(), said->end(), said->begin(),
      [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  }
  if (table.Rows.empty())
  {
    throw InputError(
      likeRow.empty() ? path + ": expected lines of " + expected + ", found none" : likeRow);
  }
  return table;
}

/// A unit of energy, in keV.
struct EnergyUnit
{
  const char* Name;
  double KeV;
};
constexpr EnergyUnit EnergyUnits[] = { { "eV", 1e-3 }, { "keV", 1 }, { "MeV", 1e3 } };

/// Whether a text in lower case names a unit.
bool NamesUnit(const std::string& text, const EnergyUnit& unit)
{
  std::string name = unit.Name;
  name.front() = static_cast<char>(std::tolower(name.front()));
  return std::regex_search(text,
    std::regex("(?:^|[^a-z])" + name.substr(0, name.size() - 1) + "v(?![a-z])"));
}

bool NamesAnyUnit(const std::string& text)
{
  return std::any_of(std::begin(EnergyUnits), std::end(EnergyUnits),
    [&text](const EnergyUnit& unit) { return NamesUnit(text, unit); });
}

/// Whether values are told to be densities in energy: "photons per keV", or, after the title of the
/// energies, "E/keV, N/keV", "E (keV), N (1/(mm2 keV))".
bool NamesDensity(const std::string& said)
{
  static const std::regex plain("per ?\\(? ?[km]?ev(?![a-z])");
  static const std::regex unit("[km]?ev(?![a-z])");
  static const std::regex density("/ ?(?:\\([^()]{0,20})?[km]?ev(?![a-z])|[km]?ev ?\\^? ?-1");
  std::smatch first;
  return std::regex_search(said, plain) ||
    (std::regex_search(said, first, unit) &&
      std::regex_search(first.suffix().first, said.end(), density));
}

bool NamesCentres(const std::string& text)
{
  return std::regex_search(text, std::regex("cent(?:er|re)|mid"));
}

bool NamesEdges(const std::string& text)
{
  return std::regex_search(text,
    std::regex("edges|(?:bin|lower|left|low|energy)[ _-]?edge|lower|(?:^|[^a-z])e_?min"));
}

/// Edges of bins, keV, one more than values.
struct Bins
{
  std::vector<double> Edges;
  std::vector<double> Values;
};

/// Throws InputError, which names the row, unless its energy is above the one before.
void CheckAscending(const EnergyTable& table, double least)
{
  double before = least;
  for (const EnergyTable::Row& row : table.Rows)
  {
    if (!(row.Numbers[0] > before) || !std::isfinite(row.Numbers[0]))
    {
      throw InputError(table.NameOf(row) +
        ": expected a positive energy above the one before, found " + NumberText(row.Numbers[0]));
    }
    before = row.Numbers[0];
  }
}

/// Of our own form, .spc: eV and photons per keV up to the next energy; a negative value ends them.
Spectrum OwnSpectrum(const EnergyTable& table)
{
  Spectrum spectrum;
  CheckAscending(table, 0);
  std::vector<double> density;
  for (const EnergyTable::Row& row : table.Rows)
  {
    if (row.Numbers.size() != 2)
    {
      throw InputError(table.NameOf(row) + ": expected an energy (eV) and a number of photons");
    }
    spectrum.EnergiesKeV.push_back(row.Numbers[0] * 1e-3);
    density.push_back(row.Numbers[1]);
  }
  if (density.size() < 2 || !(density.back() < 0))
  {
    throw InputError(table.Path + ": expected a list of photons that ends with a negative value");
  }
  if (spectrum.EnergiesKeV.back() < 1)
  {
    throw InputError(table.Path + ": expected energies in eV, found none above " +
      NumberText(table.Rows.back().Numbers[0]) +
      ": a table in another unit has another extension, such as .txt");
  }
  for (std::size_t bin = 0; bin + 1 < density.size(); ++bin)
  {
    spectrum.Weights.push_back(
      density[bin] * (spectrum.EnergiesKeV[bin + 1] - spectrum.EnergiesKeV[bin]));
  }
  spectrum.EnergiesKeV.pop_back();
  return spectrum;
}

/// Bins of lines "from, to, photons", which follow each other.
Bins BinsOfEdges(const EnergyTable& table)
{
  Bins bins;
  for (const EnergyTable::Row& row : table.Rows)
  {
    const std::vector<double>& numbers = row.Numbers;
    const bool follows =
      bins.Edges.empty() || std::abs(numbers[0] - bins.Edges.back()) <= 1e-6 * numbers[1];
    if (numbers.size() != 3 || !(numbers[1] > numbers[0]) || !follows)
    {
      throw InputError(table.NameOf(row) +
        ": expected an energy and a number of photons, or both edges of a bin, which begins where "
        "the one before ends, and its photons; of several columns of photons, keep one");
    }
    if (bins.Edges.empty())
    {
      bins.Edges.push_back(numbers[0]);
    }
    bins.Edges.push_back(numbers[1]);
    bins.Values.push_back(numbers[2]);
  }
  return bins;
}

/// Bins of lines "from, photons". A last edge may stand alone or with no photons; without it the
/// last bin is as wide as the one before.
Bins BinsOfLowerEdges(const EnergyTable& table)
{
  Bins bins;
  for (const EnergyTable::Row& row : table.Rows)
  {
    bins.Edges.push_back(row.Numbers[0]);
    bins.Values.push_back(row.Numbers.size() > 1 ? row.Numbers[1] : 0);
  }
  if (!(bins.Values.back() > 0))
  {
    bins.Values.pop_back();
  }
  else
  {
    bins.Edges.push_back(2 * bins.Edges.back() - bins.Edges[bins.Edges.size() - 2]);
  }
  if (bins.Values.empty())
  {
    throw InputError(table.Path + ": expected photons, found none");
  }
  return bins;
}

/// Bins that meet half-way between the energies of lines "centre, photons".
Bins BinsOfCentres(const EnergyTable& table)
{
  Bins bins;
  const std::vector<EnergyTable::Row>& rows = table.Rows;
  const auto energy = [&rows](std::size_t row) { return rows[row].Numbers[0]; };
  bins.Edges.push_back(1.5 * energy(0) - 0.5 * energy(1));
  for (std::size_t row = 0; row < rows.size(); ++row)
  {
    const bool isLast = row + 1 == rows.size();
    bins.Edges.push_back(
      isLast ? 1.5 * energy(row) - 0.5 * energy(row - 1) : 0.5 * (energy(row) + energy(row + 1)));
    bins.Values.push_back(rows[row].Numbers[1]);
  }
  return bins;
}

/// Makes a row of each energy where a first line holds all of them and a second one the values.
void TurnRows(std::vector<EnergyTable::Row>& rows)
{
  if (rows.size() != 2 || rows[0].Numbers.size() < 4 ||
    rows[0].Numbers.size() != rows[1].Numbers.size())
  {
    return;
  }
  std::vector<EnergyTable::Row> turned;
  for (std::size_t column = 0; column < rows[0].Numbers.size(); ++column)
  {
    turned.push_back({ { rows[0].Numbers[column], rows[1].Numbers[column] }, rows[1].Line });
  }
  rows = std::move(turned);
}

/// Throws InputError unless the rows hold an energy and photons each, or both edges and photons; a
/// last edge may stand alone.
void CheckRows(const EnergyTable& table)
{
  const std::size_t columns = table.Rows.front().Numbers.size();
  for (const EnergyTable::Row& row : table.Rows)
  {
    const bool isLast = &row == &table.Rows.back();
    const std::vector<double>& numbers = row.Numbers;
    const bool isWhole = numbers.size() == columns && (columns == 2 || columns == 3);
    if (!isWhole && !(isLast && columns == 2 && numbers.size() == 1))
    {
      throw InputError(table.NameOf(row) +
        ": expected an energy and a number of photons, or both edges of a bin and its photons, "
        "found " +
        std::to_string(numbers.size()) + " number(s)" +
        (numbers.size() == columns ? ": of several spectra, keep the column of one"
                                   : ", after " + std::to_string(columns) + " in line " +
              std::to_string(table.Rows.front().Line)));
    }
    const bool isPhotons = numbers.size() == 1 || numbers.back() >= 0;
    if (!isPhotons || !std::isfinite(numbers.back()))
    {
      throw InputError(table.NameOf(row) + ": expected a number of photons, found " +
        NumberText(numbers.back()) +
        (isPhotons ? "" : " (a negative one ends a table in an .spc file only)"));
    }
  }
}

/// A table of other programs, in its own unit; and what had to be inferred of it, for a note.
Spectrum OtherSpectrum(EnergyTable table, std::string& inferred)
{
  std::vector<EnergyTable::Row>& rows = table.Rows;
  TurnRows(rows);
  CheckRows(table);
  const bool isWhole = rows.back().Numbers.size() > 1;
  if (isWhole && rows.front().Numbers[0] > rows.back().Numbers[0])
  {
    std::reverse(rows.begin(), rows.end());
  }
  CheckAscending(table, -1e-300); // an edge may be 0
  const std::string said = table.Titles + table.Comments;
  const bool threeColumns = rows.front().Numbers.size() == 3;
  const bool saysCentres = NamesCentres(said);
  const bool areEdges = rows.back().Numbers.size() == 1 || rows.front().Numbers[0] <= 0 ||
    (NamesEdges(said) && !saysCentres);
  if (areEdges && !threeColumns && rows.size() < 2)
  {
    throw InputError(table.Path + ": expected at least two edges of bins, found one");
  }
  Spectrum spectrum;
  if (!areEdges && !threeColumns && rows.size() == 1)
  {
    spectrum.EnergiesKeV = { rows.front().Numbers[0] };
    spectrum.Weights = { rows.front().Numbers[1] };
    return spectrum;
  }
  const Bins bins = threeColumns ? BinsOfEdges(table)
    : areEdges                   ? BinsOfLowerEdges(table)
                                 : BinsOfCentres(table);
  // Counts are those of a bin, whatever its width, unless the header says otherwise.
  const bool areDensities = NamesDensity(table.Titles) || NamesDensity(table.Comments);
  if (!threeColumns && !areEdges && !saysCentres)
  {
    inferred = std::string("values as photons ") + (areDensities ? "per keV" : "of bins") +
      " around their energies";
  }
  for (std::size_t bin = 0; bin < bins.Values.size(); ++bin)
  {
    const double low = bins.Edges[bin];
    const double high = bins.Edges[bin + 1];
    spectrum.EnergiesKeV.push_back(
      threeColumns || areEdges ? 0.5 * (low + high) : rows[bin].Numbers[0]);
    spectrum.Weights.push_back(bins.Values[bin] * (areDensities ? high - low : 1));
  }
  return spectrum;
}

/// Turns energies into keV. Their size tells the unit, since spectra end between 2 keV and 2 MeV;
/// what the titles of the columns name must be the same.
void ToKeV(const EnergyTable& table, Spectrum& spectrum, std::string& inferred)
{
  constexpr double LowestEnd = 2;
  constexpr double HighestEnd = 2000;
  const double last = spectrum.EnergiesKeV.back();
  const EnergyUnit& unit = EnergyUnits[last > HighestEnd ? 0 : last > LowestEnd ? 1 : 2];
  const bool isNamed = NamesUnit(table.Titles + table.Comments, unit);
  const std::string found = NumberText(last);
  const bool isOther = !isNamed && NamesAnyUnit(table.Titles);
  if (isOther || last * unit.KeV > HighestEnd || last * unit.KeV < LowestEnd)
  {
    throw InputError(table.Path +
      ": expected a spectrum that ends between 2 keV and 2 MeV, found energies up to " + found +
      ' ' + unit.Name + (isOther ? ", although the titles name another unit" : ""));
  }
  for (double& energy : spectrum.EnergiesKeV)
  {
    energy *= unit.KeV;
  }
  if (!isNamed)
  {
    inferred = std::string("energies as ") + unit.Name + " (up to " + found + ")" +
      (inferred.empty() ? "" : " and ") + inferred;
  }
}
}

Spectrum ReadSpectrum(const std::string& path)
{
  const bool isOwn = ExtensionOf(path) == ".spc";
  const EnergyTable table = ReadEnergyTable(path, "an energy and a number of photons", isOwn);
  Spectrum spectrum;
  if (isOwn)
  {
    spectrum = OwnSpectrum(table);
  }
  else
  {
    std::string inferred;
    spectrum = OtherSpectrum(table, inferred);
    ToKeV(table, spectrum, inferred);
    if (!inferred.empty())
    {
      Note({ path,
        "takes " + inferred +
          "; a header line that names the unit (eV, keV, MeV), 'centre' or 'edge', and 'per keV' "
          "of densities settles it" });
    }
  }
  spectrum.Name = std::filesystem::path(path).stem().string();
  spectrum.Validate();
  return spectrum;
}

DetectorResponse ReadDetectorResponse(const std::string& path)
{
  const EnergyTable table = ReadEnergyTable(path, "an energy (keV) and a signal");
  const double unit = NamesUnit(table.Titles, EnergyUnits[0]) ? 1e-3
    : NamesUnit(table.Titles, EnergyUnits[2])                 ? 1e3
                                                              : 1;
  DetectorResponse response;
  response.ByEnergy = false;
  for (const EnergyTable::Row& row : table.Rows)
  {
    const std::vector<double>& numbers = row.Numbers;
    const double before = response.EnergiesKeV.empty() ? 0 : response.EnergiesKeV.back();
    const double energy = numbers[0] * unit;
    if (numbers.size() != 2 || !(energy > before) || !std::isfinite(energy) || !(numbers[1] >= 0) ||
      !std::isfinite(numbers[1]))
    {
      throw InputError(table.NameOf(row) +
        ": expected a positive energy above the one before and a signal that is not negative");
    }
    response.EnergiesKeV.push_back(energy);
    response.Efficiency.push_back(numbers[1]);
  }
  return response;
}

LineSpread ReadLineSpread(const std::string& path)
{
  const EnergyTable table = ReadEnergyTable(path, "a distance (mm) and a value");
  std::map<double, double> sides;
  double last = -std::numeric_limits<double>::infinity();
  for (const EnergyTable::Row& row : table.Rows)
  {
    const std::vector<double>& numbers = row.Numbers;
    if (numbers.size() != 2 || !(numbers[0] > last) || !std::isfinite(numbers[0]) ||
      !(numbers[1] >= 0) || !std::isfinite(numbers[1]))
    {
      throw InputError(table.NameOf(row) +
        ": expected a distance (mm) above the one before and a value that is not negative");
    }
    last = numbers[0];
    sides[numbers[0]] = numbers[1];
  }
  const bool isBoth = !sides.empty() && sides.begin()->first < 0;
  const auto at = [&](double distance)
  {
    const auto above = sides.lower_bound(distance);
    if (above == sides.end() || (above == sides.begin() && above->first != distance))
    {
      return 0.0;
    }
    if (above->first == distance)
    {
      return above->second;
    }
    const auto below = std::prev(above);
    const double share = (distance - below->first) / (above->first - below->first);
    return (1 - share) * below->second + share * above->second;
  };
  std::set<double> distances{ 0 };
  for (const auto& [distance, value] : sides)
  {
    distances.insert(std::abs(distance));
  }
  LineSpread spread;
  for (const double distance : distances)
  {
    spread.DistancesMm.push_back(distance);
    spread.Values.push_back(isBoth ? 0.5 * (at(distance) + at(-distance)) : at(distance));
  }
  try
  {
    if (!isBoth && !sides.contains(0))
    {
      throw InputError("expected a value at the distance 0, found none");
    }
    spread.Validate();
  }
  catch (const InputError& error)
  {
    throw InputError(path + ": " + error.what());
  }
  return spread;
}
}
