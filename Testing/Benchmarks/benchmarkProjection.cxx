// SPDX-License-Identifier: Apache-2.0
// Times the projectors on meshes and images of the sizes that are published for ray-traced X-ray
// images of meshes: a plate, boxes, tubes and a breast. Every case runs in a process of its own, so
// that set-up is cold and peak memory is its own.
#include "Error.h"
#include "PathLengthProjector.h"
#include "SurfaceShapes.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double Seconds(Clock::time_point since)
{
  return std::chrono::duration<double>(Clock::now() - since).count();
}

/// A box whose faces are grids of nx x ny x nz cells: 4 (nx ny + ny nz + nx nz) triangles.
void AddGridBox(SurfaceMesh& mesh, const Vector3& low, const Vector3& high,
  const std::array<int, 3>& cells)
{
  std::map<std::array<int, 3>, std::uint32_t> ids;
  const auto id = [&](const std::array<int, 3>& index)
  {
    const auto [entry, isNew] = ids.try_emplace(index, 0u);
    if (isNew)
    {
      Vector3 point{};
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        point[axis] = low[axis] + (high[axis] - low[axis]) * index[axis] / cells[axis];
      }
      entry->second = AddPoint(mesh, point);
    }
    return entry->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::size_t first = (axis + 1) % 3;
    const std::size_t second = (axis + 2) % 3;
    for (const int end : { 0, 1 })
    {
      for (int i = 0; i < cells[first]; ++i)
      {
        for (int j = 0; j < cells[second]; ++j)
        {
          const auto corner = [&](int di, int dj)
          {
            std::array<int, 3> index{};
            index[axis] = end * cells[axis];
            index[first] = i + di;
            index[second] = j + dj;
            return id(index);
          };
          const int inside = end == 1 ? 1 : 0;
          AddTriangle(mesh, corner(0, 0), corner(1, 0), corner(1, 1), inside, 1 - inside);
          AddTriangle(mesh, corner(0, 0), corner(1, 1), corner(0, 1), inside, 1 - inside);
        }
      }
    }
  }
}

/// A closed surface of rings between two poles, 2 around rings triangles; `place` gives the point
/// of an angle and a height from 0 (south pole) to 1.
void AddRevolution(SurfaceMesh& mesh, std::uint32_t around, std::uint32_t rings, int inside,
  int outside, const std::function<Vector3(double angle, double height)>& place)
{
  const std::uint32_t south = AddPoint(mesh, place(0, 0));
  const std::uint32_t base = south + 1;
  for (std::uint32_t ring = 0; ring < rings; ++ring)
  {
    for (std::uint32_t k = 0; k < around; ++k)
    {
      AddPoint(mesh, place(2 * std::numbers::pi * k / around, (ring + 1.0) / (rings + 1.0)));
    }
  }
  const std::uint32_t north = AddPoint(mesh, place(0, 1));
  for (std::uint32_t k = 0; k < around; ++k)
  {
    const std::uint32_t next = (k + 1) % around;
    AddTriangle(mesh, south, base + next, base + k, inside, outside);
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring)
    {
      const std::uint32_t low = base + ring * around;
      const std::uint32_t high = low + around;
      AddTriangle(mesh, low + k, low + next, high + next, inside, outside);
      AddTriangle(mesh, low + k, high + next, high + k, inside, outside);
    }
    const std::uint32_t last = base + (rings - 1) * around;
    AddTriangle(mesh, last + k, last + next, north, inside, outside);
  }
}

/// An ellipsoid of 2 around rings triangles.
void AddEllipsoid(SurfaceMesh& mesh, const Vector3& center, const Vector3& radii,
  std::uint32_t around, std::uint32_t rings, int inside, int outside)
{
  AddRevolution(mesh, around, rings, inside, outside,
    [&](double angle, double height)
    {
      const double polar = std::numbers::pi * (1 - height);
      const double ring = height == 0 || height == 1 ? 0 : std::sin(polar);
      return center +
        Vector3{ radii[0] * ring * std::cos(angle), radii[1] * ring * std::sin(angle),
          radii[2] * std::cos(polar) };
    });
}

struct Example
{
  const char* Name;
  int Columns;
  int Rows;
  /// Edges of the detector, mm; centred below the mesh.
  double Width;
  double Height;
  SurfaceMesh (*Make)();
};

SurfaceMesh Plate()
{
  SurfaceMesh mesh;
  AddGridBox(mesh, { -40, -55, 20 }, { 40, 55, 25 }, { 44, 83, 2 });
  return mesh;
}

