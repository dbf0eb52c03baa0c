// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/ShippedData.h"

#include "Private/AttenuationTableIO.h"
#include "Private/SpectrumIO.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/XRay/Composition.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include <dlfcn.h>

namespace fs = std::filesystem;

namespace mammoray
{
namespace
{
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
      " of that name; " + SpellingHint(pathOrName, KnownNames(folder, extension)));
  }
  return path.string();
}

/// FindComposition, whose last tables are kept: a loop over voltages or poses asks for them again
/// in every step, and each takes as long as a small picture.
std::optional<AttenuationTable> FindKnownComposition(const std::string& name)
{
  static std::mutex guard;
  static std::map<std::string, AttenuationTable> known;
  const std::lock_guard<std::mutex> held(guard);
  const auto found = known.find(name);
  if (found != known.end())
  {
    return found->second;
  }
  AttenuationTable table;
  if (!FindComposition(name, table))
  {
    return std::nullopt;
  }
  constexpr std::size_t mostKept = 64;
  if (known.size() >= mostKept)
  {
    known.clear();
  }
  return known.emplace(name, std::move(table)).first->second;
}

/// "0.05/mm", or "20:0.05 30:0.02/mm" by keV.
AttenuationTable ParseLinearAttenuation(const std::string& text)
{
  AttenuationTable table{ .Name = text };
  std::istringstream words(text.substr(0, text.size() - 3));
  for (std::string word; words >> word;)
  {
    const std::size_t colon = word.find(':');
    double energy = 0;
    double value = NAN;
    const bool isByEnergy = colon != std::string::npos && ToNumber(word.substr(0, colon), energy);
    if ((colon != std::string::npos && !isByEnergy) ||
      !ToNumber(word.substr(isByEnergy ? colon + 1 : 0), value))
    {
      throw InputError(
        "attenuation '" + text + "': expected numbers, as 0.05/mm, found '" + word + "'");
    }
    table.EnergiesKeV.push_back(energy);
    table.MuPerMm.push_back(value);
  }
  if (table.EnergiesKeV == std::vector<double>{ 0 })
  {
    // Beyond all energies of beams.
    table.EnergiesKeV = { 0.1, 1000 };
    table.MuPerMm.push_back(table.MuPerMm.front());
  }
  table.Validate();
  return table;
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
  if (const fs::path installed = InstalledData(); !installed.empty())
  {
    return installed.string();
  }
  if (fs::is_directory(MAMMORAY_SOURCE_DATA "/attenuation"))
  {
    return MAMMORAY_SOURCE_DATA;
  }
  throw InputError(
    "expected share/mammoray beside the library, found none; the environment variable "
    "MAMMORAY_DATA can name the folder that holds attenuation/ and spectra/");
}

AttenuationTable FindAttenuationTable(const std::string& name)
{
  const fs::path folder = fs::path(DataDirectory()) / "attenuation";
  const fs::path path = folder / (name + ".csv");
  if (!name.empty() && name.find('/') == std::string::npos && fs::exists(path))
  {
    return ReadAttenuationTable(path.string());
  }
  if (name.ends_with("/mm"))
  {
    return ParseLinearAttenuation(name);
  }
  if (const std::optional<AttenuationTable> composition = FindKnownComposition(name))
  {
    return *composition;
  }
  if (name.find('@') != std::string::npos)
  {
    throw InputError("attenuation '" + name +
      "': expected the density apart (density_g_per_cm3; density in Python), found an @");
  }
  const std::vector<std::string> tables = KnownNames(folder, ".csv");
  std::vector<std::string> known = tables;
  const std::vector<std::string> compounds = CompositionNames(name);
  known.insert(known.end(), compounds.begin(), compounds.end());
  throw InputError((name.empty() ? "expected an attenuation, found none; "
                                 : "unknown attenuation '" + name + "'; ") +
    (SpellingSuggestions(name, known).empty() ? SpellingHint(name, tables) +
          ", names ('PMMA', 'Water'), formulas ('H2O'), mass fractions ('H:0.112 "
          "O:0.888')"
                                              : SpellingHint(name, known)));
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

AttenuationTable FindAttenuation(const Material& material)
{
  try
  {
    const AttenuationTable table = FindAttenuationTable(material.Attenuation);
    return material.IodineMgPerMl > 0
      ? WithIodine(table, table.DensityOf(material.DensityGPerCm3), material.IodineMgPerMl)
      : table;
  }
  catch (const InputError& error)
  {
    throw InputError("material '" + material.Name + "': " + error.what());
  }
}

std::vector<AttenuationTable> FindAttenuations(const MaterialTable& materials)
{
  std::vector<AttenuationTable> tables(materials.Materials.size());
  for (std::size_t index = 1; index < tables.size(); ++index)
  {
    tables[index] = FindAttenuation(materials.Materials[index]);
  }
  return tables;
}

Beam MakeBeam(const MaterialTable& materials, const Spectrum& spectrum,
  const DetectorResponse& response)
{
  const std::vector<AttenuationTable> tables = FindAttenuations(materials);
  std::vector<const AttenuationTable*> pointers{ nullptr };
  std::vector<double> densities{ 0.0 };
  for (std::size_t material = 1; material < tables.size(); ++material)
  {
    pointers.push_back(&tables[material]);
    densities.push_back(materials.Materials[material].DensityGPerCm3);
  }
  return Beam(spectrum, response, pointers, densities);
}
}
