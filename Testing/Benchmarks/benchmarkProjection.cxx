// SPDX-License-Identifier: Apache-2.0
// Times the projectors on the examples of the published sizes, with Embree as the yardstick in the
// same run; prints tables in Markdown, writes JSON and, with --plot, draws frames per second.
// Every case runs in a process of its own, so that set-up is cold and peak memory is its own.
#include "Measurements.h"
#include "SceneFile.h"
#include "SurfaceShapes.h"
#include "mammoray/Evidence/ExampleData.h"
#include "mammoray/Evidence/ScratchFolder.h"
#include "mammoray/Foundation/Error.h"

#include <CLI/CLI.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <thread>

namespace
{
using namespace mammoray;
using namespace mammoray::benchmarks;
/// Published with the examples (Maul et al. 2021, RTX 2070 Super): seconds per image with set-up
/// and transfer, and rendering only.
struct PublishedTimes
{
  const char* Name;
  double SetUpMs;
  double RenderMs;
};
constexpr PublishedTimes Published[] = { { "test", 310, 0.9 }, { "boxes", 310, 1.4 },
  { "veins", 860, 4.1 }, { "breast", 760, 25 } };

/// Runs this program anew and waits; throws unless it answers 0.
void RunSelf(const std::vector<std::string>& arguments)
{
  std::vector<char*> pointers;
  std::string name = "benchmarkProjection";
  pointers.push_back(name.data());
  std::vector<std::string> copies = arguments;
  for (std::string& argument : copies)
  {
    pointers.push_back(argument.data());
  }
  pointers.push_back(nullptr);
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0)
  {
    execv("/proc/self/exe", pointers.data());
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) ||
    WEXITSTATUS(status) != 0)
  {
    throw Error("benchmark: a case's process failed");
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
    RunSelf({ "--case", sceneFile, "--methods", method, "--seconds", std::to_string(budget), "-o",
      result });
    std::ifstream file(result);
    row.update(Json::parse(file));
  }
  catch (const std::exception& error)
  {
    row["error"] = error.what();
  }
  return row;
}

/// "12.3", or "-" where it was not measured.
std::string Cell(const Json& row, const std::string& key, const char* format)
{
  const Json::json_pointer pointer("/" + key);
  if (!row.contains(pointer))
  {
    return "-";
  }
  char text[32];
  std::snprintf(text, sizeof(text), format, row.at(pointer).get<double>());
  return text;
}

