// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/ScatterData.h"

#include "Private/InputFile.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/ShippedData.h"

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

ScatterKernels FindScatterKernels()
{
  return ReadScatterKernels(
    (std::filesystem::path(DataDirectory()) / "scatter" / "breast.csv").string());
}

std::vector<PhotonMaterial> MakePhotonMaterials(const MaterialTable& materials)
{
  std::vector<PhotonMaterial> made{ PhotonMaterial("Air, Dry (near sea level)", 0.001205) };
  for (std::size_t material = 1; material < materials.Materials.size(); ++material)
  {
    const Material& of = materials.Materials[material];
    const auto shipped = ShippedCompositions().find(of.Attenuation);
    try
    {
      made.emplace_back(shipped == ShippedCompositions().end() ? of.Attenuation : shipped->second,
        of.DensityGPerCm3);
    }
    catch (const InputError& error)
    {
      throw InputError("material '" + of.Name + "': " + error.what());
    }
  }
  return made;
}
}
