// SPDX-License-Identifier: Apache-2.0
#include "Project/SurfaceScene.h"

#include "CommandLine/OptionList.h"
#include "OutputFiles.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <filesystem>

namespace mammoray
{
namespace
{
/// A material of the table, by its name, or a new one of that composition.
int MaterialFor(const std::string& text, MaterialTable& table)
{
  const auto known = std::find_if(table.Materials.begin(), table.Materials.end(),
    [&](const Material& material) { return material.Name == text; });
  if (known != table.Materials.end())
  {
    return static_cast<int>(known - table.Materials.begin());
  }
  Material material;
  material.Name = text;
  const std::size_t at = std::min(text.rfind('@'), text.size());
  material.Attenuation = text.substr(0, at);
  const AttenuationTable attenuation = FindAttenuationTable(material.Attenuation);
  material.DensityGPerCm3 = attenuation.NominalDensityGPerCm3;
  if (at < text.size() &&
    !(ToNumber(text.substr(at + 1), material.DensityGPerCm3) && material.DensityGPerCm3 > 0))
  {
    throw InputError(
      "--surface: expected MATERIAL[@DENSITY] with a density in g/cm3, found '" + text + "'");
  }
  table.Materials.push_back(material);
  return static_cast<int>(table.Materials.size()) - 1;
}
}

SurfaceScene ReadMeshScene(const std::string& path, const MaterialTable& table)
{
  SurfaceScene scene;
  scene.Materials = table;
  std::vector<std::string> names;
  scene.Surface = std::filesystem::path(path).extension() == ".vtu"
    ? ExtractInterfaces(FromGrid(ReadMesh(path), &names))
    : FromPolyData(ReadSurface(path), &names);
  table.CheckMesh(scene.Surface, names, path);
  return scene;
}

SurfaceScene ReadSurfaceScene(const std::vector<std::string>& surfaces, MaterialTable table)
{
  SurfaceScene scene;
  if (table.Materials.empty())
  {
    table.Name = "surfaces";
    table.Materials.push_back({ .Name = "air" });
  }
  for (const std::string& text : surfaces)
  {
    // Mass fractions have no '=', and a path may have one.
    const auto [name, path] = SplitAssignment(text, "--surface", "MATERIAL=FILE");
    CheckInputFile(path);
    const int material = MaterialFor(name, table);
    if (material == 0)
    {
      throw InputError("--surface " + text + ": expected a material, found air");
    }
    const SurfaceMesh part = FromPolyData(ReadSurface(path));
    if (std::any_of(part.BackMaterials.begin(), part.BackMaterials.end(),
          [](std::uint16_t side) { return side > 1; }) ||
      std::any_of(part.FrontMaterials.begin(), part.FrontMaterials.end(),
        [](std::uint16_t side) { return side > 1; }))
    {
      throw InputError("--surface " + text +
        ": expected a surface of one material, found several; --mesh takes it with a table");
    }
    AppendBoundary(part, material, scene.Surface);
  }
  scene.Materials = std::move(table);
  return scene;
}
}
