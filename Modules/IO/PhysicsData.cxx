// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/PhysicsData.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/NearNames.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/XRay/Composition.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include <dlfcn.h>

namespace fs = std::filesystem;

namespace mammoray
{
namespace
{
std::string Place(const std::string& path, std::size_t line)
{
  return path + ": line " + std::to_string(line);
}

std::ifstream Open(const std::string& path)
{
  std::ifstream file(path);
  if (!file || fs::is_directory(path))
  {
    throw InputError(path + ": cannot be opened for reading");
  }
  return file;
}

/// The whole text as a number, in any locale.
bool ToNumber(const std::string& text, double& value)
{
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

/// Names of the files with that extension in a folder, sorted.
std::vector<std::string> KnownNames(const fs::path& folder, const std::string& extension)
{
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
  {
    if (entry.path().extension() == extension)
    {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// share/mammoray of the installation this library belongs to.
fs::path InstalledData()
{
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&DataDirectory), &info) == 0 || !info.dli_fname)
  {
    return {};
  }
  std::error_code ignored;
  const fs::path library = fs::weakly_canonical(info.dli_fname, ignored);
  // <prefix>/lib[/<triplet>]/libmammorayIO.so
  for (fs::path folder = library.parent_path(); folder.has_relative_path();
       folder = folder.parent_path())
  {
    if (fs::is_directory(folder / "share/mammoray/attenuation", ignored))
    {
      return folder / "share/mammoray";
    }
  }
  return {};
}

/// The path itself, or that of a shipped file by its name without extension.
std::string FindDataFile(const std::string& pathOrName, const std::string& what,
  const std::string& folderName, const std::string& extension)
{
  std::error_code ignored;
  if (fs::is_regular_file(pathOrName, ignored))
  {
    return pathOrName;
  }
  const fs::path folder = fs::path(DataDirectory()) / folderName;
  const fs::path path = folder / (pathOrName + extension);
  if (pathOrName.empty() || pathOrName.find('/') != std::string::npos || !fs::exists(path))
  {
    throw InputError(what + " " + pathOrName + ": no such file, and no " + what +
      " of that name; " + SuggestNames(pathOrName, KnownNames(folder, extension)));
  }
  return path.string();
}
}

std::string DataDirectory()
{
  if (const char* variable = std::getenv("MAMMORAY_DATA"))
  {
    if (!fs::is_directory(fs::path(variable) / "attenuation"))
    {
      throw InputError(
        std::string("MAMMORAY_DATA: expected a folder that holds attenuation/, found ") + variable);
    }
    return variable;
  }
  if (fs::is_directory(MAMMORAY_SOURCE_DATA "/attenuation"))
  {
    return MAMMORAY_SOURCE_DATA;
  }
  const fs::path installed = InstalledData();
  if (installed.empty())
  {
    throw InputError(
      "expected share/mammoray beside the library, found none; the environment variable "
      "MAMMORAY_DATA can name the folder that holds attenuation/ and spectra/");
  }
  return installed.string();
}

Spectrum ReadSpectrum(const std::string& path)
{
  std::ifstream file = Open(path);
  Spectrum spectrum;
  spectrum.Name = fs::path(path).stem().string();
  std::vector<double> density;
  bool ended = false;
  std::string line;
  for (std::size_t lineNumber = 1; !ended && std::getline(file, line); ++lineNumber)
  {
    line.erase(std::min(line.find('#'), line.size()));
    std::istringstream words(line);
    std::string energyText;
    std::string photonsText;
    std::string rest;
    if (!(words >> energyText))
    {
      continue;
    }
    double energy = 0;
    double photons = 0;
    if (!(words >> photonsText) || (words >> rest) || !ToNumber(energyText, energy) ||
      !ToNumber(photonsText, photons))
    {
      throw InputError(
        Place(path, lineNumber) + ": expected an energy (eV) and a number of photons");
    }
    if (!(energy > 0) ||
      (!spectrum.EnergiesKeV.empty() && !(energy * 1e-3 > spectrum.EnergiesKeV.back())))
    {
      throw InputError(Place(path, lineNumber) +
        ": expected a positive energy above the one before, found " + energyText + " eV");
    }
    spectrum.EnergiesKeV.push_back(energy * 1e-3);
    density.push_back(photons);
    ended = photons < 0;
  }
  if (!ended || density.size() < 2)
  {
    throw InputError(path + ": expected a list of photons that ends with a negative value");
  }
  for (std::size_t bin = 0; bin + 1 < density.size(); ++bin)
  {
    spectrum.Weights.push_back(
      density[bin] * (spectrum.EnergiesKeV[bin + 1] - spectrum.EnergiesKeV[bin]));
  }
  spectrum.EnergiesKeV.pop_back();
  spectrum.Validate();
  return spectrum;
}

AttenuationTable ReadAttenuationTable(const std::string& path)
{
  std::ifstream file = Open(path);
  AttenuationTable table;
  table.Name = fs::path(path).stem().string();
  std::string line;
  std::size_t energyColumn = 0;
  std::size_t muColumn = 0;
  bool hasDensity = false;
  bool hasHeader = false;
  for (std::size_t lineNumber = 1; std::getline(file, line); ++lineNumber)
  {
    if (!line.empty() && line.back() == '\r')
    {
      line.pop_back();
    }
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
          Place(path, lineNumber) + ": expected the columns energy_eV and mu_total_per_cm");
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
      throw InputError(Place(path, lineNumber) +
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

AttenuationTable FindAttenuationTable(const std::string& name)
{
  const fs::path folder = fs::path(DataDirectory()) / "attenuation";
  const fs::path path = folder / (name + ".csv");
  if (!name.empty() && name.find('/') == std::string::npos && fs::exists(path))
  {
    return ReadAttenuationTable(path.string());
  }
  AttenuationTable table;
  if (FindComposition(name, table))
  {
    return table;
  }
  const std::vector<std::string> tables = KnownNames(folder, ".csv");
  std::vector<std::string> known = tables;
  const std::vector<std::string> compounds = NistCompoundNames();
  known.insert(known.end(), compounds.begin(), compounds.end());
  throw InputError("unknown attenuation '" + name + "'; " +
    (NearNames(name, known).empty() ? SuggestNames(name, tables) +
          ", NIST's compounds ('Water, Liquid'), formulas ('H2O'), mass fractions ('H:0.112 "
          "O:0.888')"
                                    : SuggestNames(name, known)));
}

Spectrum FindSpectrum(const std::string& pathOrName)
{
  return ReadSpectrum(FindDataFile(pathOrName, "spectrum", "spectra", ".spc"));
}

std::string FindMaterialTablePath(const std::string& pathOrName)
{
  return FindDataFile(pathOrName, "material table", "materials", ".json");
}

MaterialTable FindMaterialTable(const std::string& pathOrName)
{
  return ReadMaterialTable(FindMaterialTablePath(pathOrName));
}

Beam MakeBeam(const MaterialTable& materials, const Spectrum& spectrum, DetectorResponse response)
{
  std::vector<AttenuationTable> tables(materials.Materials.size());
  std::vector<const AttenuationTable*> pointers(tables.size(), nullptr);
  std::vector<double> densities(tables.size(), 0.0);
  for (std::size_t material = 1; material < tables.size(); ++material)
  {
    try
    {
      tables[material] = FindAttenuationTable(materials.Materials[material].Attenuation);
    }
    catch (const InputError& error)
    {
      throw InputError("material '" + materials.Materials[material].Name + "': " + error.what());
    }
    pointers[material] = &tables[material];
    densities[material] = materials.Materials[material].DensityGPerCm3;
  }
  return Beam(spectrum, response, pointers, densities);
}
}
