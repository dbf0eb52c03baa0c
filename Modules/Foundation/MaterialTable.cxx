// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/MaterialTable.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Meshes.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>

namespace mammoray
{
namespace
{
std::string KnownNames(const MaterialTable& table)
{
  std::string known;
  for (const Material& material : table.Materials)
  {
    known += (known.empty() ? "" : ", ") + material.Name;
  }
  return known;
}

/// A name without what programs and people write differently.
std::string Plain(const std::string& name)
{
  std::string plain;
  for (const char letter : name)
  {
    if (letter != ' ' && letter != '-' && letter != '_')
    {
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
  }
  return plain;
}

std::string NameOfLabel(const LabelVolume& labels, int label)
{
  const auto name = labels.Names.find(label);
  return std::to_string(label) + (name == labels.Names.end() ? "" : " '" + name->second + "'");
}

std::optional<int> MaterialByNumber(const MaterialTable& table, int label)
{
  const auto material = table.MaterialOfLabel.find(label);
  return material == table.MaterialOfLabel.end() ? std::nullopt : std::optional(material->second);
}

std::optional<int> MaterialByName(const MaterialTable& table, const std::string& name)
{
  const auto material = std::find_if(table.Materials.begin(), table.Materials.end(),
    [plain = Plain(name)](const Material& known) { return Plain(known.Name) == plain; });
  return material == table.Materials.end()
    ? std::nullopt
    : std::optional(static_cast<int>(material - table.Materials.begin()));
}

std::optional<int> MaterialByName(const MaterialTable& table, const LabelVolume& labels, int label)
{
  const auto named = labels.Names.find(label);
  return named == labels.Names.end() ? std::nullopt : MaterialByName(table, named->second);
}

/// Whether no name of a label that occurs is one of the table's, although all their numbers are.
/// Says it in a note, except of names that a program made of the numbers.
bool CountsNumbersAlone(const MaterialTable& table, const LabelVolume& labels,
  const std::map<int, std::size_t>& counts, const std::string& volumeName)
{
  std::string taken;
  bool isTold = false;
  for (const auto& [label, count] : counts)
  {
    const std::optional<int> material = MaterialByNumber(table, label);
    if (label == 0)
    {
      continue;
    }
    if (!material || MaterialByName(table, labels, label))
    {
      return false;
    }
    const auto named = labels.Names.find(label);
    const std::string name = named == labels.Names.end() ? "" : Plain(named->second);
    const std::string number = std::to_string(label);
    isTold = isTold || (!name.empty() && name != "segment" + number && name != "label" + number);
    taken += (taken.empty() ? "" : ", ") + NameOfLabel(labels, label) + " is " +
      table.Materials[static_cast<std::size_t>(*material)].Name;
  }
  if (isTold)
  {
    Note({ volumeName,
      "no name of its labels is one of the material table '" + table.Name +
        "', so that their numbers count",
      ": label " + taken });
  }
  return true;
}

/// See ToMaterials.
std::optional<int> FindMaterial(const MaterialTable& table, const LabelVolume& labels, int label)
{
  const std::optional<int> byName =
    label == 0 ? std::nullopt : MaterialByName(table, labels, label);
  const auto named = labels.Names.find(label);
  const std::string name = named == labels.Names.end() ? "" : Plain(named->second);
  const std::string number = std::to_string(label);
  return byName ? byName
    : label == 0 || name == "segment" + number || name == "label" + number
    ? MaterialByNumber(table, label)
    : std::nullopt;
}

/// Throws if a list is not empty. `unknown`: labels that are no material. `unnamed`: values that no
/// segment of the file has. `more`: that some are left out of the lists.
void RefuseUnknown(const MaterialTable& table, const LabelVolume& labels,
  const std::string& volumeName, const std::string& unknown, const std::string& unnamed,
  const std::string& more)
{
  std::string refusal;
  if (!unnamed.empty())
  {
    std::string segments;
    for (const auto& [label, name] : labels.Names)
    {
      segments += (segments.empty() ? "" : ", ") + NameOfLabel(labels, label);
    }
    refusal = "value " + unnamed + (unknown.empty() ? more : "") +
      " belongs to no segment of the file, which has " + segments;
  }
  if (!unknown.empty())
  {
    refusal += (refusal.empty() ? "" : "; ") + ("label " + unknown) + more +
      " is not in the material table '" + table.Name + "'" +
      (labels.Names.empty() ? "" : ", which has " + KnownNames(table));
  }
  if (!refusal.empty())
  {
    throw InputError(volumeName + ": " + refusal);
  }
}

/// See FitMesh; `least`: the first index that may be used.
std::map<int, int> FindMaterials(const MaterialTable& table, const std::set<int>& used, int least,
  const std::vector<std::string>& names, const std::string& where)
{
  const int last = static_cast<int>(table.Materials.size()) - 1;
  std::map<int, int> indexOf;
  std::string unknown;
  std::string unnamed;
  bool isRenumbered = false;
  for (const int material : used)
  {
    const auto place = static_cast<std::size_t>(material);
    const bool isNamed = material > 0 && place < names.size() && !names[place].empty();
    const std::optional<int> index =
      isNamed ? MaterialByName(table, names[place]) : std::optional(material);
    if (!index)
    {
      unknown += (unknown.empty() ? "'" : ", '") + names[place] + "'";
      continue;
    }
    if (*index < least || *index > last)
    {
      throw InputError(where + ": expected materials " + std::to_string(least) + " to " +
        std::to_string(last) + " of the table '" + table.Name + "', found " +
        std::to_string(*index));
    }
    unnamed = isNamed || material == 0 ? unnamed : std::to_string(material);
    isRenumbered = isRenumbered || *index != material;
    indexOf[material] = *index;
  }
  if (!unknown.empty())
  {
    throw InputError(where + ": material " + unknown + " is not in the material table '" +
      table.Name + "', which has " + KnownNames(table));
  }
  if (isRenumbered && !unnamed.empty())
  {
    throw InputError(where +
      ": expected a name for every material, as others have them in another "
      "order than the table '" +
      table.Name + "', found none of material " + unnamed);
  }
  return indexOf;
}
}

LabelVolume MaterialTable::ToMaterials(const LabelVolume& labels,
  const std::string& volumeName) const
{
  constexpr int mostNamed = 10; // an MRI in place of labels has thousands
  std::string unknown;
  std::string unnamed;
  std::string renumbered;
  int unknownLabels = 0;
  std::vector<std::uint16_t> materialOf(65536, 0);
  std::size_t tissueVoxels = 0;
  const std::map<int, std::size_t> counts = labels.CountLabels();
  const bool byNumber =
    labels.Names.empty() || CountsNumbersAlone(*this, labels, counts, volumeName);
  for (const auto& [label, count] : counts)
  {
    const std::optional<int> material =
      byNumber ? MaterialByNumber(*this, label) : FindMaterial(*this, labels, label);
    if (!material)
    {
      // A value that none of the file's segments has is not a question of the table.
      std::string& list = labels.Names.empty() || labels.Names.count(label) > 0 ? unknown : unnamed;
      if (++unknownLabels <= mostNamed)
      {
        list += (list.empty() ? "" : ", ") + NameOfLabel(labels, label) + " (" +
          std::to_string(count) + " voxels)";
      }
      continue;
    }
    materialOf[label] = static_cast<std::uint16_t>(*material);
    if (const auto numbered = this->MaterialOfLabel.find(label);
        numbered != this->MaterialOfLabel.end() && numbered->second != *material)
    {
      renumbered += (renumbered.empty() ? "" : ", ") + NameOfLabel(labels, label) + " (not " +
        this->Materials[static_cast<std::size_t>(numbered->second)].Name + ")";
    }
    tissueVoxels += *material != 0 ? count : 0;
  }
  RefuseUnknown(*this, labels, volumeName, unknown, unnamed,
    unknownLabels > mostNamed ? " and " + std::to_string(unknownLabels - mostNamed) + " more" : "");
  if (tissueVoxels == 0)
  {
    throw InputError(
      volumeName + ": expected tissue, found only air by the material table '" + this->Name + "'");
  }
  if (!renumbered.empty())
  {
    Note({ volumeName,
      "labels are taken by their names, against the numbers in the table '" + this->Name + "'",
      ": " + renumbered });
  }
  LabelVolume result = labels;
  result.Names.clear();
  for (std::uint16_t& voxel : result.Voxels)
  {
    voxel = materialOf[voxel];
  }
  return result;
}

void MaterialTable::FitMesh(TetrahedralMesh& mesh, const std::vector<std::string>& names,
  const std::string& where) const
{
  const std::map<int, int> indexOf = FindMaterials(*this,
    std::set<int>(mesh.Materials.begin(), mesh.Materials.end()), 1, names, where);
  for (std::int32_t& material : mesh.Materials)
  {
    material = indexOf.at(material);
  }
}

void MaterialTable::FitMesh(SurfaceMesh& mesh, const std::vector<std::string>& names,
  const std::string& where) const
{
  std::set<int> used(mesh.FrontMaterials.begin(), mesh.FrontMaterials.end());
  used.insert(mesh.BackMaterials.begin(), mesh.BackMaterials.end());
  const std::map<int, int> indexOf = FindMaterials(*this, used, 0, names, where);
  for (std::vector<std::uint16_t>* const side : { &mesh.FrontMaterials, &mesh.BackMaterials })
  {
    for (std::uint16_t& material : *side)
    {
      material = static_cast<std::uint16_t>(indexOf.at(material));
    }
  }
}

int MaterialTable::IndexOf(const std::string& name) const
{
  const std::optional<int> index = MaterialByName(*this, name);
  if (!index)
  {
    throw InputError(
      "unknown material '" + name + "'; the table '" + this->Name + "' has " + KnownNames(*this));
  }
  return *index;
}

std::vector<std::string> MaterialTable::Names() const
{
  std::vector<std::string> names;
  for (const Material& material : this->Materials)
  {
    names.push_back(material.Name);
  }
  return names;
}

std::map<int, std::string> MaterialTable::LabelNames() const
{
  std::map<int, std::string> names;
  for (const auto& [label, material] : this->MaterialOfLabel)
  {
    if (material != 0)
    {
      names[label] = this->Materials[static_cast<std::size_t>(material)].Name;
    }
  }
  return names;
}

std::vector<bool> MaterialTable::Fixed() const
{
  std::vector<bool> fixed;
  for (const Material& material : this->Materials)
  {
    fixed.push_back(material.Fixed);
  }
  return fixed;
}

std::vector<int> MaterialTable::Thin() const
{
  std::vector<int> thin;
  for (std::size_t index = 0; index < this->Materials.size(); ++index)
  {
    if (this->Materials[index].Thin)
    {
      thin.push_back(static_cast<int>(index));
    }
  }
  return thin;
}

std::vector<int> MaterialTable::Glandular() const
{
  std::vector<int> gland;
  for (std::size_t index = 1; index < this->Materials.size(); ++index)
  {
    if (this->Materials[index].Attenuation == "glandular" && !this->Materials[index].Fixed)
    {
      gland.push_back(static_cast<int>(index));
    }
  }
  return gland;
}
}
