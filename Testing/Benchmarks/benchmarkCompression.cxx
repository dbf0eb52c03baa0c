// SPDX-License-Identifier: Apache-2.0
// Times the compression of a breast to half its thickness with quadratic and with patch-averaged
// linear tetrahedra, the step from one state to the next, the sensitivities and the embedding;
// compares force and displacements with a fine mesh. Prints a table in Markdown, writes JSON. Times
// are of the clock, and of the processor over all threads: on a busy machine only the latter says
// what the work costs.
#include "CompressionSimulation.h"
#include "Error.h"
#include "PlacedPlates.h"
#include "TestMeshes.h"

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

/// Half axes of the breast, mm: lateral, anterior, vertical. A fifth of the depth is chest wall.
constexpr double HalfAxes[3] = { 45, 50, 40 };
constexpr double HalfThicknessMm = 40;
constexpr int Layers = 5;

struct Arguments
{
  std::vector<int> Quadratic{ 10, 12, 14, 16 };
  std::vector<int> Linear{ 10, 20, 34 };
  int Reference = 18;
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

TetrahedralMesh MakeMesh(const std::array<int, 3>& bricks)
{
  // The whole cube has edges where the ball is flat: bricks that turn over on fine meshes.
  constexpr double part = 0.97;
  TetrahedralMesh mesh = test::MakeBoxMesh({ -part, 0, -part }, { part, part, part }, bricks);
  test::MapCubeToBall(mesh, HalfAxes[0] / part, HalfAxes[1] / part, HalfAxes[2] / part);
  // Cells come brick by brick, x fastest; the chest wall is the first fifth of the layers in y.
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const auto layer = static_cast<int>(cell / 6 / bricks[0] % bricks[1]);
    mesh.Materials[cell] = layer * Layers < bricks[1] ? 2 : 1;
  }
  return mesh;
}

CompressionSimulation MakeSimulation(ElementType element, const std::array<int, 3>& bricks)
{
  CompressionOptions options;
  options.Element = element;
  return CompressionSimulation(
    MakeMesh(bricks), { {}, { 5, 0.49 }, { 5, 0.49 }, { 15, 0.49 } }, { false, false, true, false },
    [](const Vector3& x)
    { return std::hypot(x[0] / 25, (x[1] - 25) / 18, x[2] / 20) < 1 ? 3 : 1; },
    options);
}

PlatePair MakePlates(double thicknessMm)
{
  VolumeFromGantry placed;
  placed.Origin = { 0, 22, -0.5 * thicknessMm };
  MammographyUnit unit;
  unit.SupportHeightMm = 0;
  return PlatesOf(placed, unit, thicknessMm);
}

/// `count` points a side of a regular lattice in the breast, in front of the chest wall.
std::vector<double> MakePoints(int count)
{
  std::vector<double> points;
  for (int i = 0; i < count; ++i)
  {
    for (int j = 0; j < count; ++j)
    {
      for (int k = 0; k < count; ++k)
      {
        const double x = 2 * (i + 0.5) / count - 1;
        const double y = 0.2 + 0.8 * (j + 0.5) / count;
        const double z = 2 * (k + 0.5) / count - 1;
        if (x * x + y * y + z * z < 0.95)
        {
          points.insert(points.end(), { HalfAxes[0] * x, HalfAxes[1] * y, HalfAxes[2] * z });
        }
      }
    }
  }
  return points;
}

/// The motions that a registration asks for, and the ratio gland / fat.
std::vector<PlatePairVelocity> MakeVelocities()
{
  std::vector<PlatePairVelocity> velocities(5);
  velocities[0].Paddle.Linear = { 0, 0, 1 };
  velocities[1].Support.Angular = velocities[1].Paddle.Angular = { 0, 0.017, 0 };
  for (int axis = 0; axis < 3; ++axis)
  {
    PlatePairVelocity& shift = velocities[2 + axis];
    shift.Support.Linear[axis] = shift.Paddle.Linear[axis] = 1;
  }
  return velocities;
}

struct Measured
{
  Json Row;
  CompressionState State;
  /// Of the points of MakePoints(12), compressed.
  std::vector<double> Points;
};

/// The bricks of a breast with `count` of them across: quadratic cells in the fewest layers, linear
/// ones in as many as make them nearly cubes.
std::array<int, 3> Bricks(ElementType element, int count)
{
  const int layers = element == ElementType::Quadratic ? Layers : (count + 5) / 10 * Layers;
  return { count, layers, count };
}

