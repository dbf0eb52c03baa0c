// SPDX-License-Identifier: Apache-2.0
// mammoray-validate: measures registration on breasts whose truth is known. Tables and plots:
// tables.py.
#include "Benchmark.h"
#include "ProgressBar.h"
#include "ValidationCases.h"
#include "ValidationFile.h"
#include "ValidationRuns.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/LandmarkEvaluation.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <utility>

namespace
{
using namespace mammoray;
namespace fs = std::filesystem;

struct Arguments
{
  std::string Data;
  /// NAME=FILE
  std::vector<std::string> Phantoms;
  double LabelSpacingMm = 0.5;
  TwinPlan Twins;
  std::vector<std::string> Kinds{ "plain", "wrong-material", "wrong-start", "every-parameter" };
  int Searches = 2;
  int Studies = 20;
  std::vector<std::string> Anatomies;
  int Projections = 0;
  std::string KeepStudiesIn;
  /// Of the one study: without a path the shipped phantom.
  LabelSource Labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
  VirtualStudyOptions Study;
  std::string Side = "left";
  std::string Contrast = "both";
  std::string Drawn = MAMMORAY_DRAWN_SLICES;
  std::string Output;
  bool Resume = false;
  bool Overwrite = false;
};

const CLI::Range Positive(1e-9, 1e9, "POSITIVE");
const CLI::Range NonNegative(0.0, 1e9, "NONNEGATIVE");
const CLI::Range Count(0, 1000000, "COUNT");

/// Declares options of a verb whose variables hold the defaults.
class Options
{
public:
  explicit Options(CLI::App& verb)
    : Verb(verb)
  {
  }

  template <typename T>
  CLI::Option* operator()(const char* name, T& value, const char* help) const
  {
    return this->Verb.add_option(name, value, help)->capture_default_str();
  }

  template <typename T>
  void operator()(const char* name, T& value, const CLI::Validator& range, const char* help) const
  {
    (*this)(name, value, help)->check(range);
  }

  template <typename Kinds>
  void Choice(const char* name, typename Kinds::value_type& value, const Kinds& kinds,
    const char* help) const
  {
    std::map<std::string, typename Kinds::value_type> names;
    for (const auto kind : kinds)
    {
      names[NameOf(kind)] = kind;
    }
    this->Verb.add_option(name, value, help)->transform(CLI::CheckedTransformer(names));
  }