void PrintCases(const Json& rows)
{
  std::printf(
    "\n| example | method | triangles | pixels | frame, ms | Embree, ms | ratio | "
    "largest difference, mm | process to disk, ms | refit / build | bytes / triangle (with "
    "image) | "
    "3 materials / 1 | 100 energies / 1 | 8 derivatives / none | holes seen |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Json& row : rows)
  {
    std::printf("| %s | %s | %d | %dx%d |", row["example"].get<std::string>().c_str(),
      row["method"].get<std::string>().c_str(), row["triangles"].get<int>(),
      row["columns"].get<int>(), row["rows"].get<int>());
    if (row.contains("error"))
    {
      std::printf(" %s |\n", row["error"].get<std::string>().c_str());
      continue;
    }
    for (const auto& [key, format] : { std::pair{ "frame/medianMs", "%.1f" },
           std::pair{ "embreeFrame/medianMs", "%.1f" }, std::pair{ "embreeRatio", "%.2f" },
           std::pair{ "embreeLargestDifferenceMm", "%.0e" }, std::pair{ "coldStartMs", "%.0f" },
           std::pair{ "refitRatio", "%.2f" }, std::pair{ "bytesPerTriangle", "%.0f" },
           std::pair{ "threeMaterialsRatio", "%.2f" }, std::pair{ "hundredEnergiesRatio", "%.2f" },
           std::pair{ "eightDerivativesRatio", "%.2f" }, std::pair{ "inconsistent", "%.0f" } })
    {
      std::printf(" %s |", Cell(row, key, format).c_str());
    }
    std::printf("\n");
  }
}

/// The paper's table 1 beside ours.
void PrintPublished(const Json& rows)
{
  std::printf("\n| example | method | published, with set-up, ms | here, process to disk, ms | "
              "published, rendering only, ms | here, frame with read-back, ms |\n"
              "|---|---|---|---|---|---|\n");
  for (const Json& row : rows)
  {
    const auto* published = std::find_if(std::begin(Published), std::end(Published),
      [&](const PublishedTimes& times) { return times.Name == row["example"]; });
    if (published != std::end(Published) && !row.contains("error"))
    {
      std::printf("| %s | %s | %.0f | %s | %.1f | %s |\n", published->Name,
        row["method"].get<std::string>().c_str(), published->SetUpMs,
        Cell(row, "coldStartMs", "%.0f").c_str(), published->RenderMs,
        Cell(row, "frame/medianMs", "%.1f").c_str());
    }
  }
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

void PrintRates(const Json& sweeps)
{
  std::printf("\n| method | triangles | pixels | frames per second, with set-up | rendering only "
              "|\n|---|---|---|---|---|\n");
  for (const Json& sweep : sweeps)
  {
    for (const char* kind : { "resolution", "triangles" })
    {
      for (const Json& point : sweep[kind])
      {
        std::printf("| %s | %d | %dx%d | %.1f | %.1f |\n",
          sweep["method"].get<std::string>().c_str(), point["triangles"].get<int>(),
          point["columns"].get<int>(), point["rows"].get<int>(),
          1e3 / point["setUpAndFrameMs"].get<double>(),
          1e3 / point["frame"]["medianMs"].get<double>());
      }
    }
  }
}

void WriteJson(const Json& value, const std::string& path)
{
  if (!(std::ofstream(path) << value.dump(2) << "\n"))
  {
    throw Error(path + ": cannot be written");
  }
}

struct Arguments
{
  std::vector<std::string> Examples = ExampleNames();
  std::vector<std::string> Methods{ "rasterisation", "ray-tracing" };
  double Budget = 8;
  std::string Output;
  std::string Plot;
  bool Rates = false;
  /// Of the processes that this one starts.
  std::string Case;
  std::string Once;
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
  PrintCases(report["results"]);
  PrintPublished(report["results"]);
  if (arguments.Rates || !arguments.Plot.empty())
  {
    for (const std::string& method : arguments.Methods)
    {
      std::fprintf(stderr, "frames per second, %s ...\n", method.c_str());
      report["rates"].push_back(SweepRates(method, std::min(arguments.Budget, 2.0)));
    }
    PrintRates(report["rates"]);
  }
  const std::string output =
    arguments.Output.empty() ? folder.File("report.json") : arguments.Output;
  WriteJson(report, output);
  if (!arguments.Plot.empty() &&
    std::system(
      ("'" MAMMORAY_PYTHON "' '" MAMMORAY_PLOT_SCRIPT "' '" + output + "' '" + arguments.Plot + "'")
        .c_str()) != 0)
  {
    throw Error("plot: the script failed; it needs Debian's python3-matplotlib");
  }
}

void Run(const Arguments& arguments)
{
  const ProjectorOptions::Method method = MethodFromName(arguments.Methods.front());
  if (!arguments.Case.empty())
  {
    WriteJson(MeasureScene(arguments.Case, method, arguments.Budget), arguments.Output);
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
  CLI::App application("Times the projectors on examples of four sizes; Markdown to stdout.");
  Arguments arguments;
  application.add_option("--examples", arguments.Examples, "which of them")->capture_default_str();
  application.add_option("--methods", arguments.Methods, "rasterisation, ray-tracing")
    ->capture_default_str();
  application
    .add_option("--seconds", arguments.Budget,
      "no further round of a measurement once so many are spent; 2 rounds at least, 10 at most")
    ->capture_default_str();
  application.add_option("-o,--output", arguments.Output, "JSON file to write");
  application.add_flag("--rates", arguments.Rates,
    "frames per second against resolution and triangles too");
  application.add_option("--plot", arguments.Plot,
    "draw them as .png or .pdf (needs python3-matplotlib)");
  application.add_option("--case", arguments.Case)->group("");
  application.add_option("--once", arguments.Once)->group("");
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
