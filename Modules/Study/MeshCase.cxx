// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/MeshCase.h"

#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/SurfaceMesher.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <limits>

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
    SurfaceMesh surface = ReadSurface(path);
    if (!input.SurfaceUnit.empty())
    {
      ScaleSurface(path, LengthUnitMm(input.SurfaceUnit), path, surface);
    }
    AppendBoundary(surface, table.IndexOf(name), all);
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

using Json = nlohmann::ordered_json;

Json CheckJson(const MeshCheck& check, const std::vector<std::string>& names)
{
  Json json;
  json["sound"] = check.Sound();
  json["points"] = check.Points;
  json["cells"] = check.Cells;
  json["interface_triangles"] = check.Triangles;
  json["troubles"] = Json::array();
  for (const MeshDefect& defect : check.Defects)
  {
    Json entry{ { "text", defect.Text(names) }, { "count", defect.Count } };
    for (const MeshDefect::Place& place : defect.Places)
    {
      entry["places"].push_back({ { "point_mm", place.Point },
        { "material", place.Material < 0 ? Json() : Json(NameOfMaterial(place.Material, names)) },
        { "border_mm", place.LengthMm } });
    }
    json["troubles"].push_back(entry);
  }
  json["dihedral_step_deg"] = MeshCheck::DihedralStepDeg;
  json["radius_edge_step"] = MeshCheck::RadiusEdgeStep;
  for (const MaterialQuality& entry : check.Materials)
  {
    json["per_material"].push_back({ { "material", NameOfMaterial(entry.Material, names) },
      { "volume_mm3", entry.VolumeMm3 }, { "boundary_triangles", entry.BoundaryTriangles },
      { "boundary_area_mm2", entry.BoundaryAreaMm2 }, { "cells", entry.Cells },
      { "smallest_dihedral_deg", entry.SmallestDihedralDeg },
      { "smallest_dihedral_place_mm", entry.SmallestDihedralPlace },
      { "largest_radius_edge_ratio", entry.LargestRadiusEdgeRatio },
      { "largest_radius_edge_place_mm", entry.LargestRadiusEdgePlace },
      { "dihedral_histogram", entry.DihedralHistogram },
      { "radius_edge_histogram", entry.RadiusEdgeHistogram } });
  }
  return json;
}

double Seconds(const timeval& time)
{
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

Json SurfacesJson(const MeshCase& input)
{
  Json surfaces = Json::array();
  for (const auto& [material, path] : input.Surfaces)
  {
    surfaces.push_back(material + "=" + path);
  }
  return surfaces;
}

Vector3 MiddleOf(vtkUnstructuredGrid* grid)
{
  Vector3 middle;
  grid->GetCenter(middle.data());
  // The middle itself may lie between two bodies.
  const TetrahedralMesh mesh = FromGrid(grid);
  Vector3 point = middle;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const Vector3 centre = mesh.CellCentre(cell);
    if (const double distance = Norm(centre - middle); distance < nearest)
    {
      nearest = distance;
      point = centre;
    }
  }
  return point;
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

std::string NameOfMaterial(int material, const std::vector<std::string>& names)
{
  const auto index = static_cast<std::size_t>(material);
  return index < names.size() ? names[index] : "material " + std::to_string(material);
}

std::string CheckReport(const MeshCheck& check, const std::vector<std::string>& names)
{
  return CheckJson(check, names).dump(2) + "\n";
}

std::string MeshReport(const MeshCase& input, const MeshCaseResult& result)
{
  const std::vector<std::string> names = result.Materials.Names();
  Json report;
  report["labels"] = input.Labels.Path;
  report["surfaces"] = SurfacesJson(input);
  report["materials"] = input.Materials;
  const bool fromLabels = input.Surfaces.empty() || input.SurfaceVoxelsMm;
  report["method"] = fromLabels && input.Filling == MeshCase::Method::Cgal ? "cgal" : "tetgen";
  report["components"] = result.Meshed.Components;
  report["merged_voxels"] = result.Meshed.MergedVoxels;
  report["time_limit_reached"] = result.Meshed.TimeLimitReached;
  report["seconds"] = result.Meshed.Seconds;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report["processor_seconds"] = Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
  report["peak_memory_bytes"] = 1024 * static_cast<std::int64_t>(usage.ru_maxrss);
  for (const MaterialReport& entry : result.Meshed.Reports)
  {
    report["volumes"].push_back({ { "material", NameOfMaterial(entry.Material, names) },
      { "volume_in_mm3", entry.VolumeInMm3 }, { "volume_out_mm3", entry.VolumeOutMm3 },
      { "volume_kept", entry.KeepsVolume() } });
  }
  report.update(CheckJson(result.Check, names));
  return report.dump(2) + "\n";
}

void WriteMeshCuts(vtkUnstructuredGrid* mesh, const std::vector<std::string>& names,
  const std::string& path)
{
  WriteCutPicture(CutsThrough(mesh, MiddleOf(mesh)), names, path);
}
}
