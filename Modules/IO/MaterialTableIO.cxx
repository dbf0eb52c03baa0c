// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MaterialTableIO.h"

#include "Private/JsonFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/ShippedData.h"

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
using Json = nlohmann::json;
const std::vector<std::string> TableKeys{ "name", "description", "materials" };

/// The name or composition, mass fractions as the text that FindComposition reads.
std::string ReadAttenuation(const JsonObject& entry)
{
  const Json* value = entry.Find("attenuation");
  if (!value || !value->is_object())
  {
    return entry.Text("attenuation");
  }
  std::string text;
  for (const auto& [name, fraction] : value->items())
  {
    if (!fraction.is_number() || name.find_first_of(" :") != std::string::npos)
    {
      entry.Refuse("attenuation", "mass fractions by element or formula");
    }
    text += (text.empty() ? "" : " ") + name + ":" + fraction.dump();
  }
  if (text.empty())
  {
    entry.Refuse("attenuation", "at least one mass fraction");
  }
  return text;
}

double OwnDensity(const std::string& place, const std::string& attenuation)
{
  try
  {
    return FindAttenuationTable(attenuation).DensityOf(0);
  }
  catch (const InputError& error)
  {
    throw InputError(place + ".density_g_per_cm3: " + error.what());
  }
}

void ReadLabels(const JsonObject& entry, int material, MaterialTable& table)
{
  const char* const expected = "a list of whole numbers from 0 to 65535, at least one";
  const Json* labels = entry.Find("labels");
  if (!labels && table.Materials[static_cast<std::size_t>(material)].Thin)
  {
    return;
  }
  if (!labels || !labels->is_array() || labels->empty())
  {
    entry.Refuse("labels", expected);
  }
  for (const Json& label : *labels)
  {
    if (!label.is_number_integer() || label.get<double>() < 0 || label.get<double>() > 65535)
    {
      entry.Refuse("labels", expected);
    }
    const auto [place, fresh] = table.MaterialOfLabel.emplace(label.get<int>(), material);
    if (!fresh)
    {
      entry.Refuse("labels",
        "each label once (label " + label.dump() + " is in '" +
          table.Materials[place->second].Name + "' already)");
    }
  }
}

/// `where`: "FILE: ", or nothing.
MaterialTable ToMaterialTable(const JsonObject& root, const std::string& name,
  const std::string& where)
{
  MaterialTable table;
  table.Name = root.Find("name") ? root.Text("name") : name;
  if (root.Find("description"))
  {
    root.Text("description");
  }
  const Json* materials = root.Find("materials");
  if (!materials || !materials->is_array() || materials->size() < 2)
  {
    root.Refuse("materials", "a list of air and at least one tissue");
  }
  for (std::size_t index = 0; index < materials->size(); ++index)
  {
    const std::string place = where + "materials[" + std::to_string(index) + "]";
    Material material;
    const JsonObject entry((*materials)[index], place,
      { "name", "labels", "attenuation", "density_g_per_cm3", "iodine_mg_per_ml",
        "youngs_modulus_kpa", "poisson_ratio", "fung_exponent", "fixed", "held", "thin",
        "unusual" });
    material.Name = entry.Text("name");
    if (index == 0)
    {
      if (material.Name != "air")
      {
        entry.Refuse("name", "\"air\" for the first material");
      }
      JsonObject((*materials)[index], place + " (air)", { "name", "labels" });
    }
    else
    {
      for (const Material& other : table.Materials)
      {
        if (other.Name == material.Name)
        {
          entry.Refuse("name", "a name that no other material has");
        }
      }
      material.Attenuation = ReadAttenuation(entry);
    }
    bool unusual = false;
    const auto positive = [](double value) { return value > 0; };
    entry.Number("density_g_per_cm3", "a positive number", positive, material.DensityGPerCm3);
    entry.Number(
      "iodine_mg_per_ml", "a number from 0 to 500",
      [](double value) { return value >= 0 && value <= 500; }, material.IodineMgPerMl);
    entry.Number("youngs_modulus_kpa", "a positive number", positive, material.YoungsModulusKPa);
    entry.Number(
      "poisson_ratio", "a number of at least 0 and below 0.5",
      [](double value) { return value >= 0 && value < 0.5; }, material.PoissonRatio);
    entry.Number(
      "fung_exponent", "a number from 0 (neo-Hookean) to 50",
      [](double value) { return value >= 0 && value <= 50; }, material.FungExponent);
    // Tables of version 0.2 and older say "held".
    for (const auto& [key, flag] :
      { std::pair{ "fixed", &material.Fixed }, std::pair{ "held", &material.Fixed },
        std::pair{ "thin", &material.Thin }, std::pair{ "unusual", &unusual } })
    {
      if (const Json* value = entry.Find(key))
      {
        if (!value->is_boolean())
        {
          entry.Refuse(key, "true or false");
        }
        *flag = value->get<bool>();
      }
    }
    const std::vector<std::string> remedies{ "\"unusual\": true in the table" };
    const std::string what = where + "material '" + material.Name + "'";
    if (!unusual)
    {
      CheckValidRange(ValidRanges::YoungsModulus, material.YoungsModulusKPa, what, remedies);
    }
    if (entry.Find("density_g_per_cm3"))
    {
      CheckValidRange(unusual ? ValidRanges::PartDensity : ValidRanges::Density,
        material.DensityGPerCm3, what, unusual ? std::vector<std::string>() : remedies);
    }
    table.Materials.push_back(material);
    ReadLabels(entry, static_cast<int>(index), table);
    if (index > 0 && material.DensityGPerCm3 == 0)
    {
      table.Materials.back().DensityGPerCm3 = OwnDensity(place, material.Attenuation);
    }
  }
  return table;
}
}

MaterialTable ReadMaterialTable(const std::string& path)
{
  const Json file = ParseJsonFile(path, "a material table");
  return ToMaterialTable(JsonObject::Root(file, path, TableKeys),
    std::filesystem::path(path).filename().string(), path + ": ");
}

MaterialTable ParseMaterialTable(const std::string& text)
{
  std::istringstream stream(text);
  const Json table = ParseJson(stream, "materials", "a material table");
  return ToMaterialTable(JsonObject(table, "materials", TableKeys), "materials", "");
}
}