SurfaceMesh Boxes()
{
  // 3965 in a lattice, each turned its own way, in three materials.
  SurfaceMesh mesh;
  for (int box = 0; box < 3965; ++box)
  {
    const Vector3 center{ -70 + 8.0 * (box % 18), -70 + 8.0 * (box / 18 % 18),
      20 + 8.0 * (box / 324) };
    const auto base = mesh.Points.size();
    AddBox(mesh, { -2, -2.5, -1.5 }, { 2, 2.5, 1.5 }, 1 + box % 3, 0,
      Rotation(0.1 * box, 0.7 * box, 0.3 * box));
    for (std::size_t index = base; index < mesh.Points.size(); ++index)
    {
      mesh.Points[index] += center[(index - base) % 3];
    }
  }
  return mesh;
}

SurfaceMesh Tubes()
{
  // 97 curved tubes of 2 x 8 x 139 triangles.
  SurfaceMesh mesh;
  for (int tube = 0; tube < 97; ++tube)
  {
    const double phase = 0.8 * tube;
    AddRevolution(mesh, 8, 139, 1, 0,
      [&](double angle, double height)
      {
        const bool end = height == 0 || height == 1;
        const double radius = end ? 0 : 1.0 + 0.3 * std::sin(phase);
        return Vector3{ 0.6 * (tube - 48) + 30 * std::sin(3 * height + phase) +
            radius * std::cos(angle),
          40 * std::cos(2 * height + 1.7 * phase) + radius * std::sin(angle),
          10 + 0.8 * (tube % 7) + 80 * height };
      });
  }
  return mesh;
}

SurfaceMesh Breast()
{
  // Skin, fat, gland and a lump, one within the other.
  SurfaceMesh mesh;
  AddEllipsoid(mesh, { 0, 0, 35 }, { 90, 70, 30 }, 1100, 1100, 1, 0);
  AddEllipsoid(mesh, { 0, 0, 35 }, { 88.5, 68.5, 28.5 }, 1100, 1100, 2, 1);
  AddEllipsoid(mesh, { 5, 3, 34 }, { 55, 40, 20 }, 415, 415, 3, 2);
  AddEllipsoid(mesh, { 12, -8, 33 }, { 6, 5, 4 }, 24, 21, 4, 3);
  return mesh;
}

const std::array<Example, 4> Examples{ {
  { "test", 150, 200, 100, 133, Plate },
  { "boxes", 250, 200, 200, 160, Boxes },
  { "tubes", 1681, 2071, 168, 207, Tubes },
  { "breast", 1080, 1080, 210, 210, Breast },
} };

Json Times(std::vector<double> seconds)
{
  std::sort(seconds.begin(), seconds.end());
  const std::size_t count = seconds.size();
  return { { "medianMs", 1e3 * 0.5 * (seconds[(count - 1) / 2] + seconds[count / 2]) },
    { "leastMs", 1e3 * seconds.front() }, { "mostMs", 1e3 * seconds.back() }, { "runs", count } };
}

/// Runs at least once, then until `budget` seconds or ten runs are reached.
Json Repeat(double budget, const std::function<void()>& run)
{
  std::vector<double> seconds;
  const auto start = Clock::now();
  do
  {
    const auto begin = Clock::now();
    run();
    seconds.push_back(Seconds(begin));
  } while (seconds.size() < 10 && Seconds(start) < budget);
  return Times(seconds);
}

Json RunCase(const Example& example, ProjectorOptions::Method method, double budget)
{
  SurfaceMesh mesh = example.Make();
  XRaySource source;
  source.Position = { 0, 0, 650 };
  XRayDetector detector;
  detector.Columns = example.Columns;
  detector.Rows = example.Rows;
  detector.ColumnStep = { example.Width / example.Columns, 0, 0 };
  detector.RowStep = { 0, example.Height / example.Rows, 0 };
  detector.Origin = { -0.5 * example.Width, -0.5 * example.Height, 0 };

  Json result{ { "example", example.Name }, { "method", MethodName(method) },
    { "triangles", mesh.NumberOfTriangles() }, { "columns", example.Columns },
    { "rows", example.Rows }, { "materials", mesh.NumberOfMaterials() - 1 } };
  const auto begin = Clock::now();
  const auto projector = MakeProjector({ .Projection = method });
  result["device"] = projector->DeviceName();
  result["deviceMs"] = 1e3 * Seconds(begin);
  const auto upload = Clock::now();
  projector->SetSurface(mesh);
  result["surfaceMs"] = 1e3 * Seconds(upload);
  const PathLengthImage image = projector->Project(source, detector);
  result["coldMs"] = 1e3 * Seconds(begin);
  result["inconsistent"] = image.NumberOfInconsistentRays();
  double sum = 0;
  for (const float length : image.Lengths)
  {
    sum += length;
  }
  result["meanLengthMm"] = sum / static_cast<double>(image.NumberOfPixels());
  result["frame"] = Repeat(budget, [&] { projector->Project(source, detector); });
  result["refit"] = Repeat(budget,
    [&]
    {
      for (double& coordinate : mesh.Points)
      {
        coordinate *= 1.0001;
      }
      projector->UpdatePoints(mesh.Points);
    });
  return result;
}

