// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"
#include "ComparisonOptions.h"
#include "mammoray/Evidence/RegistrationEvidence.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

const std::vector<std::string> Parts{ "landmarks", "search", "plain", "wrong-material",
  "wrong-start", "every-parameter", "mammograms" };

struct EvidenceCommandOptions
{
  EvidenceOptions Evidence;
  std::string Data;
  /// NAME=FILE
  std::vector<std::string> Phantoms;
  double LabelSpacingMm = 0.5;
  std::vector<std::string> Only = Parts;
  std::string Output;
  std::string Table;
  bool Resume = false;
  bool Overwrite = false;

  bool Wants(const std::string& part) const
  {
    return std::find(this->Only.begin(), this->Only.end(), part) != this->Only.end();
  }
};

/// The three phantoms of the project's data and its copy of public data.
std::vector<std::string> ShippedPhantoms(const std::string& data)
{
  return { "victre-1=" + DataDirectory() + "/victre-phantom-1/labels.nrrd",
    "scattered-1001=" + data + "/breastphantom-scattered-1001/labels.nrrd",
    "hetero-2002=" + data + "/breastphantom-hetero-2002/labels.nrrd" };
}

void AddPhantoms(EvidenceCommandOptions& options)
{
  if (options.Phantoms.empty())
  {
    options.Phantoms = ShippedPhantoms(options.Data);
  }
  for (const std::string& phantom : options.Phantoms)
  {
    const std::size_t equals = phantom.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == phantom.size())
    {
      throw InputError("phantom '" + phantom + "': expected NAME=FILE");
    }
    EvidencePhantom added;
    added.Name = phantom.substr(0, equals);
    added.Labels.Path = phantom.substr(equals + 1);
    added.Labels.SpacingMm = options.LabelSpacingMm;
    CheckInputFile(added.Labels.Path);
    options.Evidence.Phantoms.push_back(added);
  }
}

/// The FDA's phantom against its own compression; see Data/victre-phantom-1.
void AddLandmarks(EvidenceCommandOptions& options)
{
  const std::string folder = DataDirectory() + "/victre-phantom-1/";
  EvidenceLandmarks landmarks;
  landmarks.Case.Labels.Path = folder + "labels.nrrd";
  landmarks.Case.Materials = "victre";
  landmarks.Case.Orientation = "ALS";
  landmarks.Case.Options.Comparison = options.Evidence.Twin.Registration.Comparison;
  landmarks.Case.Options.WindowMm = options.Evidence.Twin.Registration.WindowMm;
  landmarks.Case.Mammograms = { folder + "victre1_lcc_processing.dcm" };
  landmarks.Landmarks = folder + "landmarks.csv";
  const AnatomicalAxes axes = AnatomicalAxes::FromCode("ALS");
  landmarks.Truth.Placed = { { 8.4, 7.4466, -27.3184 }, axes.Left, axes.Anterior, axes.Superior };
  const std::string compressed = options.Data + "/victre-pipeline-phantom-1/pc_1_crop.nhdr";
  if (fs::exists(compressed))
  {
    landmarks.CompressedLabels.Path = compressed;
    landmarks.CompressedLabels.AxesAsGiven = true;
    // Its header repeats the origin of the volume it was cut from.
    landmarks.CompressedOrigin = Vector3{ 8.4, -46.4534, -26.3184 };
  }
  options.Evidence.Landmarks = landmarks;
}

/// A real mammogram in both forms; its own volume is not known, so that no match may be trusted.
void AddMammograms(EvidenceCommandOptions& options)
{
  for (const char* name : { "mg_processing_mono1_explicitLE", "mg_presentation_mono2_explicitLE" })
  {
    EvidenceMammogram mammogram;
    mammogram.Name = name;
    mammogram.Case.Labels.Path = options.Data + "/breastphantom-scattered-1001/labels.nrrd";
    mammogram.Case.Materials = "victre";
    mammogram.Case.Orientation = "ALS";
    const std::string path = options.Data + "/digibreast/dicom/" + name + ".dcm";
    mammogram.Case.Mammograms = { CheckInputFile(path) };
    options.Evidence.Mammograms.push_back(mammogram);
  }
}

/// What two runs must share to be one.
std::string SettingsOf(const EvidenceOptions& options)
{
  nlohmann::json phantoms;
  for (const EvidencePhantom& phantom : options.Phantoms)
  {
    phantoms[phantom.Name] = { { "sha256", Sha256OfFile(phantom.Labels.Path) },
      { "spacingMm", phantom.Labels.SpacingMm } };
  }
  const TwinOptions& twin = options.Twin;
  return nlohmann::json{
    { "phantoms", phantoms }, { "materials", options.Materials },
    { "orientation", options.Orientation }, { "seed", twin.Seed },
    { "modelFineness", twin.ModelFineness }, { "targetFineness", twin.TargetFineness },
    { "modelAnatomyMm", twin.ModelAnatomyMm }, { "targetAnatomyMm", twin.TargetAnatomyMm },
    { "noise", twin.Noise }, { "pixelSizesMm", twin.Registration.PixelSizesMm },
    { "comparison", static_cast<int>(twin.Registration.Comparison) },
    { "windowMm", twin.Registration.WindowMm }
  }.dump();
}