Measured Measure(ElementType element, const std::array<int, 3>& bricks, int rounds)
{
  Measured result;
  ForgetPeak();
  std::unique_ptr<CompressionSimulation> simulation;
  const Times setUp = Seconds(
    [&]
    { simulation = std::make_unique<CompressionSimulation>(MakeSimulation(element, bricks)); });
  const Times cold =
    Seconds([&] { result.State = simulation->Compress(MakePlates(HalfThicknessMm)); });
  Times warm, sensitivities;
  int warmSteps = 0;
  const MaterialVelocity ratio{ {}, {}, {}, { 5, 0, 0 } };
  for (int round = 0; round < rounds; ++round)
  {
    CompressionState next;
    warm = Least(warm,
      Seconds(
        [&] { next = simulation->Compress(MakePlates(HalfThicknessMm + 1), &result.State); }));
    warmSteps = next.NewtonSteps;
    sensitivities = Least(sensitivities,
      Seconds([&] { simulation->Sensitivities(next, MakeVelocities(), { ratio }); }));
  }
  const Embedding embedding(*simulation, MakePoints(12));
  result.Points = embedding.Map(result.State.Positions);
  result.Row = { { "element", element == ElementType::Quadratic ? "quadratic" : "linear" },
    { "cells", 6 * bricks[0] * bricks[1] * bricks[2] },
    { "unknowns", simulation->NumberOfUnknowns() }, { "set_up_s", setUp.Clock },
    { "set_up_processor_s", setUp.Processor }, { "cold_s", cold.Clock },
    { "cold_processor_s", cold.Processor }, { "cold_newton_steps", result.State.NewtonSteps },
    { "warm_s", warm.Clock }, { "warm_processor_s", warm.Processor },
    { "warm_newton_steps", warmSteps }, { "sensitivities_s", sensitivities.Clock },
    { "sensitivities_processor_s", sensitivities.Processor },
    { "peak_memory_mib", PeakMemoryMiB() }, { "paddle_force_n", result.State.PaddleForceN },
    { "smallest_j", result.State.SmallestJ } };
  return result;
}

/// Times of the embedding of about a million points.
Json MeasureEmbedding(const Arguments& arguments)
{
  const CompressionSimulation simulation =
    MakeSimulation(ElementType::Quadratic, Bricks(ElementType::Quadratic, arguments.Quadratic.front()));
  const std::vector<double> points = MakePoints(125);
  std::unique_ptr<Embedding> embedding;
  const double setUp =
    Seconds([&] { embedding = std::make_unique<Embedding>(simulation, points); }).Clock;
  Times map;
  for (int round = 0; round < 2 + 4 * arguments.Rounds; ++round)
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
    row["element"].get<std::string>().c_str(), value("cells"), value("unknowns"),
    value("set_up_s"), value("cold_s"), value("cold_processor_s"), value("cold_newton_steps"),
    value("warm_s"), value("warm_processor_s"), value("warm_newton_steps"),
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
  std::printf(
    "| tetrahedra | cells | unknowns | set-up, s | cold, s (processor) | Newton steps | warm 1 mm, "
    "s (processor) | Newton steps | 6 sensitivities / warm | peak, MiB | force, N | force error | "
    "displacement error, median (largest), mm |\n|---|---|---|---|---|---|---|---|---|---|---|---|"
    "---|\n");
  // The fine mesh first, so that rows can be printed as they come.
  const Measured reference = Measure(ElementType::Quadratic,
    { arguments.Reference, 2 * Layers, arguments.Reference }, 1);
  Json file = { { "commit", MAMMORAY_COMMIT }, { "rows", Json::array() } };
  const auto measure = [&](ElementType element, const std::vector<int>& counts)
  {
    for (const int count : counts)
    {
      Measured measured = Measure(element, Bricks(element, count), arguments.Rounds);
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
  file["embedding"] = MeasureEmbedding(arguments);
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
      ->check(CLI::Range(4, 80))
      ->expected(0, -1)
      ->capture_default_str();
  };
  addCounts("--quadratic", arguments.Quadratic,
    "bricks across the breast, of quadratic cells; 30 tetrahedra each squared");
  addCounts("--linear", arguments.Linear,
    "the same of linear cells; about 3 tetrahedra times the cube");
  application
    .add_option("--reference", arguments.Reference,
      "bricks across the fine mesh, which has twice the layers; 18 takes about 1 GiB")
    ->check(CLI::Range(4, 40))
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