  CLI::App& Verb;
};

void AddPhantoms(const Options& add, Arguments& of)
{
  add("--data", of.Data,
    "folder of public test data, with breastphantom-scattered-1001, breastphantom-hetero-2002, "
    "digibreast, monai-mammograms and victre-pipeline-phantom-1 (see Data/README.md)");
  add("--phantom", of.Phantoms, "NAME=FILE: a label volume, instead of the three of the data");
  add("--label-spacing", of.LabelSpacingMm, Positive,
    "finer phantoms are resampled to voxels of this size, mm");
}

void AddFrame(const Options& add, Arguments& of)
{
  add("--materials", of.Twins.Materials, "material table of the phantoms' labels");
  add("--orientation", of.Twins.Orientation, "directions of the phantoms' axes");
}

/// Of `Gather`.
void AddRuns(const Options& add, Arguments& of)
{
  RegistrationOptions& options = of.Twins.Options.Registration;
  add("--pixel-sizes", options.PixelSizesMm, Positive, "pixels that are compared, mm");
  add.Choice("--residual", options.Comparison,
    std::array{ PictureComparison::Global, PictureComparison::Local, PictureComparison::Gradient },
    "how pictures are compared");
  add("--window", options.WindowMm, Positive, "edge of the windows of --residual local, mm");
  add("-o,--output", of.Output, "JSON of all runs, written after each; Ctrl-C keeps what is done")
    ->required();
  add.Verb.add_flag("--resume", of.Resume, "go on from the runs in --output");
  add.Verb.add_flag("--overwrite", of.Overwrite, "replace --output");
}

void AddTwins(const Options& add, Arguments& of)
{
  TwinOptions& options = of.Twins.Options;
  AddPhantoms(add, of);
  AddFrame(add, of);
  add("--seed", options.Seed, "of the true poses, starts and noise");
  add("--model-fineness", options.ModelFineness, NonNegative,
    "of the model's mechanics: edge of a cube with the breast's volume over the cell size; 0: as "
    "register makes them");
  add("--target-fineness", options.TargetFineness, Positive,
    "the same of the true breast's mechanics");
  add.Choice("--picture", options.Picture, PictureKinds,
    "how mammograms are stored: for display, equalised for display, raw, or raw with heel and "
    "scatter");
  AddRuns(add, of);
}

void AddStudies(const Options& add, Arguments& of)
{
  AddPhantoms(add, of);
  add("--seed", of.Twins.Options.Seed, "studies are numbered from it");
  add("--count", of.Studies, Count, "studies, of the phantoms and the data's MRI in turn");
  add("--anatomy", of.Anatomies, "only those of these anatomies, for example uta11-a");
  add("--projections", of.Projections, CLI::Range(0, 60),
    "of the CC as a tomosynthesis over 25 degrees, registered beside CC alone and CC with MLO; "
    "less than 2: none");
}

void AddStudy(const Options& add, Arguments& of)
{
  VirtualStudyOptions& study = of.Study;
  add("-o,--output", of.Output, "new or empty folder")->required();
  add("--labels", of.Labels.Path, "label volume of the phantom; the shipped one without it");
  AddFrame(add, of);
  add("--label-spacing", of.Labels.SpacingMm, Positive,
    "a finer phantom is resampled to these "
    "voxels, mm");
  add("--seed", study.Seed, "of stiffness, poses, thickness and noise");
  add("--side", of.Side, CLI::IsMember({ "left", "right" }), "the patient's own breast");
  add("--contrast", of.Contrast, CLI::IsMember({ "both", "plain", "fat-suppressed" }),
    "T1 without and with fat suppression, or one of them");
  add.Verb.add_flag_callback(
    "--one-breast", [&study]() { study.BothBreasts = false; },
    "no other breast in the field of view");
  add("--scanner", study.Scanner,
    CLI::IsMember(std::set<std::string>(Scanners.begin(), Scanners.end())),
    "whose headers the MRI has; chosen by the seed without it");
  add("--mri-pixel", study.MriPixelMm, Positive, "voxels of the MRI in plane, mm");
  add("--mri-slice", study.MriSliceMm, Positive, "distance of its slices, mm");
  add("--snr", study.SignalToNoise, Positive, "signal of fat over the noise, in the breast");
  add("--mammogram-pixel", study.MammogramPixelMm, Positive, "pixels of the mammograms, mm");
  add("--gravity-fineness", study.GravityFineness, Positive,
    "of the hanging breast: edge of a cube with its volume over the cell size");
  add("--compression-fineness", study.CompressionFineness, Positive,
    "the same of the compressed one");
  add("--anatomy-cell", study.AnatomyMm, Positive, "cells of the X-rayed anatomy, mm");
}

/// Throws InputError unless the file can be read.
void RequireFile(const std::string& path)
{
  if (!fs::is_regular_file(path))
  {
    throw InputError(path + ": no such file");
  }
}

std::vector<Phantom> PhantomsOf(const Arguments& arguments)
{
  if (arguments.Phantoms.empty() && !fs::is_directory(arguments.Data))
  {
    throw InputError(
      "--data: expected the folder of public test data, found '" + arguments.Data + "'");
  }
  std::vector<Phantom> phantoms = arguments.Phantoms.empty()
    ? ValidationPhantoms(arguments.Data, arguments.LabelSpacingMm)
    : std::vector<Phantom>();
  for (const std::string& text : arguments.Phantoms)
  {
    const std::size_t at = text.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == text.size())
    {
      throw InputError(
        "--phantom: expected NAME=FILE, for example mine=labels.nrrd, found '" + text + "'");
    }
    Phantom& phantom = phantoms.emplace_back();
    phantom.Name = text.substr(0, at);
    phantom.Labels.Path = text.substr(at + 1);
    phantom.Labels.SpacingMm = arguments.LabelSpacingMm;
  }
  for (const Phantom& phantom : phantoms)
  {
    RequireFile(phantom.Labels.Path);
  }
  return phantoms;
}

