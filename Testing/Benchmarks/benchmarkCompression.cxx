// SPDX-License-Identifier: Apache-2.0
// Times the compression of a breast of some thousand quadratic tetrahedra to half its thickness,
// the step from one state to the next, the sensitivities and the embedding; compares force and
// displacements with a fine mesh. Prints a table in Markdown, writes JSON.
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
  std::vector<int> Counts{ 10, 12, 14, 16 };
  int Reference = 18;
  int Rounds = 3;
  std::string Output;
};

double Seconds(const std::function<void()>& run)
{
  const auto begin = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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

CompressionSimulation MakeSimulation(const std::array<int, 3>& bricks)
{
  TetrahedralMesh mesh =
    test::MakeHalfEllipsoidMesh(HalfAxes[0], HalfAxes[1], HalfAxes[2], bricks, false);
  // Cells come brick by brick, x fastest; the chest wall is the first fifth of the layers in y.
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    const auto layer = static_cast<int>(cell / 6 / bricks[0] % bricks[1]);
    mesh.Materials[cell] = layer * Layers < bricks[1] ? 2 : 1;
  }
  return CompressionSimulation(mesh, { {}, { 5, 0.49 }, { 5, 0.49 }, { 15, 0.49 } },
    { false, false, true, false },
    [](const Vector3& x)
    { return std::hypot(x[0] / 25, (x[1] - 25) / 18, x[2] / 20) < 1 ? 3 : 1; });
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

Measured Measure(const std::array<int, 3>& bricks, int rounds)
{
  Measured result;
  ForgetPeak();
  double setUp = 0;
  std::unique_ptr<CompressionSimulation> simulation;
  setUp =
    Seconds([&] { simulation = std::make_unique<CompressionSimulation>(MakeSimulation(bricks)); });
  const double cold =
    Seconds([&] { result.State = simulation->Compress(MakePlates(HalfThicknessMm)); });
  // Least of some rounds: whatever else the machine does only adds.
  double warm = 1e9, sensitivities = 1e9;
  int warmSteps = 0;
  const MaterialVelocity ratio{ {}, {}, {}, { 5, 0, 0 } };
  for (int round = 0; round < rounds; ++round)
  {
    CompressionState next;
    warm = std::min(warm,
      Seconds(
        [&] { next = simulation->Compress(MakePlates(HalfThicknessMm + 1), &result.State); }));
    warmSteps = next.NewtonSteps;
    sensitivities = std::min(sensitivities,
      Seconds([&] { simulation->Sensitivities(next, MakeVelocities(), { ratio }); }));
  }
  const Embedding embedding(*simulation, MakePoints(12));
  result.Points = embedding.Map(result.State.Positions);
  result.Row = { { "cells", 6 * bricks[0] * bricks[1] * bricks[2] },
    { "unknowns", simulation->NumberOfUnknowns() }, { "set_up_s", setUp }, { "cold_s", cold },
    { "cold_newton_steps", result.State.NewtonSteps }, { "warm_s", warm },
    { "warm_newton_steps", warmSteps }, { "sensitivities_s", sensitivities },
    { "peak_memory_mib", PeakMemoryMiB() }, { "paddle_force_n", result.State.PaddleForceN },
    { "smallest_j", result.State.SmallestJ } };
  return result;
}

/// Times of the embedding of about a million points.
Json MeasureEmbedding(const Arguments& arguments)
{
  const CompressionSimulation simulation =
    MakeSimulation({ arguments.Counts.front(), Layers, arguments.Counts.front() });
  const std::vector<double> points = MakePoints(125);
  std::unique_ptr<Embedding> embedding;
  const double setUp =
    Seconds([&] { embedding = std::make_unique<Embedding>(simulation, points); });
  double map = 1e9;
  for (int round = 0; round < 2 + 4 * arguments.Rounds; ++round)
  {
    map = std::min(map, Seconds([&] { embedding->Map(simulation.RestPositions()); }));
  }
  return { { "points", points.size() / 3 }, { "set_up_s", setUp }, { "map_s", map } };
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
  std::printf("| %.0f | %.0f | %.2f | %.2f (%.0f) | %.2f (%.0f) | %.0f %% | %.0f | %.2f ",
    value("cells"), value("unknowns"), value("set_up_s"), value("cold_s"),
    value("cold_newton_steps"), value("warm_s"), value("warm_newton_steps"),
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
    "| quadratic tetrahedra | unknowns | set-up, s | cold, s (Newton steps) | warm 1 mm, s "
    "(Newton steps) | 6 sensitivities / warm | peak, MiB | force, N | force error | "
    "displacement error, median (largest), mm |\n|---|---|---|---|---|---|---|---|---|---|"
    "\n");
  // The fine mesh first, so that rows can be printed as they come.
  const Measured reference = Measure({ arguments.Reference, 2 * Layers, arguments.Reference }, 1);
  Json file = { { "commit", MAMMORAY_COMMIT }, { "rows", Json::array() } };
  for (const int count : arguments.Counts)
  {
    Measured measured = Measure({ count, Layers, count }, arguments.Rounds);
    Compare(measured, reference);
    Print(measured.Row);
    std::fflush(stdout);
    file["rows"].push_back(measured.Row);
  }
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
  application
    .add_option("--counts", arguments.Counts,
      "bricks across the breast; 30 tetrahedra each squared")
    ->check(CLI::Range(4, 40))
    ->capture_default_str();
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
