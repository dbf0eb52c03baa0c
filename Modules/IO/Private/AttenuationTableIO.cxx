// SPDX-License-Identifier: Apache-2.0
#include "Private/AttenuationTableIO.h"

#include "Private/InputFile.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <locale>
#include <sstream>
#include <vector>

namespace mammoray
{
AttenuationTable ReadAttenuationTable(const std::string& path)
{
  std::ifstream file = OpenText(path);
  AttenuationTable table;
  table.Name = std::filesystem::path(path).stem().string();
  std::string line;
  std::size_t energyColumn = 0;
  std::size_t muColumn = 0;
  bool hasDensity = false;
  bool hasHeader = false;
  for (std::size_t lineNumber = 1; ReadLine(file, line); ++lineNumber)
  {
    if (line.empty() || line[0] == '#')
    {
      static const std::string key = "nominal density ";
      const std::size_t at = line.find(key);
      if (at != std::string::npos && !hasDensity)
      {
        std::istringstream text(line.substr(at + key.size()));
        text.imbue(std::locale::classic());
        hasDensity = static_cast<bool>(text >> table.NominalDensityGPerCm3);
      }
      continue;
    }
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');)
    {
      cells.push_back(cell);
    }
    if (!hasHeader)
    {
      const auto energy = std::find(cells.begin(), cells.end(), "energy_eV");
      const auto mu = std::find(cells.begin(), cells.end(), "mu_total_per_cm");
      if (energy == cells.end() || mu == cells.end())
      {
        throw InputError(
          LineName(path, lineNumber) + ": expected the columns energy_eV and mu_total_per_cm");
      }
      energyColumn = static_cast<std::size_t>(energy - cells.begin());
      muColumn = static_cast<std::size_t>(mu - cells.begin());
      hasHeader = true;
      continue;
    }
    double energy = 0;
    double mu = 0;
    if (cells.size() <= std::max(energyColumn, muColumn) ||
      !ToNumber(cells[energyColumn], energy) || !ToNumber(cells[muColumn], mu))
    {
      throw InputError(LineName(path, lineNumber) +
        ": expected numbers in the columns energy_eV and "
        "mu_total_per_cm");
    }
    table.EnergiesKeV.push_back(energy * 1e-3);
    table.MuPerMm.push_back(mu * 0.1);
  }
  if (!hasDensity)
  {
    throw InputError(path + ": expected a comment with 'nominal density <number> g/cm3'");
  }
  table.Validate();
  return table;
}
}