std::vector<TwinKind> KindsOf(const std::vector<std::string>& names)
{
  std::vector<TwinKind> kinds;
  const auto add = [&](const auto& of, const char* all)
  {
    for (const TwinKind kind : of)
    {
      if (std::any_of(names.begin(), names.end(),
            [&](const std::string& name) { return name == NameOf(kind) || name == all; }))
      {
        kinds.push_back(kind);
      }
    }
  };
  add(RightTwins, "");
  add(WrongPairs, "wrong-pairs");
  return kinds;
}

std::vector<PlannedStudy> StudiesOf(const Arguments& arguments)
{
  std::vector<PlannedStudy> studies =
    ValidationStudies(PhantomsOf(arguments), arguments.Data, arguments.Studies);
  std::vector<std::string> known;
  for (PlannedStudy& study : studies)
  {
    if (std::find(known.begin(), known.end(), study.Phantom) == known.end())
    {
      known.push_back(study.Phantom);
    }
    study.Options.Seed += arguments.Twins.Options.Seed - 1;
    study.Options.Projections = arguments.Projections;
    study.Registration = arguments.Twins.Options.Registration;
  }
  const std::vector<std::string>& names = arguments.Anatomies;
  for (const std::string& name : names)
  {
    if (std::find(known.begin(), known.end(), name) == known.end())
    {
      throw InputError(
        "--anatomy: there is no virtual study of '" + name + "'; " + SpellingHint(name, known));
    }
  }
  std::erase_if(studies,
    [&](const PlannedStudy& study) {
      return !names.empty() && std::find(names.begin(), names.end(), study.Phantom) == names.end();
    });
  return studies;
}

/// Runs with a file of these settings, and of how pictures are compared.
void Gather(const Arguments& arguments, nlohmann::json settings,
  const std::function<void(ValidationFile& file, const ProgressCallback& progress)>& run)
{
  const RegistrationOptions& registration = arguments.Twins.Options.Registration;
  settings["pixelSizesMm"] = registration.PixelSizesMm;
  settings["comparison"] = NameOf(registration.Comparison);
  settings["windowMm"] = registration.WindowMm;
  if (fs::exists(arguments.Output) && !arguments.Resume && !arguments.Overwrite)
  {
    throw InputError(arguments.Output +
      ": exists already; --resume goes on from it, --overwrite "
      "replaces it");
  }
  ValidationFile file(arguments.Output, settings, arguments.Resume);
  try
  {
    run(file, MakeProgressBar());
  }
  catch (const Interrupted&)
  {
    std::fprintf(stderr, "mammoray-validate: note: --resume goes on from %s\n",
      arguments.Output.c_str());
    throw;
  }
  std::printf("%s: %zu runs; Validation/tables.py prints them\n", arguments.Output.c_str(),
    file.NumberOfRuns());
}

void RunBenchmark(const Arguments& arguments)
{
  const std::vector<PlannedStudy> studies = StudiesOf(arguments);
  const std::vector<BaselineScore> scores =
    ExportBenchmark(studies, arguments.Output, MakeProgressBar());
  std::printf("%s: %zu studies; see PROTOCOL.md\n", arguments.Output.c_str(), studies.size());
  std::printf("%-24s %-8s %-4s  %s\n", "imaged points, mm", "", "", "in 3D: median (95 %)");
  for (const BaselineScore& score : scores)
  {
    for (const AnswerScore& view : score.Views)
    {
      std::printf("%-24s %-8s %-4s  %.2f (%.2f)\n", score.Study.c_str(), score.Baseline.c_str(),
        view.View.c_str(), Quantile(view.Imaged.InSpaceMm, 0.5),
        Quantile(view.Imaged.InSpaceMm, 0.95));
    }
  }
}

