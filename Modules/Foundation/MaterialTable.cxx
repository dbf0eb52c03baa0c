// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/MaterialTable.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Meshes.h"

#include <algorithm>

namespace mammoray
{
namespace
{
void CheckMaterials(const MaterialTable& table, int smallest, int largest, int least,
  const std::vector<std::string>& names, const std::string& where)
{
  const int last = static_cast<int>(table.Materials.size()) - 1;
  if (smallest < least || largest > last)
  {
    throw InputError(where + ": expected materials " + std::to_string(least) + " to " +
      std::to_string(last) + " of the table '" + table.Name + "', found " +
      std::to_string(smallest < least ? smallest : largest));
  }
  for (std::size_t index = 1; index < names.size() && static_cast<int>(index) <= largest; ++index)
  {
    if (names[index] != table.Materials[index].Name)
    {
      throw InputError(where + ": material " + std::to_string(index) + " is '" + names[index] +
        "', but '" + table.Materials[index].Name + "' in the table '" + table.Name + "'");
    }
  }
}
}

LabelVolume MaterialTable::ToMaterials(const LabelVolume& labels,
  const std::string& volumeName) const
{
  constexpr int mostNamed = 10; // an MRI in place of labels has thousands
  std::string unknown;
  int unknownLabels = 0;
  std::vector<std::uint16_t> materialOf(65536, 0);
  std::size_t tissueVoxels = 0;
  for (const auto& [label, count] : labels.CountLabels())
  {
    const auto found = this->MaterialOfLabel.find(label);
    if (found == this->MaterialOfLabel.end())
    {
      if (++unknownLabels <= mostNamed)
      {
        unknown += (unknown.empty() ? "" : ", ") + std::to_string(label) + " (" +
          std::to_string(count) + " voxels)";
      }
      continue;
    }
    materialOf[label] = static_cast<std::uint16_t>(found->second);
    tissueVoxels += found->second != 0 ? count : 0;
  }
  if (!unknown.empty())
  {
    const std::string more = unknownLabels > mostNamed
      ? " and " + std::to_string(unknownLabels - mostNamed) + " more"
      : "";
    throw InputError(volumeName + ": label " + unknown + more + " is not in the material table '" +
      this->Name + "'");
  }
  if (tissueVoxels == 0)
  {
    throw InputError(
      volumeName + ": expected tissue, found only air by the material table '" + this->Name + "'");
  }
  LabelVolume result = labels;
  for (std::uint16_t& voxel : result.Voxels)
  {
    voxel = materialOf[voxel];
  }
  return result;
}

void MaterialTable::CheckMesh(const TetrahedralMesh& mesh, const std::vector<std::string>& names,
  const std::string& where) const
{
  if (!mesh.Materials.empty())
  {
    const auto [smallest, largest] =
      std::minmax_element(mesh.Materials.begin(), mesh.Materials.end());
    CheckMaterials(*this, *smallest, *largest, 1, names, where);
  }
}

void MaterialTable::CheckMesh(const SurfaceMesh& mesh, const std::vector<std::string>& names,
  const std::string& where) const
{
  CheckMaterials(*this, 0, mesh.NumberOfMaterials() - 1, 0, names, where);
}

int MaterialTable::IndexOf(const std::string& name) const
{
  std::string known;
  for (std::size_t index = 0; index < this->Materials.size(); ++index)
  {
    if (this->Materials[index].Name == name)
    {
      return static_cast<int>(index);
    }
    known += (known.empty() ? "" : ", ") + this->Materials[index].Name;
  }
  throw InputError("unknown material '" + name + "'; the table '" + this->Name + "' has " + known);
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
