// SPDX-License-Identifier: Apache-2.0
#include "Private/MaterialNames.h"

#include <xraylib.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

namespace mammoray
{
namespace
{
constexpr const char* ElementNames[] = { "Hydrogen", "Helium", "Lithium", "Beryllium", "Boron",
  "Carbon", "Nitrogen", "Oxygen", "Fluorine", "Neon", "Sodium", "Magnesium", "Aluminum", "Silicon",
  "Phosphorus", "Sulfur", "Chlorine", "Argon", "Potassium", "Calcium", "Scandium", "Titanium",
  "Vanadium", "Chromium", "Manganese", "Iron", "Cobalt", "Nickel", "Copper", "Zinc", "Gallium",
  "Germanium", "Arsenic", "Selenium", "Bromine", "Krypton", "Rubidium", "Strontium", "Yttrium",
  "Zirconium", "Niobium", "Molybdenum", "Technetium", "Ruthenium", "Rhodium", "Palladium", "Silver",
  "Cadmium", "Indium", "Tin", "Antimony", "Tellurium", "Iodine", "Xenon", "Cesium", "Barium",
  "Lanthanum", "Cerium", "Praseodymium", "Neodymium", "Promethium", "Samarium", "Europium",
  "Gadolinium", "Terbium", "Dysprosium", "Holmium", "Erbium", "Thulium", "Ytterbium", "Lutetium",
  "Hafnium", "Tantalum", "Tungsten", "Rhenium", "Osmium", "Iridium", "Platinum", "Gold", "Mercury",
  "Thallium", "Lead", "Bismuth", "Polonium", "Astatine", "Radon", "Francium", "Radium", "Actinium",
  "Thorium", "Protactinium", "Uranium" };

/// Of NIST's pages on X-ray attenuation (Hubbell and Seltzer, NISTIR 5632, table 2), what xraylib's
/// list lacks: tissues of ICRU Report 44 and concretes.
struct PageMaterial
{
  const char* Name;
  const char* Fractions;
  double DensityGPerCm3;
};
constexpr PageMaterial PageMaterials[] = {
  { "Adipose Tissue (ICRU-44)", "H:0.114 C:0.598 N:0.007 O:0.278 Na:0.001 S:0.001 Cl:0.001",
    0.950 },
  { "Blood, Whole (ICRU-44)",
    "H:0.102 C:0.110 N:0.033 O:0.745 Na:0.001 P:0.001 S:0.002 Cl:0.003 K:0.002 Fe:0.001", 1.060 },
  { "Bone, Cortical (ICRU-44)",
    "H:0.034 C:0.155 N:0.042 O:0.435 Na:0.001 Mg:0.002 P:0.103 S:0.003 Ca:0.225", 1.920 },
  { "Brain, Grey/White Matter (ICRU-44)",
    "H:0.107 C:0.145 N:0.022 O:0.712 Na:0.002 P:0.004 S:0.002 Cl:0.003 K:0.003", 1.040 },
  { "Breast Tissue (ICRU-44)", "H:0.106 C:0.332 N:0.030 O:0.527 Na:0.001 P:0.001 S:0.002 Cl:0.001",
    1.020 },
  { "Eye Lens (ICRU-44)", "H:0.096 C:0.195 N:0.057 O:0.646 Na:0.001 P:0.001 S:0.003 Cl:0.001",
    1.070 },
  { "Lung Tissue (ICRU-44)",
    "H:0.103 C:0.105 N:0.031 O:0.749 Na:0.002 P:0.002 S:0.003 Cl:0.003 K:0.002", 1.050 },
  { "Muscle, Skeletal (ICRU-44)",
    "H:0.102 C:0.143 N:0.034 O:0.710 Na:0.001 P:0.002 S:0.003 Cl:0.001 K:0.004", 1.050 },
  { "Ovary (ICRU-44)", "H:0.105 C:0.093 N:0.024 O:0.768 Na:0.002 P:0.002 S:0.002 Cl:0.002 K:0.002",
    1.050 },
  { "Testis (ICRU-44)", "H:0.106 C:0.099 N:0.020 O:0.766 Na:0.002 P:0.001 S:0.002 Cl:0.002 K:0.002",
    1.040 },
  { "Tissue, Soft (ICRU-44)",
    "H:0.102 C:0.143 N:0.034 O:0.708 Na:0.002 P:0.003 S:0.003 Cl:0.002 K:0.003", 1.060 },
  { "Concrete, Ordinary",
    "H:0.022100 C:0.002484 O:0.574930 Na:0.015208 Mg:0.001266 Al:0.019953 Si:0.304627 K:0.010045 "
    "Ca:0.042951 Fe:0.006435",
    2.300 },
  { "Concrete, Barite (TYPE BA)",
    "H:0.003585 O:0.311622 Mg:0.001195 Al:0.004183 Si:0.010457 S:0.107858 Ca:0.050194 Fe:0.047505 "
    "Ba:0.463400",
    3.350 },
};

/// Names of everyday and of NIST's pages, and what xraylib calls them.
constexpr const char* CommonNames[][2] = {
  { "PMMA", "Polymethyl Methacralate (Lucite, Perspex)" },
  { "Acrylic", "Polymethyl Methacralate (Lucite, Perspex)" },
  { "Acrylic Glass", "Polymethyl Methacralate (Lucite, Perspex)" },
  { "Plexiglas", "Polymethyl Methacralate (Lucite, Perspex)" },
  { "Plexiglass", "Polymethyl Methacralate (Lucite, Perspex)" },
  { "Polymethyl Methacrylate", "Polymethyl Methacralate (Lucite, Perspex)" },
  { "PTFE", "Polytetrafluoroethylene (Teflon)" },
  { "PVC", "Polyvinyl Chloride" },
  { "PET", "Polyethylene Terephthalate (Mylar)" },
  { "PETE", "Polyethylene Terephthalate (Mylar)" },
  { "HDPE", "Polyethylene" },
  { "PE", "Polyethylene" },
  { "PP", "Polypropylene" },
  { "PS", "Polystyrene" },
  { "PC", "Polycarbonate (Makrolon, Lexan)" },
  { "PA", "Nylon, type 6 and type 6/6" },
  { "PI", "Kapton Polyimide Film" },
  { "PAN", "Polyacrylonitrile" },
  { "PVOH", "Polyvinyl Alcohol" },
  { "PVP", "Polyvinyl Pyrrolidone" },
  { "PVDC", "Polyvinylidene Chloride, Saran" },
  { "POM", "Polyoxymethylene" },
  { "Delrin", "Polyoxymethylene" },
  { "Acetal", "Polyoxymethylene" },
  { "PVDF", "Polyvinylidene Fluoride" },
  { "Viton", "Viton Fluoroelastomer" },
  { "Nylon", "Nylon, type 6 and type 6/6" },
  { "Polyamide", "Nylon, type 6 and type 6/6" },
  { "Kapton", "Kapton Polyimide Film" },
  { "Polyimide", "Kapton Polyimide Film" },
  { "Glass", "Glass, Plate" },
  { "Glass, Borosilicate", "Glass, Pyrex" },
  { "Glass, Borosilicate (Pyrex)", "Glass, Pyrex" },
  { "Pyrex", "Glass, Pyrex" },
  { "Alumina", "Aluminum Oxide" },
  { "Quartz", "Silicon Dioxide" },
  { "Silica", "Silicon Dioxide" },
  { "Titania", "Titanium Dioxide" },
  { "Chalk", "Calcium Carbonate" },
  { "Paraffin", "Paraffin Wax" },
  { "Ethanol", "Ethyl Alcohol" },
  { "Glycerine", "Glycerol" },
  { "Cellophane", "Cellulose Acetate, Cellophane" },
  { "Saran", "Polyvinylidene Chloride, Saran" },
  { "Plaster", "Gypsum, Plaster of Paris" },
  { "Ferrous Sulfate Standard Fricke", "Ferrous Sulfate Dosimeter Solution" },
  { "Lithium Fluride", "Lithium Fluoride" },
  { "Magnesium Tetroborate", "Magnesium Tetraborate" },
  { "Plastic Scintillator, Vinyltoluene", "Plastic Scintillator (Vinyltoluene based)" },
};

/// Its words in lower case, American spelling and alphabetical order.
std::string KeyOf(const std::string& text)
{
  static const std::map<std::string, std::string> american{ { "aluminium", "aluminum" },
    { "sulphur", "sulfur" }, { "sulphate", "sulfate" }, { "sulphide", "sulfide" },
    { "sulphoxide", "sulfoxide" }, { "oxysulphide", "oxysulfide" }, { "caesium", "cesium" },
    { "wolfram", "tungsten" }, { "gray", "grey" }, { "vapour", "vapor" }, { "fibre", "fiber" } };
  std::multiset<std::string> words;
  std::string word;
  const auto finish = [&]()
  {
    const auto other = american.find(word);
    if (!word.empty())
    {
      words.insert(other == american.end() ? word : other->second);
    }
    word.clear();
  };
  for (const char letter : text)
  {
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0)
    {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    else
    {
      finish();
    }
  }
  finish();
  std::string key;
  for (const std::string& each : words)
  {
    key += each + ' ';
  }
  return key;
}

class MaterialNameList
{
public:
  MaterialNameList()
  {
    int count = 0;
    char** list = GetCompoundDataNISTList(&count, nullptr);
    for (int index = 0; index < count; ++index)
    {
      this->Materials.push_back({ list[index], list[index] });
      xrlFree(list[index]);
    }
    xrlFree(list);
    for (const PageMaterial& material : PageMaterials)
    {
      this->Materials.push_back({ material.Name, material.Fractions, material.DensityGPerCm3 });
    }
    this->NumberOfCompounds = this->Materials.size();
    int number = 0;
    for (const char* const name : ElementNames)
    {
      char* const symbol = AtomicNumberToSymbol(++number, nullptr);
      this->Materials.push_back({ name, symbol });
      xrlFree(symbol);
    }
    for (const auto& [name, compound] : CommonNames)
    {
      this->Materials.push_back({ name, compound });
    }
    this->MakeKeys();
  }