void RunEvidence(EvidenceCommandOptions& options)
{
  const bool wantsData = options.Phantoms.empty() || options.Wants("mammograms");
  if (wantsData && !fs::is_directory(options.Data))
  {
    throw InputError("data: expected the folder of public test data, found '" + options.Data + "'");
  }
  CheckOutputFile(options.Output, options.Overwrite || options.Resume);
  if (!options.Table.empty())
  {
    CheckOutputFile(options.Table, options.Overwrite || options.Resume);
  }
  AddPhantoms(options);
  EvidenceOptions& input = options.Evidence;
  std::erase_if(input.Kinds, [&](TwinKind kind) { return !options.Wants(NameOf(kind)); });
  input.SearchTwins = options.Wants("search") ? input.SearchTwins : 0;
  if (options.Wants("landmarks"))
  {
    AddLandmarks(options);
  }
  if (options.Wants("mammograms"))
  {
    AddMammograms(options);
  }

  const std::string settings = SettingsOf(input);
  RegistrationEvidence evidence;
  if (options.Resume && fs::exists(options.Output))
  {
    evidence = ReadEvidence(options.Output, settings);
  }
  const auto keep = [&]()
  {
    WriteComplete(options.Output,
      [&](const std::string& path) { WriteEvidence(evidence, settings, path); });
    if (!options.Table.empty())
    {
      WriteComplete(options.Table,
        [&](const std::string& path) { WriteTwinTable(evidence.Twins, path); });
    }
  };
  try
  {
    GatherEvidence(input, evidence, keep, MakeProgressBar());
  }
  catch (const Interrupted&)
  {
    std::fputs(FormatEvidence(evidence).c_str(), stdout);
    std::fprintf(stderr, "mammoray: note: --resume goes on from %s\n", options.Output.c_str());
    throw;
  }
  keep();
  std::fputs(FormatEvidence(evidence).c_str(), stdout);
}
}

void AddEvidenceCommand(CLI::App& application)
{
  auto options = std::make_shared<EvidenceCommandOptions>();
  EvidenceOptions& input = options->Evidence;
  CLI::App* command = application.add_subcommand("evidence",
    "Measure how well registration works, on breasts whose truth is known; prints tables");
  command->add_option("--data", options->Data,
    "folder of public test data, with breastphantom-scattered-1001, breastphantom-hetero-2002, "
    "digibreast and victre-pipeline-phantom-1 (see Data/README.md)");
  command->add_option("--phantom", options->Phantoms,
    "NAME=FILE: a label volume for the twin experiments, instead of the three of the data");
  AddMaterialsOption(*command, input.Materials)->capture_default_str();
  command
    ->add_option("--orientation", input.Orientation,
      "directions of the phantoms' axes: L/R, A/P, S/I")
    ->capture_default_str();
  command
    ->add_option("--label-spacing", options->LabelSpacingMm,
      "phantoms that are finer are resampled to voxels of this size, mm")
    ->check(PositiveNumber())
    ->capture_default_str();
  command->add_option("--only", options->Only, "parts to run")
    ->check(CLI::IsMember(Parts))
    ->delimiter(',')
    ->capture_default_str();
  command->add_option("--twins", input.Twins, "true poses of each kind and phantom")
    ->check(NonNegativeNumber())
    ->capture_default_str();
  command
    ->add_option("--search-twins", input.SearchTwins,
      "true poses of each phantom for which searches are compared")
    ->check(NonNegativeNumber())
    ->capture_default_str();
  command->add_option("--seed", input.Twin.Seed, "of the true poses, starts and noise")
    ->capture_default_str();
  command
    ->add_option("--model-fineness", input.Twin.ModelFineness,
      "cells of the model's mechanics: edge of a cube as large as the breast, over this")
    ->check(PositiveNumber())
    ->capture_default_str();
  command
    ->add_option("--target-fineness", input.Twin.TargetFineness,
      "the same for the mechanics of the true breast")
    ->check(PositiveNumber())
    ->capture_default_str();
  command
    ->add_option("--pixel-sizes", input.Twin.Registration.PixelSizesMm,
      "pixels in which the pictures are compared, coarse to fine, mm")
    ->check(PositiveNumber())
    ->capture_default_str();
  AddComparisonOptions(*command, input.Twin.Registration);
  command
    ->add_option("-o,--output", options->Output,
      "JSON of all runs, written after each; Ctrl-C leaves what is done")
    ->required();
  command->add_option("--table", options->Table, "CSV with a row for each twin run");
  command->add_flag("--resume", options->Resume, "go on from the runs in --output");
  command->add_flag("--overwrite", options->Overwrite, "replace --output and --table");
  AddConfigurationOptions(*command);
  command->callback([options]() { RunEvidence(*options); });
}
}
