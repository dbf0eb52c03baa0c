// SPDX-License-Identifier: Apache-2.0
// Times the compression of the FDA's phantom 1 to half its thickness with quadratic and with
// patch-averaged linear tetrahedra, the step from one state to the next, the sensitivities and the
// embedding; compares force and displacements with a fine mesh. Prints a table in Markdown, writes
// JSON. Times are of the clock, and of the processor over all threads: on a busy machine only the
// latter says what the work costs.
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Study/LabelSource.h"

#include <nlohmann/json.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <ctime>

namespace
{
using namespace mammoray;
using Json = nlohmann::ordered_json;

/// Posterior edge of the receptor in front of the held tissue, mm: as far as the registered pose of
/// this phantom.
constexpr double AnteriorMm = 7;
/// Distance of the plates over that at which they touch the breast.
constexpr double Compressed = 0.5;

struct Arguments
{
  std::vector<int> Quadratic{ 2500, 4000, 6000, 8000 };
  std::vector<int> Linear{ 8000, 30000, 100000 };
  int Reference = 20000;
  int Rounds = 3;
  std::string Output;
};

struct Times
{
  double Clock = 1e9;
  double Processor = 1e9;
};

Times Seconds(const std::function<void()>& run)
{
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t beginProcessor = std::clock();
  run();
  return { std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
    static_cast<double>(std::clock() - beginProcessor) / CLOCKS_PER_SEC };
}

/// Least of some rounds: whatever else the machine does only adds.
Times Least(const Times& a, const Times& b)
{
  return { std::min(a.Clock, b.Clock), std::min(a.Processor, b.Processor) };
}

/// Peak memory since the last ForgetPeak, MiB; Linux.
double PeakMemoryMiB()
{
  std::ifstream file("/proc/self/status");
  std::string word;
  while (file >> word)
  {
    if (word == "VmHWM:")
    {
      double kibibytes = 0;
      file >> kibibytes;
      return kibibytes / 1024;
    }
  }
  return 0;
}

void ForgetPeak()
{
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// The FDA's phantom 1 of the data directory, uncompressed.
struct Breast
{
  MaterialTable Table;
  ElasticTable Mechanics;
  LabelVolume Materials;
  AnatomicalAxes Axes = AnatomicalAxes::FromCode("ALS");
  PoseFrame Frame;
  MammographyUnit Unit;
  /// Distance at which the plates touch, mm.
  double OpenMm = 0;
  /// Cells of the mesh of the default size, and that size, mm.
  double Cells = 0;
  double CellSizeMm = 0;

  Breast()
  {
    this->Table = FindMaterialTable("victre");
    this->Mechanics = ElasticTable(this->Table);
    LabelSource source;
    source.Path = DataDirectory() + "/victre-phantom-1/labels.nrrd";
    this->Materials = ReadMaterials(source, this->Table);
    double voxels = 0;
    for (const auto& [material, count] : this->Materials.CountLabels())
    {
      voxels += material == 0 ? 0 : static_cast<double>(count);
    }
    this->CellSizeMm = std::cbrt(voxels * this->Materials.VoxelVolume()) / 7;
    this->Cells = static_cast<double>(this->Mesh(0).NumberOfCells());
    this->Frame = FindPoseFrame(this->Materials, this->Mechanics.Fixed, this->Axes);
    CompressionSimulation simulation = this->Simulate(ElementType::Quadratic, this->Mesh(0));
    this->OpenMm = GapMm(simulation.OpenedPlates(this->Plates(BreastPose().ThicknessMm)));
  }

  /// As many cells, to some per cent where a cell size gives that; 0: as many as registration
  /// takes.
  TetrahedralMesh Mesh(int cells) const
  {
    double size = cells == 0 ? 0 : this->CellSizeMm * std::cbrt(this->Cells / cells);
    TetrahedralMesh mesh;
    for (int attempt = 0; attempt < 6; ++attempt)
    {
      mesh = MeshForSimulation(this->Materials, this->Mechanics.Fixed, size).Mesh;
      const double ratio = cells == 0 ? 1 : static_cast<double>(mesh.NumberOfCells()) / cells;
      if (std::abs(ratio - 1) < 0.05)
      {
        break;
      }
      size *= std::cbrt(ratio);
    }
    return mesh;
  }

  static CompressionOptions OptionsOf(ElementType element)
  {
    CompressionOptions options;
    options.Element = element;
    return options;
  }

  CompressionSimulation Simulate(ElementType element, const TetrahedralMesh& mesh) const
  {
    return CompressionSimulation(
      mesh, this->Mechanics.Elastic, this->Mechanics.Fixed,
      [this](const Vector3& point) { return static_cast<int>(this->Materials.LabelAt(point)); },
      OptionsOf(element));
  }

  VolumeFromGantry Placed(double thicknessMm) const
  {
    BreastPose pose;
    pose.ThicknessMm = thicknessMm;
    pose.AnteriorMm = AnteriorMm;
    return PlaceUnit(this->Frame, this->Unit, pose);
  }

  PlatePair Plates(double thicknessMm) const
  {
    return PlatesOf(this->Placed(thicknessMm), this->Unit, thicknessMm);
  }

  /// A regular lattice of about `count` points in the tissue that is not fixed.
  std::vector<double> Points(double count) const
  {
    double tissue = 0;
    for (const auto& [material, voxels] : this->Materials.CountLabels())
    {
      tissue += material == 0 || this->Mechanics.Fixed[material] ? 0 : static_cast<double>(voxels);
    }
    const double step = std::cbrt(tissue / count);
    std::vector<double> points;
    for (double k = 0; k < this->Materials.Size[2]; k += step)
    {
      for (double j = 0; j < this->Materials.Size[1]; j += step)
      {
        for (double i = 0; i < this->Materials.Size[0]; i += step)
        {
          const Vector3 point = this->Materials.PointAt(i, j, k);
          const int material = this->Materials.LabelAt(point);
          if (material != 0 && !this->Mechanics.Fixed[material])
          {
            points.insert(points.end(), point.begin(), point.end());
          }
        }
      }
    }
    return points;
  }

  /// The motions that a registration asks for.
  std::vector<PlatePairVelocity> Velocities() const
  {
    std::vector<PlatePairVelocity> velocities(5);
    const VolumeFromGantry placed = this->Placed(this->OpenMm);
    velocities[0].Paddle.Linear = placed.Z;
    velocities[1].Support.Angular = velocities[1].Paddle.Angular = 0.017 * placed.Y;
    const Vector3 axes[3] = { placed.X, placed.Y, placed.Z };
    for (int axis = 0; axis < 3; ++axis)
    {
      PlatePairVelocity& shift = velocities[2 + axis];
      shift.Support.Linear = shift.Paddle.Linear = axes[axis];
    }
    return velocities;
  }

  /// Of Young's modulus of gland.
  MaterialDerivative Stiffening() const
  {
    MaterialDerivative velocity(this->Table.Materials.size());
    for (std::size_t material = 0; material < velocity.size(); ++material)
    {
      velocity[material].YoungsModulusKPa = this->Table.Materials[material].Name == "gland" ? 1 : 0;
    }
    return velocity;
  }
};

struct Measured
{
  Json Row;
  CompressionState State;
  /// Of Breast::Points(1000), compressed.
  std::vector<double> Points;
};

Measured Measure(const Breast& breast, ElementType element, int cells, int rounds)
{
  Measured result;
  const TetrahedralMesh mesh = breast.Mesh(cells);
  ForgetPeak();
  std::unique_ptr<CompressionSimulation> simulation;
  const Times setUp = Seconds(
    [&]
    {
      simulation = std::make_unique<CompressionSimulation>(breast.Simulate(element, mesh));
      AddColdStartPredictor(*simulation, mesh, breast.Mechanics, Breast::OptionsOf(element));
    });
  const double closedMm = Compressed * breast.OpenMm;
  const Times cold = Seconds([&] { result.State = simulation->Compress(breast.Plates(closedMm)); });
  Times warm, sensitivities;
  int warmSteps = 0;
  for (int round = 0; round < rounds; ++round)
  {
    CompressionState next;
    warm = Least(warm,
      Seconds([&] { next = simulation->Compress(breast.Plates(closedMm + 1), &result.State); }));
    warmSteps = next.NewtonSteps;
    sensitivities = Least(sensitivities,
      Seconds(
        [&] { simulation->Sensitivities(next, breast.Velocities(), { breast.Stiffening() }); }));
  }
  const double peak = PeakMemoryMiB();
  result.Points = Embedding(*simulation, breast.Points(1000)).Map(result.State.Positions);
  result.Row = { { "element", element == ElementType::Quadratic ? "quadratic" : "linear" },
    { "cells", mesh.NumberOfCells() }, { "unknowns", simulation->NumberOfUnknowns() },
    { "set_up_s", setUp.Clock }, { "set_up_processor_s", setUp.Processor },
    { "cold_s", cold.Clock }, { "cold_processor_s", cold.Processor },
    { "cold_newton_steps", result.State.NewtonSteps }, { "warm_s", warm.Clock },
    { "warm_processor_s", warm.Processor }, { "warm_newton_steps", warmSteps },
    { "sensitivities_s", sensitivities.Clock },
    { "sensitivities_processor_s", sensitivities.Processor }, { "peak_memory_mib", peak },
    { "paddle_force_n", result.State.PaddleForceN }, { "smallest_j", result.State.SmallestJ } };
  return result;
}

/// Times of the embedding of about a million points.
Json MeasureEmbedding(const Breast& breast, int rounds)
{
  CompressionSimulation simulation = breast.Simulate(ElementType::Quadratic, breast.Mesh(0));
  const std::vector<double> points = breast.Points(1e6);
  std::unique_ptr<Embedding> embedding;
  const double setUp =
    Seconds([&] { embedding = std::make_unique<Embedding>(simulation, points); }).Clock;
  Times map;
  for (int round = 0; round < 2 + 4 * rounds; ++round)
  {
    map = Least(map, Seconds([&] { embedding->Map(simulation.RestPositions()); }));
  }
  return { { "points", points.size() / 3 }, { "set_up_s", setUp }, { "map_s", map.Clock },
    { "map_processor_s", map.Processor } };
}

void Compare(Measured& measured, const Measured& reference)
{
  std::vector<double> errors;
  for (std::size_t p = 0; p < measured.Points.size(); p += 3)
  {
    errors.push_back(std::hypot(measured.Points[p] - reference.Points[p],
      measured.Points[p + 1] - reference.Points[p + 1],
      measured.Points[p + 2] - reference.Points[p + 2]));
  }
  std::sort(errors.begin(), errors.end());
  measured.Row["force_error"] = measured.State.PaddleForceN / reference.State.PaddleForceN - 1;
  measured.Row["median_displacement_error_mm"] = errors[errors.size() / 2];
  measured.Row["largest_displacement_error_mm"] = errors.back();
}

void Print(const Json& row)
{
  const auto value = [&](const char* key) { return row[key].get<double>(); };
  std::printf(
    "| %s | %.0f | %.0f | %.2f | %.1f (%.1f) | %.0f | %.2f (%.2f) | %.0f | %.0f %% | %.0f | %.2f ",
    row["element"].get<std::string>().c_str(), value("cells"), value("unknowns"), value("set_up_s"),
    value("cold_s"), value("cold_processor_s"), value("cold_newton_steps"), value("warm_s"),
    value("warm_processor_s"), value("warm_newton_steps"),
    100 * value("sensitivities_s") / value("warm_s"), value("peak_memory_mib"),
    value("paddle_force_n"));
  if (row.contains("force_error"))
  {
    std::printf("| %+.1f %% | %.2f (%.2f) |\n", 100 * value("force_error"),
      value("median_displacement_error_mm"), value("largest_displacement_error_mm"));
  }
  else
  {
    std::printf("| reference | reference |\n");
  }
}

void Run(const Arguments& arguments)
{
  const Breast breast;
  std::printf("The FDA's phantom 1 from %.1f to %.1f mm\n\n", breast.OpenMm,
    Compressed * breast.OpenMm);
  std::printf(
    "| tetrahedra | cells | unknowns | set-up, s | cold, s (processor) | Newton steps | warm 1 mm, "
    "s (processor) | Newton steps | 6 sensitivities / warm | peak, MiB | force, N | force error | "
    "displacement error, median (largest), mm |\n|---|---|---|---|---|---|---|---|---|---|---|---|"
    "---|\n");
  // The fine mesh first, so that rows can be printed as they come.
  const Measured reference = Measure(breast, ElementType::Quadratic, arguments.Reference, 1);
  Json file = { { "commit", MAMMORAY_COMMIT }, { "rows", Json::array() } };
  const auto measure = [&](ElementType element, const std::vector<int>& counts)
  {
    for (const int count : counts)
    {
      Measured measured = Measure(breast, element, count, arguments.Rounds);
      Compare(measured, reference);
      Print(measured.Row);
      std::fflush(stdout);
      file["rows"].push_back(measured.Row);
    }
  };
  measure(ElementType::Quadratic, arguments.Quadratic);
  measure(ElementType::PatchAveragedLinear, arguments.Linear);
  Print(reference.Row);
  file["rows"].push_back(reference.Row);
  file["embedding"] = MeasureEmbedding(breast, arguments.Rounds);
  std::printf("\nEmbedding of %.0f points: set up in %.2f s, moved in %.0f ms\n",
    file["embedding"]["points"].get<double>(), file["embedding"]["set_up_s"].get<double>(),
    1e3 * file["embedding"]["map_s"].get<double>());
  if (!arguments.Output.empty())
  {
    std::ofstream output(arguments.Output);
    output << file.dump(2) << "\n";
    if (!output.flush())
    {
      throw InputError(arguments.Output + ": cannot be written");
    }
  }
}
}

int main(int argc, char** argv)
{
  CLI::App application(
    "Times the compression of a breast to half its thickness; Markdown to stdout.");
  Arguments arguments;
  const auto addCounts = [&](const char* name, std::vector<int>& counts, const char* help)
  {
    application.add_option(name, counts, help)
      ->check(CLI::Range(500, 1000000))
      ->expected(0, -1)
      ->capture_default_str();
  };
  addCounts("--quadratic", arguments.Quadratic,
    "meshes of quadratic cells: about how many cells each has");
  addCounts("--linear", arguments.Linear,
    "meshes of patch-averaged linear cells: about how many each has");
  application
    .add_option("--reference", arguments.Reference,
      "about how many quadratic cells the fine mesh has that the others are compared with")
    ->check(CLI::Range(500, 100000))
    ->capture_default_str();
  application
    .add_option("--rounds", arguments.Rounds, "repetitions of which the least time counts")
    ->check(CLI::Range(1, 100))
    ->capture_default_str();
  application.add_option("-o,--output", arguments.Output, "JSON file to write");
  CLI11_PARSE(application, argc, argv);
  try
  {
    Run(arguments);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "benchmarkCompression: %s\n", error.what());
    return 1;
  }
  return 0;
}