  const NamedMaterial* Find(const std::string& text) const
  {
    const std::string key = KeyOf(text);
    const auto whole = this->Whole.find(key);
    if (whole != this->Whole.end())
    {
      return &this->Materials[whole->second];
    }
    const auto part = this->Parts.find(key);
    return part == this->Parts.end() || part->second.size() != 1
      ? nullptr
      : &this->Materials[*part->second.begin()];
  }

  std::vector<NamedMaterial> Materials;

private:
  void MakeKeys()
  {
    for (std::size_t index = 0; index < this->Materials.size(); ++index)
    {
      const std::string& name = this->Materials[index].Name;
      this->Whole.emplace(KeyOf(name), index);
      if (index >= this->NumberOfCompounds)
      {
        continue;
      }
      // "Head, kind (one, other)"
      const std::size_t bracket = std::min(name.find('('), name.size());
      this->Parts[KeyOf(name.substr(0, bracket))].insert(index);
      this->Parts[KeyOf(name.substr(0, std::min(name.find(','), bracket)))].insert(index);
      for (std::size_t begin = bracket; begin < name.size();)
      {
        const std::size_t end = std::min(name.find_first_of(",)", begin), name.size());
        this->Parts[KeyOf(name.substr(begin, end - begin))].insert(index);
        begin = end + 1;
      }
    }
  }

  std::size_t NumberOfCompounds = 0;
  std::map<std::string, std::size_t> Whole;
  std::map<std::string, std::set<std::size_t>> Parts;
};

const MaterialNameList& NameList()
{
  static const MaterialNameList list;
  return list;
}
}

const NamedMaterial* FindNamedMaterial(const std::string& text)
{
  return NameList().Find(text);
}

std::string ElementName(int number)
{
  std::string name = ElementNames[number - 1];
  name.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(name.front())));
  return name;
}

std::vector<std::string> NamesOfMaterials()
{
  std::vector<std::string> names;
  for (const NamedMaterial& material : NameList().Materials)
  {
    names.push_back(material.Name);
  }
  return names;
}
}
