// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"
#include "mammoray/Case/ResultFile.h"
#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

namespace mammoray
{
namespace
{
struct EvaluateOptions
{
  std::string Result;
  std::string Landmarks;
  std::string TruthOrientation = "LPS";
  std::vector<double> TruthOrigin{ 0, 0, 0 };
  double TruthSourceToDetectorMm = 650;
};

Vector3 ToVector(const nlohmann::json& values)
{
  return { values.at(0).get<double>(), values.at(1).get<double>(), values.at(2).get<double>() };
}

void PrintRow(const char* method, const char* group, const ErrorSummary& space,
  const ErrorSummary& receptor)
{
  std::printf("%-36s %-10s %3d  %7.2f %7.2f %7.2f   %7.2f %7.2f %7.2f\n", method, group,
    space.Count, space.Median, space.Mean, space.Largest, receptor.Median, receptor.Mean,
    receptor.Largest);
}

void Evaluate(const EvaluateOptions& options)
{
  VolumeFromGantry placed;
  double sid = 0;
  double outline = 0;
  ReadResultFile(options.Result,
    [&](const nlohmann::json& result)
    {
      const nlohmann::json& placement = result.at("placement");
      placed.Origin = ToVector(placement.at("originMm"));
      placed.X = ToVector(placement.at("x"));
      placed.Y = ToVector(placement.at("y"));
      placed.Z = ToVector(placement.at("z"));
      sid = result.at("unit").at("sourceToDetectorMm").get<double>();
      outline = result.at("meanOutlineDistanceMm").get<double>();
    });
  const auto grid = ReadMesh(CheckInputFile(options.Result + "/uncompressed.vtu"));
  const std::vector<Landmark> landmarks = ReadLandmarks(CheckInputFile(options.Landmarks));
  LandmarkTruth truth;
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(options.TruthOrientation);
  truth.Placed = { { options.TruthOrigin[0], options.TruthOrigin[1], options.TruthOrigin[2] },
    axes.Left, axes.Anterior, axes.Superior };
  truth.SourceToDetectorMm = options.TruthSourceToDetectorMm;

  std::printf("Landmark error, mm             (landmarks are never used to fit)\n");
  std::printf("%-36s %-10s %3s  %23s   %23s\n", "", "", "", "in 3D", "on the receptor");
  std::printf("%-36s %-10s %3s  %7s %7s %7s   %7s %7s %7s\n", "method", "landmarks", "n", "median",
    "mean", "max", "median", "mean", "max");
  for (const LandmarkErrors& errors : EvaluateLandmarks(landmarks, truth, grid, placed, sid))
  {
    std::vector<double> imagedSpace;
    std::vector<double> imagedReceptor;
    for (std::size_t index = 0; index < landmarks.size(); ++index)
    {
      if (landmarks[index].Imaged)
      {
        imagedSpace.push_back(errors.InSpace[index]);
        imagedReceptor.push_back(errors.OnReceptor[index]);
      }
    }
    PrintRow(errors.Method.c_str(), "imaged", Summarise(imagedSpace), Summarise(imagedReceptor));
    PrintRow("", "all", Summarise(errors.InSpace), Summarise(errors.OnReceptor));
  }
  std::printf("Mean distance of the outlines: %.2f mm\n", outline);
}
}

void AddEvaluateCommand(CLI::App& application)
{
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = application.add_subcommand("evaluate",
    "Measure a registration's error at landmarks known before and after compression");
  command->add_option("--result", options->Result, "folder written by 'mammoray register'")
    ->required();
  command
    ->add_option("--landmarks", options->Landmarks,
      "CSV: ux,uy,uz (uncompressed, frame of the label volume), cx,cy,cz (compressed, frame of the "
      "truth), imaged (0 or 1, may be left out); mm")
    ->required();
  command
    ->add_option("--truth-orientation", options->TruthOrientation,
      "directions of the truth frame's axes, e.g. LPS or ALS")
    ->capture_default_str();
  command
    ->add_option("--truth-origin", options->TruthOrigin,
      "the gantry frame's origin in the truth's frame, mm")
    ->expected(3)
    ->capture_default_str();
  command
    ->add_option("--truth-source-to-detector", options->TruthSourceToDetectorMm,
      "source to detector distance of the truth, mm")
    ->check(PositiveNumber())
    ->capture_default_str();
  AddConfigurationOptions(*command);
  command->callback([options]() { Evaluate(*options); });
}
}
