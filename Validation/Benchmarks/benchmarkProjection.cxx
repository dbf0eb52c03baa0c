// SPDX-License-Identifier: Apache-2.0
// Times the projectors on the examples of the published sizes, with Embree as the yardstick in the
// same run, and writes JSON, which projectionTables.py prints and draws. Every case runs in a
// process of its own, so that set-up is cold and peak memory is its own.
#include "Measurements.h"
#include "SceneFile.h"
#include "SurfaceShapes.h"
#include "TextFile.h"
#include "UnitMeasurements.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScratchFolder.h"
#include "mammoray/IO/ShippedExamples.h"

#include <CLI/CLI.hpp>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

namespace
{
using namespace mammoray;
using namespace mammoray::benchmarks;

/// Runs this program anew and waits; throws unless it answers 0.
void RunSelf(std::vector<std::string> words)
{
  words.insert(words.begin(), std::filesystem::read_symlink("/proc/self/exe").string());
  std::vector<char*> pointers;
  for (std::string& word : words)
  {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  pid_t child = 0;
  int status = 0;
  if (posix_spawn(&child, pointers[0], nullptr, nullptr, pointers.data(), environ) != 0 ||
    waitpid(child, &status, 0) != child || status != 0)
  {
    throw Error("benchmark: a case's process failed: " +
      (WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                           : "exit code " + std::to_string(WEXITSTATUS(status))));
  }
}

/// Milliseconds from the begin of a process to its image on disk; the least of three.
double ColdStart(const std::string& scene, const std::string& method, const ScratchFolder& folder)
{
  double least = INFINITY;
  for (int run = 0; run < 3; ++run)
  {
    least = std::min(least,
      Milliseconds(
        [&] {
          RunSelf({ "--once", scene, "--methods", method, "-o", folder.File("once.mha") });
        }));
  }
  return least;
}

Json RunCase(const ExampleScene& scene, const std::string& sceneFile, const std::string& method,
  double budget, const ScratchFolder& folder)
{
  Json row{ { "example", scene.Name }, { "method", method },
    { "triangles", scene.Surface.NumberOfTriangles() }, { "columns", scene.Detector.Columns },
    { "rows", scene.Detector.Rows }, { "materials", scene.Surface.NumberOfMaterials() - 1 } };
  try
  {
    row["coldStartMs"] = ColdStart(sceneFile, method, folder);
    const std::string result = folder.File("case.json");
    std::vector<std::string> words{ "--case", sceneFile, "--methods", method, "--seconds",
      std::to_string(budget), "-o", result };
    if (scene.Name == "breast")
    {
      words.emplace_back("--unit");
    }
    RunSelf(words);
    std::ifstream file(result);
    row.update(Json::parse(file));
  }
  catch (const std::exception& error)
  {
    row["error"] = error.what();
  }
  return row;
}

/// Two nested balls of 2 x 20 x 4^level triangles above a detector.
ExampleScene Balls(int level, int columns, int rows)
{
  ExampleScene scene;
  scene.Name = "balls";
  shapes::AddSphere(scene.Surface, { 0, 0, 60 }, 50, level, 1);
  shapes::AddSphere(scene.Surface, { 5, 3, 60 }, 30, level, 2, 1);
  scene.Source.Position = { 0, 0, 650 };
  scene.Detector.Columns = columns;
  scene.Detector.Rows = rows;
  scene.Detector.ColumnStep = { 120.0 / columns, 0, 0 };
  scene.Detector.RowStep = { 0, 120.0 / rows, 0 };
  scene.Detector.Origin = { -60, -60, 0 };
  return scene;
}

/// Frames per second against resolution, and against triangles, as in the paper's figure 5.
Json SweepRates(const std::string& method, double budget)
{
  const ProjectorOptions::Method projection = MethodFromName(method);
  Json sweep{ { "method", method }, { "resolution", Json::array() },
    { "triangles", Json::array() } };
  for (const int edge : { 75, 150, 300, 600, 1200, 1700 })
  {
    sweep["resolution"].push_back(MeasureRates(Balls(6, edge, edge), projection, budget));
  }
  for (int level = 2; level <= 8; ++level)
  {
    sweep["triangles"].push_back(MeasureRates(Balls(level, 600, 600), projection, budget));
  }
  return sweep;
}

void WriteJson(const Json& value, const std::string& path)
{
  WriteText(value.dump(2) + "\n", path);
}

struct Arguments
{
  std::vector<std::string> Examples = ExampleNames();
  std::vector<std::string> Methods{ "rasterisation", "ray-tracing" };
  double Budget = 8;
  std::string Output;
  bool Rates = false;
  bool Devices = false;
  /// Of the processes that this one starts.
  std::string Case;
  std::string Once;
  bool Unit = false;
};

void RunAll(const Arguments& arguments)
{
  Json report{ { "commit", MAMMORAY_COMMIT }, { "cores", std::thread::hardware_concurrency() },
    { "results", Json::array() }, { "rates", Json::array() } };
  const ScratchFolder folder;
  for (const std::string& name : arguments.Examples)
  {
    const ExampleScene scene = MakeExampleScene(name);
    const std::string sceneFile = folder.File("scene");
    WriteScene(scene, sceneFile);
    for (const std::string& method : arguments.Methods)
    {
      std::fprintf(stderr, "%s, %s ...\n", name.c_str(), method.c_str());
      report["results"].push_back(RunCase(scene, sceneFile, method, arguments.Budget, folder));
    }
  }
  if (arguments.Rates)
  {
    for (const std::string& method : arguments.Methods)
    {
      std::fprintf(stderr, "frames per second, %s ...\n", method.c_str());
      report["rates"].push_back(SweepRates(method, std::min(arguments.Budget, 2.0)));
    }
  }
  WriteJson(report, arguments.Output);
}

/// The Vulkan devices, the most capable one first.
void PrintDevices()
{
  std::string reason;
  Json devices = Json::array();
  for (const DeviceDescription& device : ListDevices(&reason))
  {
    devices.push_back({ { "version", MAMMORAY_VERSION }, { "name", device.Name },
      { "driver", device.Driver }, { "type", device.Type }, { "rayTracing", device.RayTracing } });
  }
  if (devices.empty())
  {
    throw Error(reason);
  }
  std::printf("%s\n", devices.dump().c_str());
}

void Run(const Arguments& arguments)
{
  if (arguments.Devices)
  {
    PrintDevices();
    return;
  }
  if (arguments.Output.empty())
  {
    throw InputError("--output: expected a file, found none");
  }
  const ProjectorOptions::Method method = MethodFromName(arguments.Methods.front());
  if (!arguments.Case.empty())
  {
    Json row = MeasureScene(arguments.Case, method, arguments.Budget);
    if (arguments.Unit)
    {
      row["unit"] = MeasureUnit(ReadScene(arguments.Case), method, arguments.Budget);
    }
    WriteJson(row, arguments.Output);
  }
  else if (!arguments.Once.empty())
  {
    MakeImageOnce(arguments.Once, method, arguments.Output);
  }
  else
  {
    RunAll(arguments);
  }
}
}

int main(int argc, char** argv)
{
  CLI::App application("Times the projectors on examples of four sizes.");
  Arguments arguments;
  application.add_option("--examples", arguments.Examples, "which of them")->capture_default_str();
  application.add_option("--methods", arguments.Methods, "rasterisation, ray-tracing")
    ->capture_default_str();
  application
    .add_option("--seconds", arguments.Budget,
      "no further round of a measurement once so many are spent; 2 rounds at least, 10 at most")
    ->capture_default_str();
  application.add_option("-o,--output", arguments.Output,
    "JSON file to write; projectionTables.py prints it");
  application.add_flag("--rates", arguments.Rates,
    "frames per second against resolution and triangles too");
  application.add_flag("--devices", arguments.Devices, "print the Vulkan devices as JSON instead");
  application.add_option("--case", arguments.Case)->group("");
  application.add_option("--once", arguments.Once)->group("");
  application.add_flag("--unit", arguments.Unit)->group("");
  CLI11_PARSE(application, argc, argv);
  try
  {
    Run(arguments);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "benchmarkProjection: %s\n", error.what());
    return 1;
  }
  return 0;
}
