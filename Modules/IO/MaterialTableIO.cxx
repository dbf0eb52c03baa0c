// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MaterialTableIO.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Plausible.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <set>

namespace mammoray
{
namespace
{
using Json = nlohmann::json;

/// One object of the file, with the words that say where it is.
class Entry
{
public:
  Entry(const Json& value, const std::string& place, std::initializer_list<const char*> keys)
    : Value(value)
    , Place(place)
  {
    if (!value.is_object())
    {
      throw InputError(place + ": expected a JSON object, found " + value.type_name());
    }
    for (const auto& [key, ignored] : value.items())
    {
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
      {
        std::string known;
        for (const char* name : keys)
        {
          known += (known.empty() ? "" : ", ") + std::string(name);
        }
        throw InputError(place + ": unknown key '" + key + "', expected " + known);
      }
    }
  }

  [[noreturn]] void Refuse(const std::string& key, const std::string& expected) const
  {
    const auto found = this->Value.find(key);
    std::string text = found == this->Value.end() ? "nothing" : found->dump();
    if (text.size() > 60)
    {
      text = text.substr(0, 57) + "...";
    }
    throw InputError(this->Place + ": key '" + key + "': expected " + expected + ", found " + text);
  }

  const Json* Find(const std::string& key) const
  {
    const auto found = this->Value.find(key);
    return found == this->Value.end() ? nullptr : &*found;
  }

  std::string Text(const std::string& key) const
  {
    const Json* found = this->Find(key);
    if (!found || !found->is_string() || found->get_ref<const std::string&>().empty())
    {
      this->Refuse(key, "a text that is not empty");
    }
    return Printable(found->get<std::string>());
  }

  /// Leaves `value` alone when the key is absent.
  template <typename Accept>
  void Number(const std::string& key, const std::string& expected, Accept accept,
    double& value) const
  {
    if (const Json* found = this->Find(key))
    {
      if (!found->is_number() || !accept(found->get<double>()))
      {
        this->Refuse(key, expected);
      }
      value = found->get<double>();
    }
  }

private:
  const Json& Value;
  std::string Place;
};

Json ParseFile(const std::string& path)
{
  if (!std::filesystem::exists(path))
  {
    throw InputError(path + ": no such file");
  }
  std::ifstream file(path);
  if (!std::filesystem::is_regular_file(path) || !file)
  {
    throw InputError(path + ": expected a material table, found something that cannot be read");
  }
  // The parser keeps the last of repeated keys silently.
  std::vector<std::set<std::string>> open;
  std::string repeated;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed)
  {
    // A table has four levels; what is done with thousands of them ends the process.
    if (depth > 16)
    {
      throw InputError(path + ": expected a material table, found JSON nested deeper than 16");
    }
    if (event == Json::parse_event_t::object_start)
    {
      open.emplace_back();
    }
    else if (event == Json::parse_event_t::object_end)
    {
      open.pop_back();
    }
    else if (event == Json::parse_event_t::key &&
      !open.back().insert(parsed.get<std::string>()).second)
    {
      repeated = parsed.get<std::string>();
    }
    return true;
  };
  Json parsed;
  try
  {
    parsed = Json::parse(file, watch);
  }
  catch (const Json::exception& error)
  {
    std::string what = error.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw InputError(path + ": expected a material table in JSON: " + what);
  }
  if (!repeated.empty())
  {
    throw InputError(path + ": key '" + repeated + "': expected once, found more often");
  }
  return parsed;
}

/// The name or composition, mass fractions as the text that FindComposition reads.
std::string ReadAttenuation(const Entry& entry)
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

void ReadLabels(const Entry& entry, int material, MaterialTable& table)
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
}

MaterialTable ReadMaterialTable(const std::string& path)
{
  const Json file = ParseFile(path);
  const Entry root(file, path, { "name", "description", "materials" });
  MaterialTable table;
  table.Name =
    root.Find("name") ? root.Text("name") : std::filesystem::path(path).filename().string();
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
    const std::string place = path + ": material " + std::to_string(index);
    Material material;
    const Entry entry((*materials)[index], place,
      { "name", "labels", "attenuation", "density_g_per_cm3", "iodine_mg_per_ml",
        "youngs_modulus_kpa", "poisson_ratio", "fung_exponent", "held", "thin", "unusual" });
    material.Name = entry.Text("name");
    if (index == 0)
    {
      if (material.Name != "air")
      {
        entry.Refuse("name", "\"air\" for the first material");
      }
      Entry((*materials)[index], place + " (air)", { "name", "labels" });
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
    for (const auto& [key, flag] : { std::pair{ "held", &material.Held },
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
    if (!unusual)
    {
      constexpr const char* overrule = "\"unusual\": true, in the table, takes it";
      const std::string what = path + ": material '" + material.Name + "'";
      CheckPlausible(Plausible::Density, material.DensityGPerCm3, what, overrule);
      CheckPlausible(Plausible::YoungsModulus, material.YoungsModulusKPa, what, overrule);
    }
    table.Materials.push_back(material);
    ReadLabels(entry, static_cast<int>(index), table);
  }
  return table;
}
}
