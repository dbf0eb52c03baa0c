// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#include "LabelResampling.h"
#include "LabelVolumeIO.h"
#include "MaterialTableIO.h"
#include "MeshConversion.h"
#include "MeshIO.h"

#ifdef MAMMORAY_HAS_MESHING
#include "LabelMesher.h"
#endif

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

namespace mammoray
{
#ifdef MAMMORAY_HAS_MESHING
namespace
{
struct MeshArguments
{
  std::string Labels;
  std::string Materials;
  double SpacingMm = 0;
  bool AxesAsGiven = false;
  MeshingOptions Options;
  std::vector<std::string> Thin;
  std::vector<std::string> CellSizeOf;
  std::vector<std::string> FacetSizeOf;
  std::vector<std::string> FacetDistanceOf;
  std::string Output;
  std::string Report;
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

nlohmann::ordered_json ReportJson(const MeshArguments& arguments, const MaterialTable& table,
  const MeshingResult& result)
{
  nlohmann::ordered_json report;
  report["labels"] = arguments.Labels;
  report["materials"] = arguments.Materials;
  report["points"] = result.Mesh.NumberOfPoints();
  report["cells"] = result.Mesh.NumberOfCells();
  report["components"] = result.Components;
  report["merged_voxels"] = result.MergedVoxels;
  report["time_limit_reached"] = result.TimeLimitReached;
  report["seconds"] = result.Seconds;
  for (const MaterialReport& entry : result.Reports)
  {
    report["per_material"].push_back({ { "material", table.Materials[entry.Material].Name },
      { "volume_in_mm3", entry.VolumeInMm3 }, { "volume_out_mm3", entry.VolumeOutMm3 },
      { "cells", entry.Cells }, { "smallest_dihedral_deg", entry.SmallestDihedralDeg },
      { "largest_radius_edge_ratio", entry.LargestRadiusEdgeRatio } });
  }
  return report;
}

void PrintReport(const MaterialTable& table, const MeshingResult& result)
{
  std::printf("%-16s %12s %12s %8s %10s %12s %12s\n", "material", "in [cm3]", "out [cm3]", "out/in",
    "cells", "dihedral", "radius/edge");
  for (const MaterialReport& entry : result.Reports)
  {
    std::printf("%-16s %12.3f %12.3f %7.1f%% %10zu %8.2f deg %12.2f\n",
      table.Materials[entry.Material].Name.c_str(), entry.VolumeInMm3 / 1000,
      entry.VolumeOutMm3 / 1000, 100 * entry.VolumeOutMm3 / entry.VolumeInMm3, entry.Cells,
      entry.SmallestDihedralDeg, entry.LargestRadiusEdgeRatio);
  }
  std::printf("%zu points, %zu tetrahedra, %zu components, %.1f s\n", result.Mesh.NumberOfPoints(),
    result.Mesh.NumberOfCells(), result.Components, result.Seconds);
  if (result.MergedVoxels > 0)
  {
    std::printf("%zu voxels in components below the smallest size went to their surroundings\n",
      result.MergedVoxels);
  }
  if (result.TimeLimitReached)
  {
    std::printf("the sliver removal met its time limit: this mesh may differ on another machine\n");
  }
}

void RunMesh(const MeshArguments& arguments)
{
  CheckInputFile(arguments.Labels);
  CheckInputFile(arguments.Materials);
  CheckOutputFile(arguments.Output, arguments.Overwrite);
  if (std::filesystem::path(arguments.Output).extension() != ".vtu")
  {
    throw InputError(arguments.Output + ": expected the extension .vtu for a volume mesh");
  }
  if (!arguments.Report.empty())
  {
    CheckOutputFile(arguments.Report, arguments.Overwrite);
  }
  const MaterialTable table = ReadMaterialTable(arguments.Materials);
  MeshingOptions options = arguments.Options;
  std::vector<int> thin;
  for (const std::string& name : arguments.Thin)
  {
    thin.push_back(table.IndexOf(name));
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
  LabelVolume volume =
    table.ToMaterials(ReadLabelVolume(arguments.Labels,
                        arguments.AxesAsGiven ? VolumeAxes::AsGiven : VolumeAxes::Patient),
      arguments.Labels);
  if (arguments.SpacingMm > 0)
  {
    volume = ResampleLabels(volume, arguments.SpacingMm);
  }
  const MeshingResult result = MeshMaterials(volume, options, MakeProgressBar());

  std::vector<std::string> names;
  for (const Material& material : table.Materials)
  {
    names.push_back(material.Name);
  }
  WriteComplete(arguments.Output,
    [&](const std::string& temporary) { WriteMesh(ToGrid(result.Mesh, names), temporary); });
  if (!arguments.Report.empty())
  {
    WriteComplete(arguments.Report,
      [&](const std::string& temporary)
      {
        std::ofstream file(temporary);
        file << ReportJson(arguments, table, result).dump(2) << '\n';
        file.close();
        if (!file)
        {
          throw InputError(arguments.Report + ": cannot be written");
        }
      });
  }
  PrintReport(table, result);
}
}

void AddMeshCommand(CLI::App& application)
{
  CLI::App* command = application.add_subcommand("mesh",
    "Tetrahedra with a material each from a segmented volume.\nPoints are mm in the volume's frame "
    "(DICOM LPS where the file says so).");
  auto arguments = std::make_shared<MeshArguments>();
  arguments->Options = MeshingOptions::Anatomy({});
  MeshingOptions& options = arguments->Options;
  command
    ->add_option("--labels", arguments->Labels, "label volume: .nrrd .nhdr .mha .mhd .nii .nii.gz")
    ->required();
  command->add_option("--materials", arguments->Materials, "material table (.json)")->required();
  command->add_option("-o,--output", arguments->Output, "volume mesh to write (.vtu)")->required();
  command->add_option("--report", arguments->Report,
    "write volumes and cell quality there (.json)");
  command
    ->add_option("--spacing", arguments->SpacingMm,
      "resample to cubic voxels of this size first, mm")
    ->check(CLI::PositiveNumber);
  command->add_flag("--axes-as-given", arguments->AxesAsGiven,
    "take the header's axes as they are, with no conversion to LPS");
  const auto add = [&](const char* name, double& value, const char* help)
  { command->add_option(name, value, help)->capture_default_str(); };
  add("--cell-size", options.CellSizeMm, "largest circumradius of tetrahedra, mm");
  add("--facet-size", options.FacetSizeMm, "largest surface ball of facets, mm");
  add("--facet-distance", options.FacetDistanceMm, "largest distance of facet and interface, mm");
  add("--facet-angle", options.FacetAngleDeg, "smallest angle of facets, degrees, up to 30");
  add("--layer-facet-size", options.LayerFacetSizeMm,
    "refine facets down to this, mm, where they step over a thin layer; 0 does not");
  command->add_option("--thin", arguments->Thin,
    "MATERIAL that forms a layer of about a millimetre (skin): sizes for it, where not given "
    "below");
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
  add("--smallest-dihedral", options.SmallestDihedralDeg,
    "dihedral angle below which slivers are removed, degrees");
  add("--optimisation-seconds", options.OptimisationSeconds,
    "time limit of each step of sliver removal, s; 0 leaves it out");
  command->add_flag("--overwrite", arguments->Overwrite, "replace output files");
  AddConfigurationOptions(*command);
  command->callback([arguments] { RunMesh(*arguments); });
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
