// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/MeshCase.h"

#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/SurfaceMesher.h"

#include "vtkPolyData.h"

#include <algorithm>

namespace mammoray
{
namespace
{
/// The table of the file, or one that names the materials of the surfaces in their order.
MaterialTable TableOf(const MeshCase& input)
{
  if (!input.Materials.empty())
  {
    return FindMaterialTable(input.Materials);
  }
  MaterialTable table;
  table.Materials.push_back({ "air" });
  for (const auto& [name, path] : input.Surfaces)
  {
    if (std::none_of(table.Materials.begin(), table.Materials.end(),
          [&name = name](const Material& known) { return known.Name == name; }))
    {
      table.Materials.push_back({ name });
    }
  }
  return table;
}

void AddSizes(const std::map<std::string, double>& named, const MaterialTable& table,
  std::map<int, double>& sizes)
{
  for (const auto& [name, size] : named)
  {
    sizes[table.IndexOf(name)] = size;
  }
}

MeshingOptions OptionsOf(const MeshCase& input, const MaterialTable& table)
{
  std::vector<int> thin = input.Thin.empty() ? table.Thin() : std::vector<int>{};
  for (const std::string& name : input.Thin)
  {
    if (name != "none")
    {
      thin.push_back(table.IndexOf(name));
    }
  }
  const MeshingOptions layers = MeshingOptions::Anatomy(thin);
  MeshingOptions options = input.Options;
  options.CellSizeOfMaterialMm = layers.CellSizeOfMaterialMm;
  options.FacetSizeOfMaterialMm = layers.FacetSizeOfMaterialMm;
  options.FacetDistanceOfMaterialMm = layers.FacetDistanceOfMaterialMm;
  AddSizes(input.CellSizeOfMm, table, options.CellSizeOfMaterialMm);
  AddSizes(input.FacetSizeOfMm, table, options.FacetSizeOfMaterialMm);
  options.Validate();
  return options;
}

SurfaceMesh ReadSurfaces(const MeshCase& input, const MaterialTable& table)
{
  SurfaceMesh all;
  for (const auto& [name, path] : input.Surfaces)
  {
    AppendBoundary(ReadSurface(path), table.IndexOf(name), all);
  }
  return all;
}

MeshingResult Fill(const MeshCase& input, const MaterialTable& table, const MeshingOptions& options,
  const ProgressCallback& progress)
{
  LabelVolume materials;
  if (input.Surfaces.empty())
  {
    materials = ReadMaterials(input.Labels, table);
  }
  else
  {
    const SurfaceMesh surfaces = ReadSurfaces(input, table);
    if (!input.SurfaceVoxelsMm)
    {
      return MeshSurfaces(surfaces, options, progress);
    }
    materials = LabelSurfaces(surfaces, *input.SurfaceVoxelsMm, progress);
  }
  if (input.MechanicsCellSizeMm)
  {
    return MeshForSimulation(materials, table.Fixed(), *input.MechanicsCellSizeMm, progress);
  }
  return input.Filling == MeshCase::Method::TetGen
    ? MeshMaterialSurfaces(materials, options, progress)
    : MeshMaterials(materials, options, progress);
}
}

double FacetSizeMm(const MeshingOptions& options, int material)
{
  const auto own = options.FacetSizeOfMaterialMm.find(material);
  return own == options.FacetSizeOfMaterialMm.end() ? options.FacetSizeMm : own->second;
}

MeshCaseResult RunMeshCase(const MeshCase& input, const ProgressCallback& progress)
{
  MeshCaseResult result;
  result.Materials = TableOf(input);
  result.Options = OptionsOf(input, result.Materials);
  result.Meshed = Fill(input, result.Materials, result.Options, progress);
  result.Check = CheckMesh(result.Meshed.Mesh, progress);
  const bool sizesUsed =
    input.Surfaces.empty() && !input.MechanicsCellSizeMm && result.Options.Triangles == 0;
  for (const MaterialQuality& entry : result.Check.Materials)
  {
    if (sizesUsed && 2 * entry.MeanThicknessMm() < FacetSizeMm(result.Options, entry.Material))
    {
      result.TooThin.push_back(entry);
    }
  }
  return result;
}
}
