// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/ScatterData.h"

#include "Private/InputFile.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/ShippedData.h"

#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <vector>

namespace mammoray
{
namespace
{
/// A table of the shipped size has 66,240 shares.
constexpr std::size_t MostShares = 10000000;

/// Compositions of the shipped attenuations, from their first lines: ICRP's tissue and those of
/// Woodard and White (Brit. J. Radiol. 59, 1986), mass fractions.
const std::map<std::string, std::string>& ShippedCompositions()
{
  static const std::map<std::string, std::string> compositions{
    { "adipose", "Adipose Tissue (ICRP)" },
    { "air", "Air, Dry (near sea level)" },
    { "blood",
      "H:0.102 C:0.110 N:0.033 O:0.745 Na:0.001 P:0.001 S:0.002 Cl:0.003 K:0.002 Fe:0.001" },
    { "calcium_oxalate", "CaC2O4" },
    { "connective", "H:0.094 C:0.207 N:0.062 O:0.622 Na:0.006 S:0.006 Cl:0.003" },
    { "glandular", "H:0.102 C:0.158 N:0.037 O:0.698 Na:0.001 P:0.001 S:0.002 Cl:0.001" },
    { "muscle", "H:0.102 C:0.143 N:0.034 O:0.710 Na:0.001 P:0.002 S:0.003 Cl:0.001 K:0.004" },
    { "polystyrene", "Polystyrene" },
    { "selenium", "Se" },
    { "skin", "H:0.100 C:0.204 N:0.042 O:0.645 Na:0.002 P:0.001 S:0.002 Cl:0.003 K:0.001" },
  };
  return compositions;
}

void AddValues(const char* name, const char* format, const double* begin, const double* end,
  std::string& text)
{
  text += name;
  for (const double* value = begin; value != end; ++value)
  {
    char number[32];
    std::snprintf(number, sizeof number, format, *value);
    text += number;
  }
  text += '\n';
}
}

void WriteScatterKernels(const ScatterKernels& kernels, const std::string& comment,
  const std::string& path)
{
  kernels.Validate();
  std::string text = "# " + comment + "\ncomposition," + kernels.Composition + "\n";
  const auto add = [&](const char* name, const std::vector<double>& values)
  { AddValues(name, ",%.5g", values.data(), values.data() + values.size(), text); };
  add("density_g_per_cm3", { kernels.DensityGPerCm3 });
  add("energies_keV", kernels.EnergiesKeV);
  add("thicknesses_mm", kernels.ThicknessesMm);
  add("gaps_mm", kernels.GapsMm);
  add("radii_mm", kernels.RadiiMm);
  add("angles_deg", kernels.AnglesDeg);
  add("multiple", { kernels.Multiple.begin(), kernels.Multiple.end() });
  const std::vector<double> shares(kernels.Shares.begin(), kernels.Shares.end());
  const std::size_t size = kernels.NumberOfRings() * kernels.NumberOfAngles();
  for (std::size_t begin = 0; begin < shares.size(); begin += size)
  {
    AddValues("shares", ",%.3g", &shares[begin], &shares[begin] + size, text);
  }
  WriteAtomicFile(path, text);
}

ScatterKernels ReadScatterKernels(const std::string& path)
{
  std::ifstream file = OpenText(path);
  ScatterKernels kernels;
  std::vector<double> density;
  std::vector<double> shares;
  std::vector<double> multiple;
  const std::map<std::string, std::vector<double>*> lists{ { "density_g_per_cm3", &density },
    { "energies_keV", &kernels.EnergiesKeV }, { "thicknesses_mm", &kernels.ThicknessesMm },
    { "gaps_mm", &kernels.GapsMm }, { "radii_mm", &kernels.RadiiMm },
    { "angles_deg", &kernels.AnglesDeg }, { "shares", &shares }, { "multiple", &multiple } };
  std::string line;
  for (std::size_t number = 1; ReadLine(file, line); ++number)
  {
    if (line.empty() || line[0] == '#')
    {
      continue;
    }
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    if (cell == "composition")
    {
      std::getline(cells, kernels.Composition);
      continue;
    }
    const auto list = lists.find(cell);
    if (list == lists.end())
    {
      throw InputError(LineName(path, number) +
        ": expected the name of an axis, composition, density_g_per_cm3 or shares");
    }
    while (std::getline(cells, cell, ','))
    {
      double value = 0;
      if (!ToNumber(cell, value) || list->second->size() >= MostShares)
      {
        throw InputError(
          LineName(path, number) + ": expected numbers behind '" + list->first + "', 1e7 at most");
      }
      list->second->push_back(value);
    }
  }
  if (density.size() != 1)
  {
    throw InputError(
      path + ": expected one density_g_per_cm3, found " + std::to_string(density.size()));
  }
  kernels.DensityGPerCm3 = density.front();
  kernels.Shares.assign(shares.begin(), shares.end());
  kernels.Multiple.assign(multiple.begin(), multiple.end());
  try
  {
    kernels.Validate();
  }
  catch (const InputError& error)
  {
    throw InputError(path + ": " + error.what());
  }
  return kernels;
}

ScatterKernels FindScatterKernels(const std::string& pathOrName)
{
  const std::filesystem::path shipped =
    std::filesystem::path(DataDirectory()) / "scatter" / (pathOrName + ".csv");
  std::error_code none;
  const bool isFile =
    std::filesystem::exists(pathOrName, none) || !std::filesystem::exists(shipped, none);
  return ReadScatterKernels(isFile ? pathOrName : shipped.string());
}

std::vector<std::string> PhotonCompositions(const MaterialTable& materials)
{
  std::vector<std::string> texts{ "Air, Dry (near sea level)" };
  for (std::size_t material = 1; material < materials.Materials.size(); ++material)
  {
    const std::string& text = materials.Materials[material].Attenuation;
    const auto shipped = ShippedCompositions().find(text);
    texts.push_back(shipped == ShippedCompositions().end() ? text : shipped->second);
  }
  return texts;
}

std::vector<PhotonMaterial> MakePhotonMaterials(const MaterialTable& materials)
{
  const std::vector<std::string> texts = PhotonCompositions(materials);
  std::vector<PhotonMaterial> made{ PhotonMaterial(texts[0], 0.001205) };
  for (std::size_t material = 1; material < texts.size(); ++material)
  {
    const Material& of = materials.Materials[material];
    try
    {
      made.emplace_back(texts[material], of.DensityGPerCm3);
    }
    catch (const InputError& error)
    {
      throw InputError("material '" + of.Name + "': " + error.what());
    }
  }
  return made;
}
}