void MakeOneStudy(Arguments& arguments)
{
  PlannedStudy study;
  study.Options = arguments.Study;
  study.Options.Laterality = arguments.Side == "left" ? 'L' : 'R';
  study.Options.Plain = arguments.Contrast != "fat-suppressed";
  study.Options.FatSuppressed = arguments.Contrast != "plain";
  study.Labels = arguments.Labels;
  study.Materials = arguments.Twins.Materials;
  study.Orientation = arguments.Twins.Orientation;
  if (study.Labels.Path.empty())
  {
    study.Labels.Path = DataDirectory() + "/victre-phantom-1/labels.nrrd";
  }
  const StudyTruth truth = MakePlannedStudy(study, arguments.Output, MakeProgressBar());
  std::printf("%s/export: MRI of a prone patient, CC and MLO of the %s breast\n",
    arguments.Output.c_str(), SideName(truth.Laterality).c_str());
  for (std::size_t index = 1; index < truth.Materials.size(); ++index)
  {
    std::printf("  %-8s %6.2f kPa\n", truth.Materials[index].c_str(), truth.YoungsModuliKPa[index]);
  }
  std::printf("  gravity moved the tissue by %.1f mm\n", truth.MeanHangMm);
  for (const TrueView& view : truth.Views)
  {
    std::printf("  %-3s %.1f mm thick (header %.0f), roll %.1f degrees, %.0f N: %s\n",
      view.View.c_str(), view.Pose.ThicknessMm, view.HeaderThicknessMm, view.Pose.RollDeg,
      view.PaddleForceN, view.File.c_str());
  }
  std::printf("%s/truth.json: %zu points in the MRI and in both views\n", arguments.Output.c_str(),
    truth.MriPoints.size());
}

void RunTwinsVerb(Arguments& arguments, bool searches)
{
  TwinPlan& plan = arguments.Twins;
  plan.Phantoms = PhantomsOf(arguments);
  plan.Kinds = KindsOf(arguments.Kinds);
  FindMaterialTable(plan.Materials); // refused before the work
  Gather(arguments, SettingsOf(plan),
    [&](ValidationFile& file, const ProgressCallback& progress)
    {
      if (searches)
      {
        plan.Count = arguments.Searches;
        CompareSearches(plan, file, progress);
      }
      else
      {
        RunTwins(plan, file, progress);
      }
    });
}

void RunLandmarksVerb(Arguments& arguments)
{
  std::vector<LandmarkCase> cases = ValidationLandmarks(arguments.Data);
  for (LandmarkCase& each : cases)
  {
    each.Case.Options = arguments.Twins.Options.Registration;
  }
  Gather(arguments, { { "landmarks", true } },
    [&](ValidationFile& file, const ProgressCallback& progress)
    { RunLandmarks(cases, file, progress); });
}

void RunMammogramsVerb(Arguments& arguments)
{
  std::vector<MammogramCase> cases = ValidationMammograms(PhantomsOf(arguments), arguments.Data);
  for (MammogramCase& each : cases)
  {
    RequireFile(each.Case.Mammograms.front());
    each.Case.Options = arguments.Twins.Options.Registration;
  }
  Gather(arguments, { { "spacingMm", arguments.LabelSpacingMm } },
    [&](ValidationFile& file, const ProgressCallback& progress)
    { RunMammograms(cases, file, progress); });
}

void RunStudiesVerb(Arguments& arguments)
{
  const std::vector<PlannedStudy> studies = StudiesOf(arguments);
  Gather(arguments,
    { { "spacingMm", arguments.LabelSpacingMm }, { "projections", arguments.Projections } },
    [&](ValidationFile& file, const ProgressCallback& progress)
    { RunStudies(studies, arguments.KeepStudiesIn, file, progress); });
}

void RunPatientsVerb(const Arguments& arguments)
{
  const std::vector<Patient> patients = ValidationPatients(arguments.Data, arguments.Drawn);
  if (patients.empty())
  {
    throw InputError(
      "--data: expected the folder of public test data with MRI of patients, found '" +
      arguments.Data + "'");
  }
  RunPatients(patients, arguments.Output, MakeProgressBar());
  std::printf("%s: patients.csv, patients.png and the labels\n", arguments.Output.c_str());
}

