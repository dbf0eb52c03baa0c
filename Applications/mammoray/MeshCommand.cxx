// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/IO/SurfaceConversion.h"
#include "mammoray/Report/CutPicture.h"
#include "mammoray/Report/HistogramPicture.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Meshing/MeshCheck.h"
#include "mammoray/Meshing/SimulationMesh.h"
#include "mammoray/Meshing/SurfaceMesher.h"
#include "mammoray/Meshing/SurfaceVoxels.h"
#endif

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

namespace mammoray
{
#ifdef MAMMORAY_HAS_MESHING
namespace
{
struct MeshArguments
{
  LabelSource Labels;
  std::string Materials;
  MeshingOptions Options;
  std::vector<std::string> Thin;
  std::vector<std::string> CellSizeOf;
  std::vector<std::string> FacetSizeOf;
  std::vector<std::string> FacetDistanceOf;
  /// MATERIAL=FILE each.
  std::vector<std::string> Surfaces;
  /// Of the grid that the surfaces label; 0: TetGen fills them as they are.
  double SurfaceVoxelsMm = 0;
  std::string Method = "cgal";
  bool ForMechanics = false;
  /// Of the mesh for the mechanics; 0: by the size of the breast.
  double MechanicsCellSizeMm = 0;
  std::string Output;
  std::string Check;
  std::string Report;
  std::string Picture;
  std::string CutPicture;
  /// Point of the cuts, mm; empty: the middle of the mesh.
  std::vector<double> CutAt;
  bool Overwrite = false;
};

/// "skin=1.2" into index -> mm.
void AddSizes(const std::vector<std::string>& texts, const char* option, const MaterialTable& table,
  std::map<int, double>& sizes)
{
  for (const std::string& text : texts)
  {
    const auto equals = text.find('=');
    char* end = nullptr;
    const char* number = equals == std::string::npos ? "" : text.c_str() + equals + 1;
    const double size = std::strtod(number, &end);
    if (end == number || *end != 0)
    {
      throw InputError(
        std::string(option) + ": expected MATERIAL=MM, for example skin=1.2, found '" + text + "'");
    }
    sizes[table.IndexOf(text.substr(0, equals))] = size;
  }
}

using Json = nlohmann::ordered_json;

std::string NameOf(int material, const std::vector<std::string>& names)
{
  const auto index = static_cast<std::size_t>(material);
  return index < names.size() ? names[index] : "material " + std::to_string(material);
}

Json CheckJson(const MeshCheck& check, const std::vector<std::string>& names)
{
  Json json;
  json["sound"] = check.Sound();
  json["points"] = check.Points;
  json["cells"] = check.Cells;
  json["interface_triangles"] = check.Triangles;
  json["troubles"] = Json::array();
  for (const MeshTrouble& trouble : check.Troubles)
  {
    Json entry{ { "text", trouble.Text(names) }, { "count", trouble.Count } };
    for (const MeshTrouble::Place& place : trouble.Places)
    {
      entry["places"].push_back({ { "point_mm", place.Point },
        { "material", place.Material < 0 ? Json() : Json(NameOf(place.Material, names)) },
        { "border_mm", place.LengthMm } });
    }
    json["troubles"].push_back(entry);
  }
  json["dihedral_step_deg"] = MeshCheck::DihedralStepDeg;
  json["radius_edge_step"] = MeshCheck::RadiusEdgeStep;
  for (const MaterialQuality& entry : check.Materials)
  {
    json["per_material"].push_back({ { "material", NameOf(entry.Material, names) },
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

Json ReportJson(const MeshArguments& arguments, const std::vector<std::string>& names,
  const MeshingResult& result)
{
  Json report;
  report["labels"] = arguments.Labels.Path;
  report["surfaces"] = arguments.Surfaces;
  report["materials"] = arguments.Materials;
  const bool fromLabels = arguments.Surfaces.empty() || arguments.SurfaceVoxelsMm > 0;
  report["method"] = fromLabels ? arguments.Method : "tetgen";
  report["components"] = result.Components;
  report["merged_voxels"] = result.MergedVoxels;
  report["time_limit_reached"] = result.TimeLimitReached;
  report["seconds"] = result.Seconds;
  // Of the whole command to here, reading included.
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  report["processor_seconds"] = Seconds(usage.ru_utime) + Seconds(usage.ru_stime);
  report["peak_memory_bytes"] = 1024 * static_cast<std::int64_t>(usage.ru_maxrss);
  for (const MaterialReport& entry : result.Reports)
  {
    report["volumes"].push_back(
      { { "material", NameOf(entry.Material, names) }, { "volume_in_mm3", entry.VolumeInMm3 },
        { "volume_out_mm3", entry.VolumeOutMm3 }, { "volume_kept", entry.KeepsVolume() } });
  }
  return report;
}

void WriteJson(const std::string& path, const Json& json)
{
  WriteComplete(path,
    [&](const std::string& temporary)
    {
      std::ofstream file(temporary);
      file << json.dump(2) << '\n';
      file.close();
      if (!file)
      {
        throw InputError(path + ": cannot be written");
      }
    });
}

/// Worst dihedral angles and radius-edge ratios of the cells.
void WriteQualityPicture(const std::string& path, const MeshCheck& check,
  const std::vector<std::string>& names)
{
  HistogramPanel dihedral{ "smallest dihedral angle of a cell [deg]", MeshCheck::DihedralStepDeg,
    {} };
  HistogramPanel ratio{ "circumradius / shortest edge", MeshCheck::RadiusEdgeStep, {} };
  for (const MaterialQuality& entry : check.Materials)
  {
    if (entry.Cells > 0)
    {
      const std::string name = NameOf(entry.Material, names);
      dihedral.Groups.push_back({ name, entry.DihedralHistogram });
      ratio.Groups.push_back({ name, entry.RadiusEdgeHistogram });
    }
  }
  WriteComplete(path,
    [&](const std::string& temporary) {
      WriteHistogramPicture({ dihedral, ratio }, temporary);
    });
}

/// Planes through the point asked for, or a cell near the middle of the mesh.
void WriteCuts(const MeshArguments& arguments, vtkUnstructuredGrid* grid,
  const TetrahedralMesh& mesh, const std::vector<std::string>& names)
{
  Vector3 point;
  grid->GetCenter(point.data());
  if (arguments.CutAt.empty())
  {
    // The middle itself may lie between two bodies.
    const Vector3 middle = point;
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
  }
  std::copy(arguments.CutAt.begin(), arguments.CutAt.end(), point.begin());
  WriteComplete(arguments.CutPicture,
    [&](const std::string& temporary)
    { WriteCutPicture(CutsThrough(grid, point), names, temporary); });
}

void PrintCheck(const MeshCheck& check, const std::vector<std::string>& names)
{
  std::printf("%-16s %12s %10s %10s %12s %12s\n", "material", "volume [cm3]", "triangles", "cells",
    "dihedral", "radius/edge");
  for (const MaterialQuality& entry : check.Materials)
  {
    std::printf("%-16s %12.3f %10zu", NameOf(entry.Material, names).c_str(), entry.VolumeMm3 / 1000,
      entry.BoundaryTriangles);
    if (entry.Cells > 0)
    {
      std::printf(" %10zu %8.2f deg %12.2f", entry.Cells, entry.SmallestDihedralDeg,
        entry.LargestRadiusEdgeRatio);
    }
    std::printf("\n");
  }
  std::printf("%zu points, %zu tetrahedra, %zu interface triangles\n", check.Points, check.Cells,
    check.Triangles);
}

void CheckReportFiles(const MeshArguments& arguments)
{
  if (!arguments.Report.empty())
  {
    CheckOutputFile(arguments.Report, arguments.Overwrite);
  }
  CheckPictureFile(arguments.Picture, arguments.Overwrite);
  CheckPictureFile(arguments.CutPicture, arguments.Overwrite);
}

/// Every trouble on a line of its own; those of a mesh that is not sound end in exit code 1.
void RunCheck(const MeshArguments& arguments)
{
  CheckInputFile(arguments.Check);
  CheckReportFiles(arguments);
  std::vector<std::string> names;
  MeshCheck check;
  const std::filesystem::path extension = std::filesystem::path(arguments.Check).extension();
  if (extension == ".vtu" || extension == ".vtk")
  {
    const vtkSmartPointer<vtkUnstructuredGrid> grid = ReadMesh(arguments.Check);
    const TetrahedralMesh mesh = FromGrid(grid, &names);
    check = CheckMesh(mesh, MakeProgressBar());
    if (!arguments.CutPicture.empty())
    {
      WriteCuts(arguments, grid, mesh, names);
    }
  }
  else
  {
    if (!arguments.CutPicture.empty())
    {
      throw InputError(
        "--cut-picture: expected a mesh (.vtu) to cut, found the surface " + arguments.Check);
    }
    check = CheckSurface(FromPolyData(ReadSurface(arguments.Check), &names), MakeProgressBar());
  }
  if (!arguments.Report.empty())
  {
    Json report = CheckJson(check, names);
    WriteJson(arguments.Report, report);
  }
  if (!arguments.Picture.empty())
  {
    WriteQualityPicture(arguments.Picture, check, names);
  }
  PrintCheck(check, names);
  std::string message;
  for (const MeshTrouble& trouble : check.Troubles)
  {
    message +=
      (message.empty() ? "" : "\nmammoray: ") + arguments.Check + ": " + trouble.Text(names);
  }
  if (!message.empty())
  {
    throw ConvergenceError(message);
  }
  std::printf("sound: every cell is upright, every boundary a closed surface\n");
}

void PrintReport(const std::vector<std::string>& names, const MeshingResult& result,
  const MeshCheck& check)
{
  std::printf("%-16s %12s %12s %8s %10s %12s %12s\n", "material", "in [cm3]", "out [cm3]", "out/in",
    "cells", "dihedral", "radius/edge");
  for (const MaterialReport& entry : result.Reports)
  {
    std::printf("%-16s %12.3f %12.3f %7.1f%% %10zu %8.2f deg %12.2f\n",
      NameOf(entry.Material, names).c_str(), entry.VolumeInMm3 / 1000, entry.VolumeOutMm3 / 1000,
      100 * entry.VolumeOutMm3 / entry.VolumeInMm3, entry.Cells, entry.SmallestDihedralDeg,
      entry.LargestRadiusEdgeRatio);
  }
  std::printf("%zu points, %zu tetrahedra, %zu interface triangles, %zu components, %.1f s\n",
    check.Points, check.Cells, check.Triangles, result.Components, result.Seconds);
  if (result.MergedVoxels > 0)
  {
    std::printf("%zu voxels in components below the smallest size went to their surroundings\n",
      result.MergedVoxels);
  }
  for (const MaterialReport& entry : result.Reports)
  {
    if (!entry.KeepsVolume())
    {
      std::fprintf(stderr,
        "mammoray: warning: %s: expected its voxels' %.3f cm3, reached %.3f; smaller "
        "--facet-size-of "
        "and --smallest-component, or finer voxels, keep more\n",
        NameOf(entry.Material, names).c_str(), entry.VolumeInMm3 / 1000, entry.VolumeOutMm3 / 1000);
    }
  }
  if (result.TimeLimitReached)
  {
    std::printf("the sliver removal met its time limit: this mesh may differ on another machine\n");
  }
}

/// Facets are placed where interfaces are met, and may miss a plate between two of them.
void WarnOfThinMaterials(const MaterialTable& table, const MeshingOptions& options,
  const MeshCheck& check)
{
  const std::vector<std::string> names = table.Names();
  for (const MaterialQuality& entry : check.Materials)
  {
    const auto own = options.FacetSizeOfMaterialMm.find(entry.Material);
    const double facetMm =
      own == options.FacetSizeOfMaterialMm.end() ? options.FacetSizeMm : own->second;
    if (2 * entry.MeanThicknessMm() < facetMm)
    {
      std::fprintf(stderr,
        "mammoray: warning: %s: %.2g mm thick on average (twice its volume over its area), less "
        "than half of its facets' %g mm: expect gaps; --thin and --facet-size-of make finer ones\n",
        NameOf(entry.Material, names).c_str(), entry.MeanThicknessMm(), facetMm);
    }
  }
}

void CheckArguments(const MeshArguments& arguments)
{
  const bool fromSurfaces = !arguments.Surfaces.empty();
  if (fromSurfaces == !arguments.Labels.Path.empty())
  {
    throw CLI::RequiredError("one of --labels, --surface and --check");
  }
  if ((arguments.Materials.empty() && !fromSurfaces) || arguments.Output.empty())
  {
    throw CLI::RequiredError(arguments.Output.empty() ? "--output" : "--materials");
  }
  CheckOutputFile(arguments.Output, arguments.Overwrite);
  if (std::filesystem::path(arguments.Output).extension() != ".vtu")
  {
    throw InputError(arguments.Output + ": expected the extension .vtu for a volume mesh");
  }
  CheckReportFiles(arguments);
}

/// The table of the file, or one that names the materials of the surfaces in their order.
MaterialTable FindTable(const MeshArguments& arguments)
{
  if (!arguments.Materials.empty())
  {
    return FindMaterialTable(arguments.Materials);
  }
  MaterialTable table;
  table.Materials.push_back({ "air" });
  for (const std::string& text : arguments.Surfaces)
  {
    const std::string name = text.substr(0, text.find('='));
    if (std::none_of(table.Materials.begin(), table.Materials.end(),
          [&](const Material& known) { return known.Name == name; }))
    {
      table.Materials.push_back({ name });
    }
  }
  return table;
}

MeshingOptions FindOptions(const MeshArguments& arguments, const MaterialTable& table)
{
  MeshingOptions options = arguments.Options;
  std::vector<int> thin = arguments.Thin.empty() ? table.Thin() : std::vector<int>{};
  for (const std::string& name : arguments.Thin)
  {
    if (name != "none")
    {
      thin.push_back(table.IndexOf(name));
    }
  }
  const MeshingOptions layers = MeshingOptions::Anatomy(thin);
  options.CellSizeOfMaterialMm = layers.CellSizeOfMaterialMm;
  options.FacetSizeOfMaterialMm = layers.FacetSizeOfMaterialMm;
  options.FacetDistanceOfMaterialMm = layers.FacetDistanceOfMaterialMm;
  AddSizes(arguments.CellSizeOf, "--cell-size-of", table, options.CellSizeOfMaterialMm);
  AddSizes(arguments.FacetSizeOf, "--facet-size-of", table, options.FacetSizeOfMaterialMm);
  AddSizes(arguments.FacetDistanceOf, "--facet-distance-of", table,
    options.FacetDistanceOfMaterialMm);
  options.Validate();
  return options;
}

/// All files of --surface as one, each the closed boundary of its material.
SurfaceMesh ReadSurfaces(const MeshArguments& arguments, const MaterialTable& table)
{
  SurfaceMesh all;
  for (const std::string& text : arguments.Surfaces)
  {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    {
      throw InputError(
        "--surface: expected MATERIAL=FILE, for example fat=fat.stl, found '" + text + "'");
    }
    const int material = table.IndexOf(text.substr(0, equals));
    const std::string path = CheckInputFile(text.substr(equals + 1));
    const SurfaceMesh surface = FromPolyData(ReadSurface(path));
    const auto base = static_cast<std::uint32_t>(all.NumberOfPoints());
    all.Points.insert(all.Points.end(), surface.Points.begin(), surface.Points.end());
    for (const std::uint32_t id : surface.Triangles)
    {
      all.Triangles.push_back(base + id);
    }
    for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
    {
      const auto side = [&](std::uint16_t other)
      { return static_cast<std::uint16_t>(other == 0 ? 0 : material); };
      all.FrontMaterials.push_back(side(surface.FrontMaterials[triangle]));
      all.BackMaterials.push_back(side(surface.BackMaterials[triangle]));
    }
  }
  return all;
}

MeshingResult MakeMesh(const MeshArguments& arguments, const MaterialTable& table,
  const MeshingOptions& options)
{
  LabelVolume materials;
  if (arguments.Surfaces.empty())
  {
    materials = ReadMaterials(arguments.Labels, table);
  }
  else
  {
    const SurfaceMesh surfaces = ReadSurfaces(arguments, table);
    if (arguments.SurfaceVoxelsMm == 0)
    {
      return MeshSurfaces(surfaces, options, MakeProgressBar());
    }
    materials = LabelSurfaces(surfaces, arguments.SurfaceVoxelsMm, MakeProgressBar());
  }
  if (arguments.ForMechanics)
  {
    return MeshForSimulation(materials, table.Held(), arguments.MechanicsCellSizeMm,
      MakeProgressBar());
  }
  return arguments.Method == "tetgen" ? MeshMaterialSurfaces(materials, options, MakeProgressBar())
                                      : MeshMaterials(materials, options, MakeProgressBar());
}

void RunMesh(const MeshArguments& arguments)
{
  if (!arguments.Check.empty())
  {
    RunCheck(arguments);
    return;
  }
  CheckArguments(arguments);
  const MaterialTable table = FindTable(arguments);
  const MeshingOptions options = FindOptions(arguments, table);
  const MeshingResult result = MakeMesh(arguments, table, options);

  const MeshCheck check = CheckMesh(result.Mesh, MakeProgressBar());
  const std::vector<std::string> names = table.Names();
  const vtkSmartPointer<vtkUnstructuredGrid> grid = ToGrid(result.Mesh, names);
  WriteComplete(arguments.Output,
    [&](const std::string& temporary) { WriteMesh(grid, temporary); });
  if (!arguments.CutPicture.empty())
  {
    WriteCuts(arguments, grid, result.Mesh, names);
  }
  if (!arguments.Report.empty())
  {
    Json report = ReportJson(arguments, names, result);
    report.update(CheckJson(check, names));
    WriteJson(arguments.Report, report);
  }
  if (!arguments.Picture.empty())
  {
    WriteQualityPicture(arguments.Picture, check, names);
  }
  PrintReport(names, result, check);
  if (arguments.Surfaces.empty() && !arguments.ForMechanics && options.Triangles == 0)
  {
    WarnOfThinMaterials(table, options, check);
  }
}
}

void AddMeshCommand(CLI::App& application)
{
  CLI::App* command = application.add_subcommand("mesh",
    "Tetrahedra with a material each from a segmented volume or from closed surfaces.\nPoints are "
    "mm in the volume's frame "
    "(DICOM LPS where the file says so).");
  auto arguments = std::make_shared<MeshArguments>();
  arguments->Options = MeshingOptions::Anatomy({});
  MeshingOptions& options = arguments->Options;
  AddLabelOptions(*command, arguments->Labels);
  CLI::Option* surface = command->add_option("--surface", arguments->Surfaces,
    "MATERIAL=FILE: closed surface of a material (.vtp .stl .ply .obj) instead of labels; may be "
    "given for several, nested or touching at common triangles; filled by TetGen");
  command
    ->add_option("--surface-voxels", arguments->SurfaceVoxelsMm,
      "for surfaces that cut each other: label cubic voxels of this size by them, mm, and mesh "
      "those; overlapping pieces of a material become one")
    ->check(PositiveNumber())
    ->needs(surface);
  AddMaterialsOption(*command, arguments->Materials);
  command
    ->add_option("--method", arguments->Method,
      "cgal: Mesh_3 straight from the labels; tetgen: closed surfaces of the same sizes, filled by "
      "TetGen")
    ->check(CLI::IsMember({ "cgal", "tetgen" }))
    ->capture_default_str();
  command
    ->add_flag("--for-mechanics", arguments->ForMechanics,
      "a coarse mesh of all tissue, held and free, for --simulation-mesh of compress and register; "
      "of the sizes only --cell-size counts, by default one that gives 3000 to 4000 cells")
    ->excludes(surface);
  command->add_option("-o,--output", arguments->Output, "volume mesh to write (.vtu)");
  command->add_option("--check", arguments->Check,
    "check this mesh (.vtu, or legacy .vtk) or surface (.vtp .stl .ply .obj) instead of making "
    "one: "
    "cells upright and joined, boundaries closed; exit code 1 and a line for each kind of trouble");
  command->add_option("--report", arguments->Report,
    "write volumes, cell quality and troubles with their places there (.json)");
  command->add_option("--picture", arguments->Picture,
    "draw histograms of the cells' quality there (.png)");
  CLI::Option* cut = command->add_option("--cut-picture", arguments->CutPicture,
    "draw three plane cuts through the mesh there, coloured by material (.png)");
  command
    ->add_option("--cut-at", arguments->CutAt,
      "point of the cuts, mm; default: the middle of the mesh")
    ->expected(3)
    ->type_name("X Y Z")
    ->needs(cut);
  command
    ->add_option("--spacing", arguments->Labels.SpacingMm,
      "resample to cubic voxels of this size first, mm")
    ->check(PositiveNumber());
  const auto add = [&](const char* name, double& value, const char* help)
  { return command->add_option(name, value, help)->capture_default_str(); };
  CLI::Option* cellSize =
    add("--cell-size", options.CellSizeMm, "largest circumradius of tetrahedra, mm");
  add("--facet-size", options.FacetSizeMm, "largest surface ball of facets, mm");
  add("--facet-distance", options.FacetDistanceMm, "largest distance of facet and interface, mm");
  add("--facet-angle", options.FacetAngleDeg, "smallest angle of facets, degrees, up to 30");
  add("--layer-facet-size", options.LayerFacetSizeMm,
    "refine facets down to this, mm, where they step over a thin layer; 0 does not");
  command->add_option("--thin", arguments->Thin,
    "MATERIAL that forms a layer of about a millimetre (skin): sizes for it, where not given "
    "below; default: those that the table calls thin, 'none' for none");
  command->add_option("--cell-size-of", arguments->CellSizeOf,
    "MATERIAL=MM: cell size of one material; may be given for several");
  command->add_option("--facet-size-of", arguments->FacetSizeOf,
    "MATERIAL=MM: facet size of what bounds one material; may be given for several");
  command->add_option("--facet-distance-of", arguments->FacetDistanceOf,
    "MATERIAL=MM: facet distance at the interfaces of one material; may be given for several");
  add("--radius-edge", options.CellRadiusEdgeRatio, "largest circumradius / shortest edge");
  add("--smallest-component", options.SmallestComponentMm3,
    "smaller parts go to their surroundings, mm3");
  add("--smoothing", options.SmoothingVoxels, "smoothing of the voxels' stairs, voxels");
  command
    ->add_option("--triangles", options.Triangles,
      "scale sizes and distances of facets until there are so many interface triangles, within 10 "
      "%; 0 does not. 5 million take about 13 minutes and 8 GB")
    ->capture_default_str();
  add("--smallest-dihedral", options.SmallestDihedralDeg,
    "slivers are mended to this dihedral angle where that can be reached, degrees; 0 leaves them");
  add("--optimisation-seconds", options.OptimisationSeconds,
    "time limit of each step of CGAL's own optimisation before that (perturb, exude), s; 0 leaves "
    "it out");
  command->add_flag("--overwrite", arguments->Overwrite, "replace output files");
  AddConfigurationOptions(*command);
  command->callback(
    [arguments, cellSize]
    {
      arguments->MechanicsCellSizeMm = cellSize->count() > 0 ? arguments->Options.CellSizeMm : 0;
      RunMesh(*arguments);
    });
}
#else
void AddMeshCommand(CLI::App& application)
{
  CLI::App* command = application.add_subcommand("mesh", "Not in this build (no Meshing module).");
  command->allow_extras();
  command->callback(
    [] {
      throw InputError("mesh: this build has no Meshing module (MAMMORAY_BUILD_MESHING was OFF)");
    });
}
#endif
}
