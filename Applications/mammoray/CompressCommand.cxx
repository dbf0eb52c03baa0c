// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Study/CompressionCase.h"
#include "mammoray/Study/CompressionGrids.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace mammoray
{
namespace
{
struct CompressArguments
{
  CompressionCase Case;
  /// This or the force of the case.
  std::optional<double> ThicknessMm;
  std::string Output;
  std::string Picture;
  /// Time series; empty: none.
  std::string Series;
  int SeriesSteps = 11;
};

/// Declares the mesh to compress and the one to simulate on.
void DeclareMeshes(const OptionList& add, CompressionCase& input)
{
  add(Shared::Mesh, input.Mesh)->required();
  add(Shared::Materials, input.Materials)->required();
  add(Shared::Orientation, input.Orientation);
  add(Shared::Labels, input.Labels.Path);
  add(Shared::SimulationMesh, input.SimulationMesh);
  add.Expert()(Shared::SimulationCellSize, input.SimulationCellSizeMm);
  add.Expert().Choice<ElementType>("--element", input.Loading.Element,
    { { "quadratic", ElementType::Quadratic }, { "linear", ElementType::PatchAveragedLinear } },
    "quadratic tetrahedra of the simulation, or linear ones in patches\n(a tenth of the time, but "
    "three times as many cells a side for the same accuracy)");
}

/// Declares where the unit stands and how far it closes.
void DeclareUnit(const OptionList& add, CompressArguments& arguments)
{
  CompressionCase& input = arguments.Case;
  CLI::Option* thickness =
    add(Shared::Pose(PoseParameters[ThicknessParameter]), arguments.ThicknessMm);
  add("--force", input.ForceN, Positive("N"),
    "force of the paddle, in place of the thickness; 50 to 150 are usual")
    ->excludes(thickness);
  CLI::Option* view = add.Word("--view", input.View, { "CC", "MLO", "LMO", "ML", "LM" },
    "turns the unit by 0, 45 or 90 degrees, to which --roll is added");
  AddSideOption(add, input.Side)->needs(view);
  AddPoseOptions(add.Expert(), input.Pose);
  add.CaseFile()("--edge-radius", input.Unit.EdgeRadiusMm, Between(0, MostEdgeRadiusMm, "mm"),
    "radius of the plates' chest-wall edges");
}

/// Declares the loads beside the plates.
void DeclareLoading(const OptionList& add, CompressionCase& input)
{
  CompressionOptions& loading = input.Loading;
  add.Choice<ChestWallMode>("--chest-wall", loading.ChestWall,
    { { "fixed", ChestWallMode::Fixed }, { "sliding", ChestWallMode::Sliding },
      { "elastic", ChestWallMode::Elastic } },
    "attachment to the fixed materials");
  add.Choice<std::optional<PatientPosition>>("--mri-position", input.ImagePosition,
    { { "none", std::nullopt }, { "prone", PatientPosition::Prone },
      { "supine", PatientPosition::Supine } },
    "how the patient lay in the MRI\n(prone, supine: the breast is relieved of its weight and "
    "compressed standing; none: no weight)");
  const OptionList expert = add.Expert();
  expert("--pull", input.PullN, "N",
    "force that draws the breast forwards onto the receptor, spread over it");
  expert("--friction", loading.Friction, NonNegative(),
    "coefficient of friction between breast and plates");
  const OptionList file = add.CaseFile();
  file("--wall-normal-stiffness", loading.Wall.Normal, Positive("kPa/mm"),
    "of the sliding or elastic chest wall against being left");
  file("--wall-tangential-stiffness", loading.Wall.Tangential, NonNegative("kPa/mm"),
    "of the elastic chest wall against gliding");
}

void Declare(const OptionList& add, CompressArguments& arguments)
{
  DeclareMeshes(add, arguments.Case);
  DeclareUnit(add, arguments);
  DeclareLoading(add, arguments.Case);
  add("-o,--output", arguments.Output, "compressed mesh to write (.vtu)")->required();
  add("--picture", arguments.Picture,
    "draw cuts through the breast before and after, with the plates (.png)");
  add("--series", arguments.Series,
    "time series for ParaView: a .pvd file, with its .vtu files beside it");
  add.Expert()("--series-steps", arguments.SeriesSteps, Between(2, 1000),
    "of the series, from plates that touch nothing to the compressed breast");
}

void CheckOutputs(const CompressArguments& arguments)
{
  CheckOutputFile(arguments.Output, ".vtu", "a volume mesh");
  CheckPictureFile(arguments.Picture);
  if (arguments.Series.empty())
  {
    return;
  }
  CheckOutputFile(arguments.Series, ".pvd", "a time series");
  for (const std::string& file :
    SeriesFiles(arguments.Series, static_cast<std::size_t>(arguments.SeriesSteps)))
  {
    // There may be more than a process may have open.
    CheckOutputPlace(file);
    if (std::filesystem::weakly_canonical(file) ==
      std::filesystem::weakly_canonical(arguments.Output))
    {
      throw InputError(
        "--series " + arguments.Series + ": its file " + file + " is the output file too");
    }
  }
}

/// Counts the breast and fixed tissue apart: fixed tissue has no mechanics, and what glides along
/// its front draws the corners there along.
void PrintInvertedCells(const CompressionCaseResult& result)
{
  const std::vector<bool> fixed = result.Materials.Fixed();
  vtkDataArray* ratios = result.Compressed->GetCellData()->GetArray("J");
  vtkDataArray* materials = result.Compressed->GetCellData()->GetArray("Material");
  for (const bool isFixed : { false, true })
  {
    std::size_t cells = 0;
    std::size_t inverted = 0;
    double worst = 0;
    for (vtkIdType cell = 0; cell < ratios->GetNumberOfTuples(); ++cell)
    {
      if (fixed[static_cast<std::size_t>(materials->GetTuple1(cell))] == isFixed)
      {
        const double ratio = ratios->GetTuple1(cell);
        ++cells;
        inverted += ratio > 0 ? 0 : 1;
        worst = std::min(worst, ratio);
      }
    }
    if (inverted > 0)
    {
      std::printf(
        "%zu of %zu cells of the mesh (%.2g %%) are turned inside out in %s, the worst to "
        "%.2f of its volume (array J)\n",
        inverted, cells, 100.0 * static_cast<double>(inverted) / static_cast<double>(cells),
        isFixed ? "fixed tissue, whose front the breast draws along" : "the breast", worst);
    }
  }
}

void PrintSummary(const CompressionCaseResult& result)
{
  const CompressionState& state = result.State;
  std::printf("%zu simulation cells, %zu unknowns, %d load steps, %d Newton steps, %.1f s, at most "
              "%.0f MiB to factorise\n",
    result.SimulationCells, result.Unknowns, state.LoadSteps, state.NewtonSteps, state.Seconds,
    state.FactorMiB);
  std::printf(
    "thickness %.2f mm, paddle %.2f N, support %.2f N, penetration at most %.3f mm, volume x %.4f, "
    "J %.3f to %.3f\n",
    result.ThicknessMm, state.PaddleForceN, state.SupportForceN, state.LargestPenetrationMm,
    state.VolumeRatio, state.SmallestJ, state.LargestJ);
  if (state.LargestWallGlideMm > 0)
  {
    std::printf("chest wall: glided along it by at most %.1f mm, left it by at most %.2f mm\n",
      state.LargestWallGlideMm, state.LargestWallLiftMm);
  }
  if (state.StiffnessFactor != 1)
  {
    std::printf("%s\n", StiffnessNote(state.StiffnessFactor).c_str());
  }
  PrintInvertedCells(result);
}

/// Runs the case; of plates without an equilibrium it says where they might stand better.
CompressionCaseResult Compress(const CompressionCase& input)
{
  // Plates at the very front of fixed tissue pinch what is between: less than this off it, mm.
  constexpr double CloseToFixedMm = 2;
  try
  {
    return RunCompressionCase(input, MakeProgressBar());
  }
  catch (const CompressionError& error)
  {
    if (input.Loading.ChestWall == ChestWallMode::Fixed && input.Pose.AnteriorMm < CloseToFixedMm)
    {
      throw ConvergenceError(std::string(error.what()) +
        "; the plates stand at the fixed tissue and pinch what is between: --anterior 5 moves them "
        "off");
    }
    throw;
  }
}

void Run(CompressArguments& arguments)
{
  CompressionCase& input = arguments.Case;
  Program().ApplyTo(input.Labels);
  if (!arguments.ThicknessMm && !input.ForceN)
  {
    throw CLI::RequiredError("--thickness or --force");
  }
  CheckOutputs(arguments);
  if (arguments.ThicknessMm && !Program().AcceptUnusual)
  {
    CheckValidRange(ValidRanges::Thickness, *arguments.ThicknessMm, "ThicknessMm");
  }
  input.Pose.ThicknessMm = arguments.ThicknessMm.value_or(input.Pose.ThicknessMm);
  input.SeriesSteps = arguments.Series.empty() ? 0 : arguments.SeriesSteps;
  const CompressionCaseResult result = Compress(input);
  if (!arguments.Series.empty())
  {
    WriteSeries(arguments.Series, result.Series);
  }
  WriteMesh(result.Compressed, arguments.Output);
  if (!arguments.Picture.empty())
  {
    WriteCompressionPicture(result, arguments.Picture);
  }
  PrintSummary(result);
}
}

void AddCompressCommand(CLI::App& application)
{
  AddCommand<CompressArguments>(application, "compress",
    "Squeezes a breast between the plates of a mammography unit.\nIn and out in the frame of the "
    "mesh, mm; the chest wall (fixed materials) does not move, unless the breast may glide along "
    "it.",
    "compress --mesh breast.vtu --materials victre --orientation ALS --thickness 50 "
    "--anterior 5 -o compressed.vtu",
    Declare, Run);
}
}
