// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OptionList.h"
#include "mammoray/Foundation/Error.h"

#ifdef MAMMORAY_HAS_MESHING
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Meshing/SurfaceMesher.h"
#include "mammoray/Study/MeshCase.h"

#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#endif

namespace mammoray
{
#ifdef MAMMORAY_HAS_MESHING
namespace
{
struct MeshArguments
{
  MeshCase Case;
  /// NAME=VALUE each, for the members of Case.
  std::vector<std::string> Surfaces;
  std::vector<std::string> CellSizeOf;
  std::vector<std::string> FacetSizeOf;
  bool ForMechanics = false;
  /// Without it the sizes have their defaults.
  CLI::Option* CellSize = nullptr;
  std::string Output;
  std::string Check;
  std::string Repair;
  std::optional<double> WeldMm;
  std::optional<double> LongestHoleMm;
  std::string Report;
  std::string CutPicture;
};

/// Declares the files that are read and written.
void DeclareFiles(const OptionList& add, MeshArguments& arguments)
{
  MeshCase& input = arguments.Case;
  AddLabelOptions(add, input.Labels);
  CLI::Option* surface = add(Shared::Surface, arguments.Surfaces);
  AddUnitOption(add, input.SurfaceUnit);
  add("--surface-voxels", input.SurfaceVoxelsMm, Positive("mm"),
    "for surfaces that cut each other: mesh cubic voxels labelled by them\n(overlapping pieces of "
    "a "
    "material become one)")
    ->needs(surface);
  add(Shared::Materials, input.Materials);
  add.Choice<MeshCase::Method>("--method", input.Filling,
    { { "cgal", MeshCase::Method::Cgal }, { "tetgen", MeshCase::Method::TetGen } },
    "CGAL straight from labels, or TetGen in surfaces");
  add
    .Flag("--for-mechanics", arguments.ForMechanics,
      "a coarse mesh of all tissue, for --simulation-mesh\n(of the sizes only --cell-size counts, "
      "by default one that gives 3000 to 6000 cells, however ragged the labels are)")
    ->excludes(surface);
  add("-o,--output", arguments.Output, "volume mesh to write (.vtu)");
  add.File("--check", arguments.Check,
    "check this mesh or surface instead of making one\n(.vtu, legacy .vtk, .vtp .stl .ply .obj "
    ".msh .glb .gltf; cells upright and joined, boundaries closed; exit code 1 and a line for each "
    "kind "
    "of defect)");
  CLI::Option* repair = add.File("--repair", arguments.Repair,
    "mend this surface of one material instead, into --output (.vtp .stl .ply .obj)\n(points are "
    "welded, triangles that are flat or there twice left out, the others turned alike and "
    "outwards, small holes closed; what was changed is told, and what is left as by --check)");
  add("--weld", arguments.WeldMm, Positive("mm"),
    "points so near to each other become one (default: 1e-7 of the extent)")
    ->needs(repair);
  add("--close-holes", arguments.LongestHoleMm, NonNegative("mm"),
    "longest border of a hole that is closed (default: a tenth of the extent)")
    ->needs(repair);
  add("--report", arguments.Report,
    "write volumes, cell quality and troubles with their places (.json)");
  add("--cut-picture", arguments.CutPicture,
    "draw three plane cuts through the middle of the mesh, coloured by material (.png)");
}

/// MATERIAL=MM each.
void DeclareOfMaterial(const OptionList& add, const char* name, std::vector<std::string>& sizes,
  const char* help)
{
  add(name, sizes, help)->type_name("MATERIAL=MM");
}

void DeclareSizes(const OptionList& add, MeshArguments& arguments)
{
  MeshingOptions& options = arguments.Case.Options;
  add(Shared::LabelSpacing, arguments.Case.Labels.SpacingMm);
  arguments.CellSize =
    add("--cell-size", options.CellSizeMm, "mm", "largest circumradius of tetrahedra");
  add("--facet-size", options.FacetSizeMm, "mm", "largest surface ball of facets");
  add("--facet-distance", options.FacetDistanceMm, "mm", "largest distance of facet and interface");
  const OptionList expert = add.Expert();
  expert("--thin", arguments.Case.Thin,
    "MATERIAL that forms a layer of about a millimetre (skin)\n(sizes for it, where not given "
    "below; default: those that the table calls thin, 'none' for none)");
  DeclareOfMaterial(expert, "--cell-size-of", arguments.CellSizeOf, "cell size of one material");
  DeclareOfMaterial(expert, "--facet-size-of", arguments.FacetSizeOf,
    "facet size of what bounds one material");
  expert("--triangles", options.Triangles,
    "scale facets until there are so many interface triangles, within 10 %\n(0 does not; 5 million "
    "take about 13 minutes and 8 GB)");
  const OptionList file = add.CaseFile();
  file("--facet-angle", options.FacetAngleDeg, "deg", "smallest angle of facets, up to 30");
  file("--layer-facet-size", options.LayerFacetSizeMm, "mm",
    "refine facets down to this where they step over a thin layer; 0 does not");
  file("--smallest-component", options.SmallestComponentMm3, "mm3",
    "smaller parts go to their surroundings");
  file("--smoothing", options.SmoothingVoxels, "voxels", "smoothing of the voxels' stairs");
  file("--smallest-dihedral", options.SmallestDihedralDeg, "deg",
    "slivers are mended to this dihedral angle where that can be reached; 0 leaves them");
}

void Declare(const OptionList& add, MeshArguments& arguments)
{
  DeclareFiles(add, arguments);
  DeclareSizes(add, arguments);
}

/// "skin=1.2" each.
std::map<std::string, double> ParseSizes(const std::vector<std::string>& texts,
  const std::string& option)
{
  const std::string form = "MATERIAL=MM, for example skin=1.2";
  std::map<std::string, double> sizes;
  for (const std::string& text : texts)
  {
    const auto [name, number] = SplitAssignment(text, option, form);
    char* end = nullptr;
    sizes[name] = std::strtod(number.c_str(), &end);
    if (*end != 0)
    {
      throw InputError(option + ": expected " + form + ", found '" + text + "'");
    }
  }
  return sizes;
}

void ParseCase(MeshArguments& arguments)
{
  MeshCase& input = arguments.Case;
  Program().ApplyTo(input.Labels);
  for (const std::string& text : arguments.Surfaces)
  {
    input.Surfaces.push_back(
      SplitAssignment(text, "--surface", "MATERIAL=FILE, for example fat=fat.stl"));
    CheckInputFile(input.Surfaces.back().second);
  }
  input.CellSizeOfMm = ParseSizes(arguments.CellSizeOf, "--cell-size-of");
  input.FacetSizeOfMm = ParseSizes(arguments.FacetSizeOf, "--facet-size-of");
  if (arguments.ForMechanics)
  {
    input.MechanicsCellSizeMm = arguments.CellSize->count() > 0 ? input.Options.CellSizeMm : 0;
  }
}

void CheckReportFiles(const MeshArguments& arguments)
{
  if (!arguments.Report.empty())
  {
    CheckOutputFile(arguments.Report);
  }
  CheckPictureFile(arguments.CutPicture);
}

/// Writes the report and the picture that were requested. `grid` may be null without a picture.
void WriteReportFiles(const MeshArguments& arguments, const std::string& report,
  const std::vector<std::string>& names, vtkUnstructuredGrid* grid)
{
  if (!arguments.CutPicture.empty())
  {
    WriteMeshCuts(grid, names, arguments.CutPicture);
  }
  if (!arguments.Report.empty())
  {
    WriteAtomicFile(arguments.Report, report);
  }
}

/// The unit in which volumes are printed: by the largest, so that those of fibres keep digits.
struct VolumeUnit
{
  const char* Name;
  double PerMm3;

