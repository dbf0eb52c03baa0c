// SPDX-License-Identifier: Apache-2.0
// Runs the X-ray proofs, then the benchmark (the paper's table 1 and figure 5), on a Vulkan device
// of this machine; writes hardware.json and hardware.html. The programs lie beside this one.
#include "ChildProcess.h"
#include "HardwareReport.h"
#include "ProjectionTables.h"
#include "TextFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <CLI/CLI.hpp>

#include <sys/utsname.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

namespace
{
using namespace mammoray;
using hardware::Json;
namespace fs = std::filesystem;

struct Arguments
{
  std::string Folder = "hardware";
  std::string Device;
  std::string Filter = "*";
  double BenchmarkSeconds = 4;
  double LimitSeconds = 1200;
};

DeviceDescription ChooseDevice(const std::string& wanted)
{
  std::string reason;
  const std::vector<DeviceDescription> devices = ListDevices(&reason);
  if (devices.empty())
  {
    throw Error(reason);
  }
  std::string names;
  for (const DeviceDescription& device : devices)
  {
    if (device.Name.find(wanted) != std::string::npos)
    {
      return device;
    }
    names += (names.empty() ? "" : ", ") + device.Name;
  }
  throw InputError("--device: expected a part of one of " + names + ", found " + wanted);
}

/// "AMD EPYC 9654, 16 threads, Linux 6.1.0 x86_64".
std::string DescribeHost()
{
  std::string processor = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
  {
    if (line.starts_with("model name"))
    {
      processor = line.substr(line.find(':') + 2);
      break;
    }
  }
  utsname system{};
  uname(&system);
  return processor + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads, " +
    system.sysname + " " + system.release + " " + system.machine;
}

std::string Now()
{
  const std::time_t now = std::time(nullptr);
  std::string text(32, '\0');
  text.resize(std::strftime(text.data(), text.size(), "%F %H:%M UTC", std::gmtime(&now)));
  return text;
}

Json ReadJson(const fs::path& path)
{
  std::ifstream file(path);
  return Json::parse(file);
}

/// What a program of proofs says; nothing where it is not there (built without its library).
void RunProofs(const std::string& program, const fs::path& programs, const Arguments& arguments,
  Json& report)
{
  const fs::path path = programs / program;
  if (!fs::exists(path))
  {
    return;
  }
  std::fprintf(stderr, "%s ...\n", program.c_str());
  const fs::path result = fs::path(arguments.Folder) / (program + ".json");
  const fs::path log = fs::path(arguments.Folder) / (program + ".log");
  fs::remove(result);
  const std::string failure = benchmarks::RunProgram(path.string(),
    { "--gtest_output=json:" + result.string(), "--gtest_filter=" + arguments.Filter },
    { log.string(), arguments.LimitSeconds });
  // A program whose tests fail says so by its exit code, and which ones in its file.
  if (fs::exists(result))
  {
    report["proofs"].push_back(hardware::SummariseProofs(program, ReadJson(result)));
    fs::remove(result);
  }
  else
  {
    report["proofs"].push_back(
      { { "program", program }, { "error", failure + "; see " + log.filename().string() } });
  }
}

Json RunBenchmark(const fs::path& programs, const Arguments& arguments)
{
  std::fprintf(stderr, "benchmarkProjection ...\n");
  const fs::path result = fs::path(arguments.Folder) / "benchmark.json";
  const std::string failure = benchmarks::RunProgram((programs / "benchmarkProjection").string(),
    { "--rates", "--seconds", std::to_string(arguments.BenchmarkSeconds), "-o", result.string() },
    { (fs::path(arguments.Folder) / "benchmark.log").string(), arguments.LimitSeconds });
  if (!failure.empty())
  {
    return { { "error", failure + "; see benchmark.log" } };
  }
  Json report = ReadJson(result);
  fs::remove(result);
  return report;
}

void Run(const Arguments& arguments)
{
  const DeviceDescription device = ChooseDevice(arguments.Device);
  std::printf("%s (%s)\n", device.Name.c_str(), device.Driver.c_str());
  // What every program below takes.
  setenv("MAMMORAY_DEVICE", device.Name.c_str(), 1);
  fs::create_directories(arguments.Folder);
  const fs::path programs = fs::path(benchmarks::ThisProgram()).parent_path();
  Json report{ { "version", MAMMORAY_VERSION }, { "date", Now() }, { "host", DescribeHost() },
    { "device",
      { { "name", device.Name }, { "driver", device.Driver }, { "type", device.Type },
        { "rayTracing", device.RayTracing } } },
    { "proofs", Json::array() } };
  for (const char* program : { "TestXRay", "TestXRayPeers" })
  {
    RunProofs(program, programs, arguments, report);
  }
  report["benchmark"] = RunBenchmark(programs, arguments);
  benchmarks::WriteText(report.dump(2) + "\n", fs::path(arguments.Folder) / "hardware.json");
  benchmarks::WriteText(hardware::HardwarePage(report),
    fs::path(arguments.Folder) / "hardware.html");
  const std::string verdict = hardware::Verdict(report);
  if (!report["benchmark"].contains("error"))
  {
    std::fputs((benchmarks::Markdown(benchmarks::PublishedTable(report["benchmark"])) +
                 benchmarks::Markdown(benchmarks::CaseTable(report["benchmark"])))
                 .c_str(),
      stdout);
  }
  std::printf("\n%s; %s/hardware.html\n", verdict.c_str(), arguments.Folder.c_str());
  if (!verdict.starts_with("all ") || report["benchmark"].contains("error"))
  {
    throw Error(verdict +
      (report["benchmark"].contains("error")
          ? "; benchmark: " + report["benchmark"]["error"].get<std::string>()
          : ""));
  }
}
}

int main(int argc, char** argv)
{
  CLI::App application("Proofs and times of the X-ray projectors on this machine's Vulkan device.");
  Arguments arguments;
  application
    .add_option("-o,--output", arguments.Folder, "folder for hardware.json, hardware.html")
    ->capture_default_str();
  application.add_option("--device", arguments.Device,
    "part of the device's name; the most capable one where it is not given");
  application.add_option("--filter", arguments.Filter, "which proofs, as --gtest_filter")
    ->capture_default_str();
  application
    .add_option("--seconds", arguments.BenchmarkSeconds,
      "no further round of a measurement once so many are spent")
    ->capture_default_str();
  application
    .add_option("--limit", arguments.LimitSeconds, "a program is killed after so many seconds")
    ->capture_default_str();
  CLI11_PARSE(application, argc, argv);
  try
  {
    Run(arguments);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "checkHardware: %s\n", error.what());
    return 1;
  }
  return 0;
}