void AddVerbs(CLI::App& application, Arguments& of)
{
  const auto verb = [&](const char* name, const char* what, const std::function<void()>& run)
  {
    CLI::App* added = application.add_subcommand(name, what);
    added->callback(run);
    return Options(*added);
  };
  const Options twins =
    verb("twins", "Register phantoms to mammograms of themselves, and wrong pairs",
      [&of] { RunTwinsVerb(of, false); });
  std::set<std::string> kinds{ "wrong-pairs" };
  const auto name = [&](TwinKind kind) { kinds.insert(NameOf(kind)); };
  std::for_each(RightTwins.begin(), RightTwins.end(), name);
  std::for_each(WrongPairs.begin(), WrongPairs.end(), name);
  twins("--kinds", of.Kinds, "kinds of twins")->delimiter(',')->check(CLI::IsMember(kinds));
  twins("--count", of.Twins.Count, Count, "true poses of each kind and phantom");
  AddTwins(twins, of);

  const Options searches =
    verb("searches", "Compare exact derivatives, central differences and annealing on plain twins",
      [&of] { RunTwinsVerb(of, true); });
  searches("--count", of.Searches, Count, "true poses of each phantom");
  AddTwins(searches, of);

  const Options landmarks =
    verb("landmarks", "Register mammograms of compressions by other programs; errors at landmarks",
      [&of] { RunLandmarksVerb(of); });
  AddPhantoms(landmarks, of);
  AddRuns(landmarks, of);

  const Options mammograms = verb("mammograms",
    "Register real mammograms to other breasts, of which no match may be trusted",
    [&of] { RunMammogramsVerb(of); });
  AddPhantoms(mammograms, of);
  AddRuns(mammograms, of);

  const Options studies =
    verb("studies", "Make virtual studies and register them as 'mammoray register --study' does",
      [&of] { RunStudiesVerb(of); });
  AddStudies(studies, of);
  studies("--keep", of.KeepStudiesIn,
    "folder that keeps studies and results; a study that is there is registered again");
  AddRuns(studies, of);

  const Options benchmark = verb("benchmark",
    "Write virtual studies as a benchmark for any method (DICOM, NIfTI, CSV, PROTOCOL.md)",
    [&of] { RunBenchmark(of); });
  AddStudies(benchmark, of);
  benchmark("-o,--output", of.Output, "new or empty folder")->required();

  const Options patients = verb("patients",
    "Segment patients' MRI as 'mammoray segment' does and compare with slices drawn by hand",
    [&of] { RunPatientsVerb(of); });
  patients("--data", of.Data, "folder of public test data, with MRI of patients")->required();
  patients("--truth", of.Drawn, "folder of drawn slices, NAME.json")->check(CLI::ExistingDirectory);
  patients("-o,--output", of.Output, "new or empty folder")->required();

  AddStudy(verb("study",
             "Make one virtual study: a clinic's export/ (DICOM) of a phantom, and truth.json",
             [&of] { MakeOneStudy(of); }),
    of);
}

int Run(int argc, char* argv[])
{
  CLI::App application{ "MammoRay " MAMMORAY_VERSION
                        ": measures registration on breasts whose truth is known. Lengths in mm, "
                        "angles in degrees. Tables and plots: Validation/tables.py." };
  application.require_subcommand(1);
  Arguments arguments;
  AddVerbs(application, arguments);
  InterruptRequested(); // handled from now on
  try
  {
    application.parse(argc, argv);
  }
  catch (const CLI::Success& success)
  {
    return application.exit(success);
  }
  catch (const CLI::ParseError& error)
  {
    application.exit(error);
    return 2;
  }
  return 0;
}
}

int main(int argc, char* argv[])
{
  try
  {
    return Run(argc, argv);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "mammoray-validate: %s\n", EscapeControls(error.what()).c_str());
  }
  return 1;
}
