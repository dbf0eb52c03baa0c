// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Case/CompressionGrids.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Report/CutPicture.h"

#include "vtkCellData.h"
#include "vtkUnstructuredGrid.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>
#include <utility>

namespace mammoray
{
namespace
{
struct CompressArguments
{
  std::string Mesh;
  std::string Materials;
  std::string Orientation = "LPS";
  std::string SimulationMesh;
  double SimulationCellSizeMm = 0;
  LabelSource Labels;
  BreastPose Pose;
  /// One of the two.
  std::optional<double> ThicknessMm;
  std::optional<double> ForceN;
  /// Standard view, whose roll is added; empty: none.
  std::string View;
  std::string Side;
  MammographyUnit Unit;
  /// Element, chest wall and friction; the rest depends on the axes.
  CompressionOptions Loading;
  double PullN = 0;
  /// How the patient lay in the image; none: its shape is free of load.
  std::optional<PatientPosition> ImagePosition;
  bool Gravity = false;
  std::string Output;
  std::string Picture;
  /// Time series; empty: none.
  std::string Series;
  int SeriesSteps = 11;
  bool Overwrite = false;
};

/// What is compressed, and what is simulated on.
void DeclareMeshes(const OptionList& add, CompressArguments& arguments)
{
  add("--mesh", arguments.Mesh, "linear tetrahedra with materials (.vtu)")->required();
  AddMaterialsOption(add, arguments.Materials)->required();
  AddOrientationOption(add, arguments.Orientation, "the mesh");
  CLI::Option* labels = AddLabelOptions(add, arguments.Labels);
  labels->description("stiffness is sampled from it; the " + labels->get_description());
  add("--simulation-mesh", arguments.SimulationMesh,
    "coarse mesh (.vtu) to simulate on; the points of --mesh move with it");
  add("--simulation-cell-size", arguments.SimulationCellSizeMm, NonNegative("mm"),
    "largest cells of the simulation mesh that is made for a large mesh, of --labels or else of "
    "the mesh itself; 0: by the size of the breast, 3000 to 4000 cells");
  add.Choice<ElementType>("--element", arguments.Loading.Element,
    { { "quadratic", ElementType::Quadratic }, { "linear", ElementType::PatchAveragedLinear } },
    "of the simulation: quadratic tetrahedra, or linear ones that share their volume in patches; "
    "linear takes a tenth of the time and needs three times as many cells a side");
}

/// How the unit stands and closes.
void DeclareUnit(const OptionList& add, CompressArguments& arguments)
{
  CLI::Option* thickness =
    AddPoseOption(add, PoseParameters[ThicknessParameter], arguments.ThicknessMm);
  add("--force", arguments.ForceN, Positive("N"),
    "force of the paddle, in place of the thickness; 50 to 150 are usual")
    ->excludes(thickness);
  CLI::Option* view = add.Word("--view", arguments.View, { "CC", "MLO", "LMO", "ML", "LM" },
    "CC, or turned by 45 (MLO, LMO) or 90 degrees (ML, LM); --roll is added");
  add.Word("--side", arguments.Side, { "L", "R" }, "the breast: which way --view turns")
    ->needs(view);
  AddPoseOptions(add, arguments.Pose);
  AddPlateOptions(add, arguments.Unit.SupportEdgeMm, arguments.Unit.PaddleEdgeMm,
    arguments.Unit.EdgeRadiusMm);
}

/// What the breast feels beside the plates.
void DeclareLoading(const OptionList& add, CompressArguments& arguments)
{
  CompressionOptions& loading = arguments.Loading;
  add.Choice<ChestWallMode>("--chest-wall", loading.ChestWall,
    { { "held", ChestWallMode::Held }, { "sliding", ChestWallMode::Sliding },
      { "elastic", ChestWallMode::Elastic } },
    "how the breast is attached to the held materials: held, sliding along their surface, or "
    "elastic");
  add("--wall-normal-stiffness", loading.Wall.Normal, Positive("kPa/mm"),
    "of the sliding or elastic chest wall against being left");
  add("--wall-tangential-stiffness", loading.Wall.Tangential, NonNegative("kPa/mm"),
    "of the elastic chest wall against gliding");
  add("--pull", arguments.PullN, "N",
    "force that draws the breast forwards onto the receptor, spread over its volume");
  add("--friction", loading.Friction, NonNegative(),
    "coefficient of friction between breast and plates");
  add.Choice<std::optional<PatientPosition>>("--mri-position", arguments.ImagePosition,
    { { "none", std::nullopt }, { "prone", PatientPosition::Prone },
      { "supine", PatientPosition::Supine } },
    "how the patient lay in the image of the mesh: from prone or supine the breast is unloaded of "
    "its weight and compressed under that of the standing patient; none: no weight");
  add.Flag("--gravity", arguments.Gravity,
    "the weight of the standing patient counts, though the mesh is taken for free of load");
}

void Declare(const OptionList& add, CompressArguments& arguments)
{
  DeclareMeshes(add, arguments);
  DeclareUnit(add, arguments);
  DeclareLoading(add, arguments);
  add("-o,--output", arguments.Output, "compressed mesh to write (.vtu)")->required();
  add("--picture", arguments.Picture,
    "draw cuts through the breast before and after, with the plates (.png)");
  add("--series", arguments.Series,
    "time series of the compression, for ParaView: a .pvd file, with its .vtu files beside it");
  add("--series-steps", arguments.SeriesSteps, Between(2, 1000),
    "of the series, from plates that touch nothing to the compressed breast");
  AddOverwriteFlag(add, arguments.Overwrite, "the output files");
}

/// Roll of a standard view, degrees; 0 where none is given.
double RollOfView(const CompressArguments& arguments)
{
  if (arguments.View.empty())
  {
    return 0;
  }
  Mammogram mammogram;
  mammogram.View = arguments.View;
  mammogram.Laterality = arguments.Side.empty() ? '?' : arguments.Side.front();
  const std::optional<double> roll = NominalRollDeg(mammogram);
  if (!roll)
  {
    throw InputError("--view " + arguments.View + ": expected --side L or R beside it");
  }
  return *roll;
}

CompressionOptions LoadingOf(const CompressArguments& arguments, const AnatomicalAxes& axes)
{
  CompressionOptions options = arguments.Loading;
  options.PullN = arguments.PullN * axes.Anterior;
  if (arguments.Gravity || arguments.ImagePosition)
  {
    options.GravityMPerS2 = GravityIn(PatientPosition::Upright, axes);
  }
  return options;
}

BreastPose PoseAt(const CompressArguments& arguments, double thicknessMm)
{
  BreastPose pose = arguments.Pose;
  pose.RollDeg += RollOfView(arguments);
  pose.ThicknessMm = thicknessMm;
  return pose;
}

/// Plates at the very front of held tissue pinch what is between: less than this off it, mm.
constexpr double CloseToHeldMm = 2;

CompressionState Compress(const CompressArguments& arguments,
  const CompressionSimulation& simulation, const AnatomicalAxes& axes, const Vector3& anchor)
{
  const auto plates = [&](double thicknessMm)
  {
    const BreastPose pose = PoseAt(arguments, thicknessMm);
    return PlatesOf(PlaceUnit(axes, anchor, arguments.Unit, pose), arguments.Unit, thicknessMm,
      pose.TiltDeg);
  };
  try
  {
    if (arguments.ForceN)
    {
      // 50: any two thicknesses show how the plates close.
      return simulation.CompressToForce(plates(50), PlateMotion(plates(50), plates(49)),
        *arguments.ForceN, MakeProgressBar());
    }
    return simulation.Compress(plates(*arguments.ThicknessMm), nullptr, MakeProgressBar());
  }
  catch (const CompressionError& error)
  {
    if (arguments.Loading.ChestWall == ChestWallMode::Held &&
      arguments.Pose.AnteriorMm < CloseToHeldMm)
    {
      throw ConvergenceError(std::string(error.what()) +
        "; the plates stand at the held tissue and pinch what is between: --anterior 5 moves them "
        "off");
    }
    throw;
  }
}

/// The breast from open plates to those of `closed`, which it ends with.
std::vector<vtkSmartPointer<vtkUnstructuredGrid>> SeriesOf(const CompressionState& closed,
  const CompressionSimulation& simulation, const CompressionGrids& breast, int stepCount)
{
  const PlatePair open = simulation.OpenedPlates(closed.Plates);
  const PlatePairVelocity closing = PlateMotion(open, closed.Plates);
  const ProgressCallback bar = MakeProgressBar();
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> grids;
  CompressionState state;
  for (int step = 0; step + 1 < stepCount; ++step)
  {
    const double time = TimeOf(step, stepCount);
    const ProgressCallback progress = [&](double fraction, const char*)
    { return bar((step + fraction) / stepCount, "series"); };
    state =
      simulation.Compress(MovedPlates(open, closing, time), step > 0 ? &state : nullptr, progress);
    grids.push_back(breast.At(state));
  }
  grids.push_back(breast.At(closed));
  return grids;
}

/// The plate in the plane through its edge's reference point and normal to that edge.
std::vector<Vector3> OutlineOf(const Plate& plate)
{
  constexpr double DepthMm = 300;
  constexpr double BackMm = 30;
  constexpr int ArcSteps = 12;
  const double radius = plate.EdgeRadiusMm;
  const Vector3 centre = plate.Edge + radius * plate.Inward - radius * plate.Normal;
  std::vector<Vector3> line{ plate.Edge + DepthMm * plate.Inward };
  for (int step = 0; step <= ArcSteps; ++step)
  {
    const double angle = 0.5 * std::numbers::pi * step / ArcSteps;
    line.push_back(
      centre + radius * (std::cos(angle) * plate.Normal - std::sin(angle) * plate.Inward));
  }
  line.push_back(plate.Edge - BackMm * plate.Normal);
  return line;
}

/// From the side before and after, with the plates, and after from the front.
void WritePicture(const std::string& path, vtkUnstructuredGrid* before, vtkUnstructuredGrid* after,
  const PlatePair& plates, const Vector3& lateral, const MaterialTable& table)
{
  Vector3 middle;
  after->GetCenter(middle.data());
  const Vector3& up = plates.Support.Normal;
  const Vector3& forward = plates.Support.Inward;
  Vector3 restMiddle;
  before->GetCenter(restMiddle.data());
  char thickness[64];
  std::snprintf(thickness, sizeof thickness, "compressed to %.1f mm", GapMm(plates));
  const std::vector<CutPanel> panels{ { before, restMiddle, forward, up, "uncompressed", {} },
    { after, middle, forward, up, thickness,
      { OutlineOf(plates.Support), OutlineOf(plates.Paddle) } },
    { after, middle, lateral, up, "from the front", {} } };
  WriteComplete(path,
    [&](const std::string& temporary) { WriteCutPicture(panels, table.Names(), temporary); });
}

void CheckOutputs(const CompressArguments& arguments)
{
  CheckOutputFile(arguments.Output, arguments.Overwrite, ".vtu", "a volume mesh");
  CheckPictureFile(arguments.Picture, arguments.Overwrite);
  if (arguments.Series.empty())
  {
    return;
  }
  CheckOutputFile(arguments.Series, arguments.Overwrite, ".pvd", "a time series");
  for (const std::string& file :
    SeriesFiles(arguments.Series, static_cast<std::size_t>(arguments.SeriesSteps)))
  {
    CheckOutputFile(file, arguments.Overwrite);
    if (std::filesystem::weakly_canonical(file) ==
      std::filesystem::weakly_canonical(arguments.Output))
    {
      throw InputError(
        "--series " + arguments.Series + ": its file " + file + " is the output file too");
    }
  }
}

void PrintSummary(const CompressionState& state, const CompressionSimulation& simulation,
  std::size_t simulationCells, double thicknessMm)
{
  std::printf("%zu simulation cells, %zu unknowns, %d load steps, %d Newton steps, %.1f s, at most "
              "%.0f MiB to factorise\n",
    simulationCells, simulation.NumberOfUnknowns(), state.LoadSteps, state.NewtonSteps,
    state.Seconds, state.FactorMiB);
  std::printf(
    "thickness %.2f mm, paddle %.2f N, support %.2f N, penetration at most %.3f mm, volume x %.4f, "
    "J %.3f to %.3f\n",
    thicknessMm, state.PaddleForceN, state.SupportForceN, state.LargestPenetrationMm,
    state.VolumeRatio, state.SmallestJ, state.LargestJ);
  if (state.LargestWallGlideMm > 0)
  {
    std::printf("chest wall: glided along it by at most %.1f mm, left it by at most %.2f mm\n",
      state.LargestWallGlideMm, state.LargestWallLiftMm);
  }
}

void Run(CompressArguments& arguments)
{
  if (!arguments.ThicknessMm && !arguments.ForceN)
  {
    throw CLI::RequiredError("--thickness or --force");
  }
  CheckInputFile(arguments.Mesh);
  CheckInputFileIfAny(arguments.SimulationMesh);
  CheckOutputs(arguments);
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(arguments.Orientation);
  const MaterialTable table = FindMaterialTable(arguments.Materials);
  const ElasticTable mechanics(table);
  const std::vector<bool>& held = mechanics.Held;
  const vtkSmartPointer<vtkUnstructuredGrid> grid = ReadMesh(arguments.Mesh);
  const TetrahedralMesh mesh = FromGrid(grid);
  mesh.Validate(arguments.Mesh);
  BreastModelOptions options;
  options.CellSizeMm = arguments.SimulationCellSizeMm;
  options.Compression = LoadingOf(arguments, axes);
  Vector3 anchor = FindPoseAnchor(mesh, held, axes);
  if (!arguments.Labels.Path.empty())
  {
    options.Volume = ReadMaterials(arguments.Labels, table);
    anchor = FindPoseAnchor(*options.Volume, held, axes);
  }
  if (!arguments.SimulationMesh.empty())
  {
    options.SimulationMesh = FromGrid(ReadMesh(arguments.SimulationMesh));
  }
  if (arguments.ImagePosition)
  {
    options.ImageGravityMPerS2 = GravityIn(*arguments.ImagePosition, axes);
  }
  BreastModel model(mesh, mechanics, {}, std::move(options), MakeProgressBar());
  CompressionSimulation& simulation = model.Body().Simulation();
  const CompressionState state = Compress(arguments, simulation, axes, anchor);
  const double thicknessMm = arguments.ThicknessMm.value_or(GapMm(state.Plates));
  const CompressionGrids breast(grid, mesh, simulation);
  const auto compressed = breast.At(state, thicknessMm);
  const VolumeFromGantry placed =
    PlaceUnit(axes, anchor, arguments.Unit, PoseAt(arguments, thicknessMm));
  AddPlacement(compressed, placed);
  if (!arguments.Series.empty())
  {
    const auto series = SeriesOf(state, simulation, breast, arguments.SeriesSteps);
    for (const auto& step : series)
    {
      AddPlacement(step, placed);
    }
    WriteSeries(arguments.Series, series);
  }
  WriteComplete(arguments.Output,
    [&](const std::string& temporary) { WriteMesh(compressed, temporary); });
  if (!arguments.Picture.empty())
  {
    WritePicture(arguments.Picture, grid, compressed, state.Plates, placed.X, table);
  }
  PrintSummary(state, simulation, model.NumberOfSimulationCells(), thicknessMm);
  const std::size_t inverted = CompressionGrids::NumberOfInvertedCells(compressed);
  if (inverted > 0)
  {
    const auto count = static_cast<double>(mesh.NumberOfCells());
    std::printf("%zu of %.0f cells of the mesh (%.2g %%) are turned inside out, the worst to %.2f "
                "of its volume (array J)\n",
      inverted, count, 100 * static_cast<double>(inverted) / count,
      compressed->GetCellData()->GetArray("J")->GetRange()[0]);
  }
}
}

void AddCompressCommand(CLI::App& application)
{
  AddCommand<CompressArguments>(application, "compress",
    "Squeezes a breast between the plates of a mammography unit.\nIn and out in the frame of the "
    "mesh, mm; the chest wall (held materials) does not move, unless the breast may glide along "
    "it.",
    Declare, Run);
}
}