  explicit VolumeUnit(double largestMm3)
    : Name(largestMm3 >= 100   ? "cm3"
          : largestMm3 >= 1e-4 ? "mm3"
                               : "um3")
    , PerMm3(largestMm3 >= 100 ? 1e-3
          : largestMm3 >= 1e-4 ? 1
                               : 1e9)
  {
  }
  std::string Heading(const char* what) const { return what + (" [" + std::string(Name)) + "]"; }
};

void PrintCheck(const MeshCheck& check, const std::vector<std::string>& names)
{
  double largest = 0;
  for (const MaterialQuality& entry : check.Materials)
  {
    largest = std::max(largest, entry.VolumeMm3);
  }
  const VolumeUnit unit(largest);
  std::printf("%-16s %12s %10s %10s %12s %12s\n", "material", unit.Heading("volume").c_str(),
    "triangles", "cells", "dihedral", "radius/edge");
  for (const MaterialQuality& entry : check.Materials)
  {
    std::printf("%-16s %12.3f %10zu", NameOfMaterial(entry.Material, names).c_str(),
      unit.PerMm3 * entry.VolumeMm3, entry.BoundaryTriangles);
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

/// Writes the lines of a check's defects and ends in the last of them, exit code 1.
void RefuseDefects(const MeshCheck& check, const std::string& path,
  const std::vector<std::string>& names)
{
  for (const MeshDefect& defect : check.Defects)
  {
    // The last one becomes the error message.
    const bool isSeam = defect.What == MeshDefect::Kind::OpenSeams;
    const ConvergenceError error(
      path + ": " + defect.Text(names) + (isSeam ? "; mesh --repair welds them" : ""));
    if (&defect == &check.Defects.back())
    {
      throw error;
    }
    std::fprintf(stderr, "mammoray: %s\n", error.what());
  }
}

/// Every defect on a line of its own; those of a mesh that is not sound end in exit code 1.
void RunCheck(const MeshArguments& arguments)
{
  CheckReportFiles(arguments);
  MeshOrSurface read = ReadMeshOrSurface(arguments.Check);
  if (!read.Volume && !arguments.CutPicture.empty())
  {
    throw InputError(
      "--cut-picture: expected a mesh (.vtu) to cut, found the surface " + arguments.Check);
  }
  std::vector<std::string>& names = read.MaterialNames;
  const MeshCheck check = read.Volume ? CheckMesh(FromGrid(read.Volume, &names), MakeProgressBar())
                                      : CheckSurface(read.Surface, MakeProgressBar());
  WriteReportFiles(arguments, CheckReport(check, names), names, read.Volume);
  PrintCheck(check, names);
  RefuseDefects(check, arguments.Check, names);
  std::printf("sound: every cell is upright, every boundary a closed surface\n");
}

/// Positions are doubles where the format has them.
vtkSmartPointer<vtkPolyData> ToExactPolyData(const SurfaceMesh& surface)
{
  auto exact = ToPolyData(surface, {});
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (std::size_t point = 0; point < surface.NumberOfPoints(); ++point)
  {
    points->InsertNextPoint(&surface.Points[3 * point]);
  }
  exact->SetPoints(points);
  return exact;
}

/// Mends a surface, writes it, and tells what was changed and what is left.
void RunRepair(const MeshArguments& arguments)
{
  if (arguments.Output.empty())
  {
    throw CLI::RequiredError("--output");
  }
  CheckOutputFile(arguments.Output);
  CheckReportFiles(arguments);
  const RepairedSurface repaired =
    RepairSurface(ReadSurface(arguments.Repair), arguments.WeldMm, arguments.LongestHoleMm);
  const MeshCheck check = CheckSurface(repaired.Surface, MakeProgressBar());
  WriteMesh(ToExactPolyData(repaired.Surface), arguments.Output);
  if (!arguments.Report.empty())
  {
    WriteAtomicFile(arguments.Report, CheckReport(check, {}));
  }
  std::printf("%zu points welded, %zu flat and %zu doubled triangles left out, %zu turned, %zu "
              "holes closed, %zu left\n",
    repaired.WeldedPoints, repaired.FlatTriangles, repaired.DoubledTriangles,
    repaired.TurnedTriangles, repaired.ClosedHoles, repaired.OpenHoles);
  PrintCheck(check, {});
  RefuseDefects(check, arguments.Output, {});
  std::printf("sound: every boundary a closed surface\n");
}

VolumeUnit UnitOf(const MeshCaseResult& result)
{
  double largest = 0;
  for (const MaterialReport& entry : result.Meshed.Reports)
  {
    largest = std::max(largest, entry.VolumeInMm3);
  }
  return VolumeUnit(largest);
}

void PrintMesh(const MeshCaseResult& result)
{
  const std::vector<std::string> names = result.Materials.Names();
  const VolumeUnit unit = UnitOf(result);
  std::printf("%-16s %12s %12s %8s %10s %12s %12s\n", "material", unit.Heading("in").c_str(),
    unit.Heading("out").c_str(), "out/in", "cells", "dihedral", "radius/edge");
  for (const MaterialReport& entry : result.Meshed.Reports)
  {
    std::printf("%-16s %12.3f %12.3f %7.1f%% %10zu %8.2f deg %12.2f\n",
      NameOfMaterial(entry.Material, names).c_str(), unit.PerMm3 * entry.VolumeInMm3,
      unit.PerMm3 * entry.VolumeOutMm3, 100 * entry.VolumeOutMm3 / entry.VolumeInMm3, entry.Cells,
      entry.SmallestDihedralDeg, entry.LargestRadiusEdgeRatio);
  }
  std::printf("%zu points, %zu tetrahedra, %zu interface triangles, %zu components, %.1f s\n",
    result.Check.Points, result.Check.Cells, result.Check.Triangles, result.Meshed.Components,
    result.Meshed.Seconds);
  if (result.Meshed.MergedVoxels > 0)
  {
    std::printf("%zu voxels in components below the smallest size went to their surroundings\n",
      result.Meshed.MergedVoxels);
  }
  if (result.Meshed.TimeLimitReached)
  {
    std::printf("the sliver removal met its time limit: this mesh may differ on another machine\n");
  }
}

void WarnOfLosses(const MeshCaseResult& result)
{
  const std::vector<std::string> names = result.Materials.Names();
  const VolumeUnit unit = UnitOf(result);
  for (const MaterialReport& entry : result.Meshed.Reports)
  {
    if (!entry.KeepsVolume())
    {
      std::fprintf(stderr,
        "mammoray: warning: %s: expected its voxels' %.3f %s, reached %.3f; smaller "
        "--facet-size-of and --smallest-component, or finer voxels, keep more\n",
        NameOfMaterial(entry.Material, names).c_str(), unit.PerMm3 * entry.VolumeInMm3, unit.Name,
        unit.PerMm3 * entry.VolumeOutMm3);
    }
  }
  for (const MaterialQuality& entry : result.TooThin)
  {
    std::fprintf(stderr,
      "mammoray: warning: %s: %.2g mm thick on average (twice its volume over its area), less "
      "than half of its facets' %g mm: expect gaps; --thin and --facet-size-of make finer ones\n",
      NameOfMaterial(entry.Material, names).c_str(), entry.MeanThicknessMm(),
      FacetSizeMm(result.Options, entry.Material));
  }
}

void CheckArguments(const MeshArguments& arguments)
{
  const bool fromSurfaces = !arguments.Surfaces.empty();
  if (fromSurfaces == !arguments.Case.Labels.Path.empty())
  {
    throw CLI::RequiredError("one of --labels, --surface, --check and --repair");
  }
  if ((arguments.Case.Materials.empty() && !fromSurfaces) || arguments.Output.empty())
  {
    throw CLI::RequiredError(arguments.Output.empty() ? "--output" : "--materials");
  }
  CheckOutputFile(arguments.Output, ".vtu", "a volume mesh");
  CheckReportFiles(arguments);
}

void Run(MeshArguments& arguments)
{
  if (!arguments.Check.empty() || !arguments.Repair.empty())
  {
    arguments.Check.empty() ? RunRepair(arguments) : RunCheck(arguments);
    return;
  }
  CheckArguments(arguments);
  ParseCase(arguments);
  const MeshCaseResult result = RunMeshCase(arguments.Case, MakeProgressBar());
  const std::vector<std::string> names = result.Materials.Names();
  const vtkSmartPointer<vtkUnstructuredGrid> grid = ToGrid(result.Meshed.Mesh, names);
  WriteMesh(grid, arguments.Output);
  WriteReportFiles(arguments, MeshReport(arguments.Case, result), names, grid);
  PrintMesh(result);
  WarnOfLosses(result);
}
}

void AddMeshCommand(CLI::App& application)
{
  AddCommand<MeshArguments>(application, "mesh",
    "Tetrahedra with a material each from a segmented volume or from closed surfaces.\nPoints are "
    "mm in the volume's frame (DICOM LPS where the file says so).",
    "mesh --labels labels.nrrd --materials victre --label-spacing 0.5 -o breast.vtu", Declare, Run);
}
#else
void AddMeshCommand(CLI::App& application)
{
  AddMissingCommand(application, "mesh", "Meshing module (MAMMORAY_BUILD_MESHING was OFF)");
}
#endif
}