/// In a child process; an error becomes the result.
Json RunApart(const Example& example, ProjectorOptions::Method method, double budget)
{
  int ends[2];
  if (pipe(ends) != 0)
  {
    throw Error("benchmark: no pipe");
  }
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0)
  {
    close(ends[0]);
    Json result;
    try
    {
      result = RunCase(example, method, budget);
    }
    catch (const std::exception& error)
    {
      result = { { "example", example.Name }, { "method", MethodName(method) },
        { "error", error.what() } };
    }
    const std::string text = result.dump();
    const bool written = write(ends[1], text.data(), text.size()) > 0;
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  char part[4096];
  for (ssize_t count = 0; child > 0 && (count = read(ends[0], part, sizeof(part))) > 0;)
  {
    text.append(part, static_cast<std::size_t>(count));
  }
  close(ends[0]);
  rusage usage{};
  if (child <= 0 || wait4(child, nullptr, 0, &usage) != child || text.empty())
  {
    throw Error("benchmark: the process of " + std::string(example.Name) + " failed");
  }
  Json result = Json::parse(text);
  result["peakMemoryMB"] = static_cast<double>(usage.ru_maxrss) / 1024;
  return result;
}

void Print(const Json& row)
{
  const std::string example = row["example"];
  const std::string method = row["method"];
  if (row.contains("error"))
  {
    std::printf("%-7s %-14s %s\n", example.c_str(), method.c_str(),
      row["error"].get<std::string>().c_str());
    return;
  }
  const auto times = [&](const char* name)
  {
    char text[64];
    std::snprintf(text, sizeof(text), "%.1f (%.1f-%.1f, %d)", row[name]["medianMs"].get<double>(),
      row[name]["leastMs"].get<double>(), row[name]["mostMs"].get<double>(),
      row[name]["runs"].get<int>());
    return std::string(text);
  };
  std::printf("%-7s %-14s %9d %5dx%-5d %9.0f %28s %28s %8.0f %6d %9.4f\n", example.c_str(),
    method.c_str(), row["triangles"].get<int>(), row["columns"].get<int>(), row["rows"].get<int>(),
    row["coldMs"].get<double>(), times("frame").c_str(), times("refit").c_str(),
    row["peakMemoryMB"].get<double>(), row["inconsistent"].get<int>(),
    row["meanLengthMm"].get<double>());
}
}

int main(int argc, char** argv)
{
  CLI::App application("Times the projectors on examples of four sizes.");
  std::vector<std::string> names{ "test", "boxes", "tubes", "breast" };
  std::vector<std::string> methods{ "rasterisation", "ray-tracing" };
  double budget = 20;
  std::string output;
  application.add_option("--examples", names, "which of them")->capture_default_str();
  application.add_option("--methods", methods, "which of them")->capture_default_str();
  application
    .add_option("--seconds", budget, "no further run of a case once so many are spent; 10 at most")
    ->capture_default_str();
  application.add_option("-o,--output", output, "JSON file to write");
  CLI11_PARSE(application, argc, argv);
  try
  {
    std::printf("%-7s %-14s %9s %11s %9s %28s %28s %8s %6s %9s\n", "example", "method", "triangles",
      "pixels", "cold ms", "frame ms (range, runs)", "refit ms (range, runs)", "peak MB", "inc.",
      "mean mm");
    Json report{ { "commit", MAMMORAY_COMMIT }, { "results", Json::array() } };
    for (const std::string& name : names)
    {
      const auto example = std::find_if(Examples.begin(), Examples.end(),
        [&](const Example& candidate) { return candidate.Name == name; });
      if (example == Examples.end())
      {
        throw InputError("example: expected test, boxes, tubes or breast, found " + name);
      }
      for (const std::string& method : methods)
      {
        Json row = RunApart(*example, MethodFromName(method), budget);
        Print(row);
        report["results"].push_back(std::move(row));
      }
    }
    if (!output.empty() && !(std::ofstream(output) << report.dump(2) << "\n"))
    {
      throw Error(output + ": cannot be written");
    }
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "benchmarkProjection: %s\n", error.what());
    return 1;
  }
  return 0;
}
