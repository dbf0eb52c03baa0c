// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Case/CompressedBreast.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MeshVoxels.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/BreastMechanics.h"
#include "mammoray/Registration/SimulationLead.h"
#include "mammoray/Report/CutPicture.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SimulationMesh.h"
#endif

#include "vtkCellData.h"
#include "vtkUnstructuredGrid.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>

namespace mammoray
{
namespace
{
/// Cells beyond this take minutes and gigabytes.
std::size_t MostSimulationCells(ElementType element)
{
  return element == ElementType::Quadratic ? 20000 : 150000;
}

const std::map<std::string, ElementType> Elements{ { "quadratic", ElementType::Quadratic },
  { "linear", ElementType::PatchAveragedLinear } };

struct CompressArguments
{
  std::string Mesh;
  std::string Materials;
  std::string Orientation = "LPS";
  std::string SimulationMesh;
  double SimulationCellSizeMm = 0;
  /// One of Elements.
  std::string Element = "quadratic";
  LabelSource Labels;
  BreastPose Pose;
  /// Standard view, whose roll is added; empty: none.
  std::string View;
  std::string Side;
  /// In place of the thickness; 0: not given.
  double ForceN = 0;
  MammographyUnit Unit;
  /// held, sliding or elastic
  std::string ChestWall = "held";
  WallStiffness Wall = CompressionOptions().Wall;
  double PullN = 0;
  double Friction = 0;
  /// none, prone or supine
  std::string ImagePosition = "none";
  bool Gravity = false;
  std::string Output;
  std::string Picture;
  /// Time series; empty: none.
  std::string Series;
  int SeriesSteps = 11;
  bool Overwrite = false;
};

bool IsSimulatedOn(const TetrahedralMesh& mesh, const CompressArguments& arguments)
{
  return arguments.SimulationMesh.empty() &&
    mesh.NumberOfCells() <= MostSimulationCells(Elements.at(arguments.Element));
}

/// Where stiffness is sampled: the labels given, or the voxels of a mesh that another one carries.
std::optional<LabelVolume> FindMaterials(const CompressArguments& arguments,
  const MaterialTable& table, const TetrahedralMesh& mesh)
{
  if (!arguments.Labels.Path.empty())
  {
    return ReadMaterials(arguments.Labels, table);
  }
  if (!IsSimulatedOn(mesh, arguments))
  {
    return Voxelize(mesh, BreastMechanicsOptions::VoxelMm);
  }
  return {};
}

/// The mesh to simulate on: the one named, the input when it is coarse enough, or one made of the
/// materials' volume.
TetrahedralMesh FindSimulationMesh(const CompressArguments& arguments, const TetrahedralMesh& mesh,
  const std::optional<LabelVolume>& volume, const std::vector<bool>& held)
{
  if (!arguments.SimulationMesh.empty())
  {
    return FromGrid(ReadMesh(arguments.SimulationMesh));
  }
  if (IsSimulatedOn(mesh, arguments))
  {
    return mesh;
  }
#ifdef MAMMORAY_HAS_MESHING
  if (volume)
  {
    return MeshForSimulation(*volume, held, arguments.SimulationCellSizeMm, MakeProgressBar()).Mesh;
  }
#else
  (void)volume;
  (void)held;
#endif
  throw InputError(arguments.Mesh + ": expected at most " +
    std::to_string(MostSimulationCells(Elements.at(arguments.Element))) +
    " cells to simulate on, found " + std::to_string(mesh.NumberOfCells()) +
    "; name a coarse --simulation-mesh");
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
  CompressionOptions options;
  options.Element = Elements.at(arguments.Element);
  options.ChestWall = arguments.ChestWall == "held" ? ChestWallMode::Held
    : arguments.ChestWall == "sliding"              ? ChestWallMode::Sliding
                                                    : ChestWallMode::Elastic;
  options.Wall = arguments.Wall;
  options.PullN = arguments.PullN * axes.Anterior;
  options.Friction = arguments.Friction;
  if (arguments.Gravity || arguments.ImagePosition != "none")
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
    if (arguments.ForceN > 0)
    {
      // 50: any two thicknesses show how the plates close.
      return simulation.CompressToForce(plates(50), PlateMotion(plates(50), plates(49)),
        arguments.ForceN, MakeProgressBar());
    }
    return simulation.Compress(plates(arguments.Pose.ThicknessMm), nullptr, MakeProgressBar());
  }
  catch (const CompressionError& error)
  {
    if (arguments.ChestWall == "held" && arguments.Pose.AnteriorMm < CloseToHeldMm)
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
  const CompressionSimulation& simulation, const CompressedBreast& breast, int stepCount)
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
  CheckOutputFile(arguments.Output, arguments.Overwrite);
  CheckPictureFile(arguments.Picture, arguments.Overwrite);
  if (std::filesystem::path(arguments.Output).extension() != ".vtu")
  {
    throw InputError(arguments.Output + ": expected the extension .vtu for a volume mesh");
  }
  if (arguments.Series.empty())
  {
    return;
  }
  CheckOutputFile(arguments.Series, arguments.Overwrite);
  if (std::filesystem::path(arguments.Series).extension() != ".pvd")
  {
    throw InputError(arguments.Series + ": expected the extension .pvd for a time series");
  }
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

void RunCompress(const CompressArguments& arguments)
{
  CheckInputFile(arguments.Mesh);
  if (!arguments.SimulationMesh.empty())
  {
    CheckInputFile(arguments.SimulationMesh);
  }
  CheckOutputs(arguments);
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(arguments.Orientation);
  const MaterialTable table = FindMaterialTable(arguments.Materials);
  const ElasticTable mechanics(table);
  const std::vector<bool>& held = mechanics.Held;
  const vtkSmartPointer<vtkUnstructuredGrid> grid = ReadMesh(arguments.Mesh);
  const TetrahedralMesh mesh = FromGrid(grid);
  mesh.Validate(arguments.Mesh);
  const std::optional<LabelVolume> volume = FindMaterials(arguments, table, mesh);
  const TetrahedralMesh simulationMesh = FindSimulationMesh(arguments, mesh, volume, held);
  MaterialField field;
  if (volume)
  {
    field = [&volume](const Vector3& point) { return static_cast<int>(volume->LabelAt(point)); };
  }
  const CompressionOptions loading = LoadingOf(arguments, axes);
  CompressionSimulation simulation(simulationMesh, mechanics.Elastic, held, field, loading);
  if (arguments.ImagePosition == "none")
  {
    LeadIfLarge(simulation, simulationMesh, mechanics, loading, MakeProgressBar());
  }
  else
  {
    simulation.Unload(GravityIn(arguments.ImagePosition == "prone" ? PatientPosition::Prone
                                                                   : PatientPosition::Supine,
                        axes),
      MakeProgressBar());
  }
  const Vector3 anchor = arguments.Labels.Path.empty() ? FindPoseAnchor(mesh, held, axes)
                                                       : FindPoseAnchor(*volume, held, axes);
  const CompressionState state = Compress(arguments, simulation, axes, anchor);
  const double thicknessMm =
    arguments.ForceN > 0 ? GapMm(state.Plates) : arguments.Pose.ThicknessMm;
  const CompressedBreast breast(grid, mesh, simulation);
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
  PrintSummary(state, simulation, simulationMesh.NumberOfCells(), thicknessMm);
  const std::size_t inverted = CompressedBreast::NumberOfInvertedCells(compressed);
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
  CLI::App* command = application.add_subcommand("compress",
    "Squeezes a breast between the plates of a mammography unit.\nIn and out in the frame of the "
    "mesh, mm; "
    "the chest wall (held materials) does not move, unless the breast may glide along it.");
  auto arguments = std::make_shared<CompressArguments>();
  BreastPose& pose = arguments->Pose;
  MammographyUnit& unit = arguments->Unit;
  command->add_option("--mesh", arguments->Mesh, "linear tetrahedra with materials (.vtu)")
    ->required();
  AddMaterialsOption(*command, arguments->Materials)->required();
  command
    ->add_option("--orientation", arguments->Orientation,
      "directions of +x, +y, +z: one letter each of L/R, A/P, S/I")
    ->capture_default_str();
  CLI::Option* thickness =
    command->add_option("--thickness", pose.ThicknessMm, "distance of the plates' faces, mm")
      ->check(PositiveNumber());
  CLI::Option* force = command
                         ->add_option("--force", arguments->ForceN,
                           "force of the paddle, N, in place of the thickness; 50 to 150 are usual")
                         ->check(PositiveNumber())
                         ->excludes(thickness);
  command->add_option("-o,--output", arguments->Output, "compressed mesh to write (.vtu)")
    ->required();
  const auto add = [&](const char* name, double& value, const char* help)
  { return command->add_option(name, value, help)->capture_default_str(); };
  add("--roll", pose.RollDeg,
    "turn of the unit about the anterior axis from --view or CC, degrees; positive to the left");
  CLI::Option* view = command
                        ->add_option("--view", arguments->View,
                          "CC, or turned by 45 (MLO, LMO) or 90 degrees (ML, LM)")
                        ->check(CLI::IsMember({ "CC", "MLO", "LMO", "ML", "LM" }));
  command->add_option("--side", arguments->Side, "the breast, L or R: which way --view turns")
    ->check(CLI::IsMember({ "L", "R" }))
    ->needs(view);
  add("--pitch", pose.PitchDeg,
    "turn of the rolled unit about its lateral axis, degrees; positive takes the source forwards");
  add("--yaw", pose.YawDeg,
    "turn of the unit about its vertical axis, degrees; positive to the left (CC)");
  add("--tilt", pose.TiltDeg,
    "turn of the paddle about its chest-wall edge, degrees; positive opens it towards the nipple")
    ->check(NumberFrom(-30.0, 30.0));
  add("--lateral", pose.LateralMm, "shift of the receptor along its chest-wall edge, mm");
  add("--anterior", pose.AnteriorMm, "shift of the receptor away from the chest wall, mm");
  add("--vertical", pose.VerticalMm, "shift of the plates' mid-plane towards the source, mm");
  add("--support-edge", unit.SupportEdgeMm,
    "chest-wall edge of the support, mm in front of the receptor's");
  add("--paddle-edge", unit.PaddleEdgeMm,
    "chest-wall edge of the paddle, mm in front of the receptor's");
  add("--edge-radius", unit.EdgeRadiusMm, "radius of the plates' chest-wall edges, mm")
    ->check(NonNegativeNumber());
  command
    ->add_option("--chest-wall", arguments->ChestWall,
      "how the breast is attached to the held materials: held, sliding along their surface, or "
      "elastic")
    ->check(CLI::IsMember({ "held", "sliding", "elastic" }))
    ->capture_default_str();
  add("--wall-normal-stiffness", arguments->Wall.Normal,
    "of the sliding or elastic chest wall against being left, kPa/mm")
    ->check(PositiveNumber());
  add("--wall-tangential-stiffness", arguments->Wall.Tangential,
    "of the elastic chest wall against gliding, kPa/mm")
    ->check(NonNegativeNumber());
  add("--pull", arguments->PullN,
    "force that draws the breast forwards onto the receptor, spread over its volume, N");
  add("--friction", arguments->Friction, "coefficient of friction between breast and plates")
    ->check(NonNegativeNumber());
  command
    ->add_option("--mri-position", arguments->ImagePosition,
      "how the patient lay in the image of the mesh: from prone or supine the breast is unloaded "
      "of its weight and compressed under that of the standing patient; none: no weight")
    ->check(CLI::IsMember({ "none", "prone", "supine" }))
    ->capture_default_str();
  command->add_flag("--gravity", arguments->Gravity,
    "the weight of the standing patient counts, though the mesh is taken for free of load");
  command->add_option("--picture", arguments->Picture,
    "draw cuts through the breast before and after, with the plates (.png)");
  command->add_option("--series", arguments->Series,
    "time series of the compression, for ParaView: a .pvd file, with its .vtu files beside it");
  command
    ->add_option("--series-steps", arguments->SeriesSteps,
      "of the series, from plates that touch nothing to the compressed breast")
    ->check(NumberFrom(2, 1000))
    ->capture_default_str();
  CLI::Option* labels = AddLabelOptions(*command, arguments->Labels);
  labels->description("stiffness is sampled from it; the " + labels->get_description());
  command->add_option("--simulation-mesh", arguments->SimulationMesh,
    "coarse mesh (.vtu) to simulate on; the points of --mesh move with it");
  add("--simulation-cell-size", arguments->SimulationCellSizeMm,
    "largest cells of the simulation mesh that is made for a large mesh, of --labels or else of "
    "the mesh itself, mm; 0: by the size of the breast, 3000 to 4000 cells")
    ->check(NonNegativeNumber());
  command
    ->add_option("--element", arguments->Element,
      "of the simulation: quadratic tetrahedra, or linear ones that share their volume in patches; "
      "linear takes a tenth of the time and needs three times as many cells a side")
    ->check(CLI::IsMember({ "quadratic", "linear" }))
    ->capture_default_str();
  command->add_flag("--overwrite", arguments->Overwrite, "replace the output files");
  AddConfigurationOptions(*command);
  command->callback(
    [arguments, thickness, force]
    {
      if (thickness->count() + force->count() == 0)
      {
        throw CLI::RequiredError("--thickness or --force");
      }
      RunCompress(*arguments);
    });
}
}
