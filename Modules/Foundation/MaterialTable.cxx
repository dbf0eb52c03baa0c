// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/MaterialTable.h"

#include "mammoray/Foundation/Error.h"

namespace mammoray
{
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

std::vector<bool> MaterialTable::Held() const
{
  std::vector<bool> held;
  for (const Material& material : this->Materials)
  {
    held.push_back(material.Held);
  }
  return held;
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
    if (this->Materials[index].Attenuation == "glandular" && !this->Materials[index].Held)
    {
      gland.push_back(static_cast<int>(index));
    }
  }
  return gland;
}
}
