// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/Evidence/Benchmark.h"
#include "mammoray/Evidence/EvidenceCases.h"
#include "mammoray/Evidence/EvidenceFile.h"
#include "mammoray/Evidence/EvidenceTables.h"
#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/IO/AtomicFile.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

const std::vector<std::string> Parts{ "landmarks", "search", "plain", "wrong-material",
  "wrong-start", "every-parameter", "wrong-pairs", "mammograms", "studies" };

/// Parts, and the kinds of wrong pairs one by one.
std::vector<std::string> PartsByName()
{
  std::vector<std::string> names = Parts;
  for (const TwinKind kind : WrongPairs)
  {
    names.emplace_back(NameOf(kind));
  }
  return names;
}

struct EvidenceArguments
{
  EvidenceOptions Evidence;
  std::string Data;
  /// NAME=FILE
  std::vector<std::string> Phantoms;
  double LabelSpacingMm = 0.5;
  std::vector<std::string> Only = Parts;
  std::string Output;
  std::string Export;
  std::string Table;
  std::string Curve;
  int Studies = 20;
  std::vector<std::string> Anatomies;
  int Projections = 0;
  bool Resume = false;
  bool Overwrite = false;

  bool Wants(const std::string& part) const
  {
    return std::find(this->Only.begin(), this->Only.end(), part) != this->Only.end();
  }
};

void Declare(const OptionList& add, EvidenceArguments& arguments)
{
  EvidenceOptions& input = arguments.Evidence;
  add.Input("--data", arguments.Data,
    "folder of public test data, with breastphantom-scattered-1001, breastphantom-hetero-2002, "
    "digibreast and victre-pipeline-phantom-1 (see Data/README.md)");
  add("--phantom", arguments.Phantoms,
    "NAME=FILE: a label volume for the twin experiments, instead of the three of the data");
  AddMaterialsOption(add, input.Materials);
  AddOrientationOption(add, input.Orientation);
  add("--label-spacing", arguments.LabelSpacingMm, Positive("mm"),
    "phantoms that are finer are resampled to voxels of this size");
  add("--only", arguments.Only, "parts to run, or kinds of wrong pairs")
    ->check(CLI::IsMember(PartsByName()))
    ->delimiter(',');
  add("--twins", input.Twins, NonNegative(), "true poses of each kind and phantom");
  add("--search-twins", input.SearchTwins, NonNegative(),
    "true poses of each phantom for which searches are compared");
  add("--studies", arguments.Studies, NonNegative(),
    "virtual studies: a clinic's export each, of the phantoms and the patients' MRI of the data");
  add("--anatomy", arguments.Anatomies, "only virtual studies of these, e.g. uta11-a");
  add("--projections", arguments.Projections, Between(0, 60),
    "of each virtual study's CC as a tomosynthesis over 25 deg, registered beside CC alone and CC "
    "with MLO; less than 2: none");
  add("--keep", input.KeepStudiesIn,
    "folder that keeps the virtual studies and results; a study that is there is registered again");
  add("--seed", input.Twin.Seed,
    "of the true poses, starts and noise; virtual studies are numbered from it");
  add("--model-fineness", input.Twin.ModelFineness, NonNegative(),
    "cells of the model's mechanics: edge of a cube as large as the breast, over this; 0: as "
    "register makes them");
  add("--target-fineness", input.Twin.TargetFineness, Positive(),
    "the same for the mechanics of the true breast");
  std::vector<std::pair<std::string, PictureKind>> kinds;
  kinds.reserve(PictureKinds.size());
  for (const PictureKind kind : PictureKinds)
  {
    kinds.emplace_back(NameOf(kind), kind);
  }
  add.Choice<PictureKind>("--picture", input.Twin.Picture, kinds,
    "what the twins' mammograms are: for display, evened out for display, raw, or raw with heel "
    "and scatter");
  AddComparisonOptions(add, input.Twin.Registration);
  add("-o,--output", arguments.Output,
    "JSON of all runs, written after each; Ctrl-C leaves what is done");
  add("--export", arguments.Export,
    "folder to write the virtual studies to as a benchmark for any method (DICOM, NIfTI, CSV, with "
    "PROTOCOL.md), in place of running anything")
    ->excludes("--output");
  add("--table", arguments.Table, "CSV with a row for each twin run");
  add("--curve", arguments.Curve,
    "SVG of the share of right results that are trusted against that of wrong ones");
  add.Flag("--resume", arguments.Resume, "go on from the runs in --output");
  AddOverwriteFlag(add, arguments.Overwrite);
}

std::vector<EvidencePhantom> ParsePhantoms(const EvidenceArguments& arguments)
{
  if (arguments.Phantoms.empty())
  {
    return PhantomsOfEvidence(arguments.Data, arguments.LabelSpacingMm);
  }
  std::vector<EvidencePhantom> phantoms;
  for (const std::string& text : arguments.Phantoms)
  {
    EvidencePhantom& phantom = phantoms.emplace_back();
    std::tie(phantom.Name, phantom.Labels.Path) =
      SplitAssignment(text, "--phantom", "NAME=FILE, for example mine=labels.nrrd");
    phantom.Labels.SpacingMm = arguments.LabelSpacingMm;
  }
  return phantoms;
}

/// Those of the named anatomies; all where none is named.
void KeepAnatomies(const std::vector<std::string>& names, std::vector<EvidenceStudy>& studies)
{
  std::vector<std::string> known;
  for (const EvidenceStudy& study : studies)
  {
    if (std::find(known.begin(), known.end(), study.Phantom) == known.end())
    {
      known.push_back(study.Phantom);
    }
  }
  for (const std::string& name : names)
  {
    if (std::find(known.begin(), known.end(), name) == known.end())
    {
      throw InputError(
        "--anatomy: there is no virtual study of '" + name + "'; " + SpellingHint(name, known));
    }
  }
  std::erase_if(studies,
    [&](const EvidenceStudy& study) {
      return !names.empty() && std::find(names.begin(), names.end(), study.Phantom) == names.end();
    });
}

std::vector<EvidenceStudy> WantedStudies(const EvidenceArguments& arguments,
  const std::vector<EvidencePhantom>& phantoms)
{
  std::vector<EvidenceStudy> studies =
    StudiesOfEvidence(phantoms, arguments.Data, arguments.Studies);
  KeepAnatomies(arguments.Anatomies, studies);
  // Others than those that tables are of.
  for (EvidenceStudy& study : studies)
  {
    study.Options.Seed += arguments.Evidence.Twin.Seed - EvidenceArguments().Evidence.Twin.Seed;
    study.Options.Projections = arguments.Projections;
    study.Registration = arguments.Evidence.Twin.Registration;
  }
  return studies;
}

void AddWanted(EvidenceArguments& arguments)
{
  EvidenceOptions& input = arguments.Evidence;
  input.Phantoms = ParsePhantoms(arguments);
  for (const EvidencePhantom& phantom : input.Phantoms)
  {
    CheckInputFile(phantom.Labels.Path);
  }
  std::erase_if(input.Kinds, [&](TwinKind kind) { return !arguments.Wants(NameOf(kind)); });
  for (const TwinKind kind : WrongPairs)
  {
    if (arguments.Wants("wrong-pairs") || arguments.Wants(NameOf(kind)))
    {
      input.Kinds.push_back(kind);
    }
  }
  input.SearchTwins = arguments.Wants("search") ? input.SearchTwins : 0;
  if (arguments.Wants("landmarks"))
  {
    input.Landmarks = LandmarksOfEvidence(arguments.Data);
    for (EvidenceLandmarks& landmarks : input.Landmarks)
    {
      landmarks.Case.Options = input.Twin.Registration;
    }
  }
  if (arguments.Wants("mammograms"))
  {
    input.Mammograms = MammogramsOfEvidence(input.Phantoms, arguments.Data);
    for (EvidenceMammogram& mammogram : input.Mammograms)
    {
      CheckInputFile(mammogram.Case.Mammograms.front());
      mammogram.Case.Options = input.Twin.Registration;
    }
  }
  if (arguments.Wants("studies"))
  {
    input.Studies = WantedStudies(arguments, input.Phantoms);
  }
}

/// It is written again with the next run's figures.
void WriteAndReserve(const std::string& path, const std::string& text)
{
  WriteAtomicFile(path, text);
  ReserveFile(path);
}

void RunExport(const EvidenceArguments& arguments)
{
  const std::vector<EvidenceStudy> studies = WantedStudies(arguments, ParsePhantoms(arguments));
  for (const EvidenceStudy& study : studies)
  {
    if (study.Mri.empty()) // a folder, else
    {
      CheckInputFile(study.Labels.Path);
    }
  }
  const std::vector<BaselineScore> scores =
    ExportBenchmark(studies, arguments.Export, MakeProgressBar());
  std::printf("%s: %zu studies; see PROTOCOL.md\n", arguments.Export.c_str(), studies.size());
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

void Run(EvidenceArguments& arguments)
{
  if (!arguments.Export.empty())
  {
    RunExport(arguments);
    return;
  }
  if (arguments.Output.empty())
  {
    throw CLI::RequiredError("--output or --export");
  }
  const bool wantsData = arguments.Phantoms.empty() || arguments.Wants("mammograms");
  if (wantsData && !fs::is_directory(arguments.Data))
  {
    throw InputError(
      "data: expected the folder of public test data, found '" + arguments.Data + "'");
  }
  CheckOutputFile(arguments.Output, arguments.Overwrite || arguments.Resume);
  if (!arguments.Table.empty())
  {
    CheckOutputFile(arguments.Table, arguments.Overwrite || arguments.Resume);
  }
  if (!arguments.Curve.empty())
  {
    CheckOutputFile(arguments.Curve, arguments.Overwrite || arguments.Resume);
  }
  AddWanted(arguments);
  const std::string settings = EvidenceSettings(arguments.Evidence);
  RegistrationEvidence evidence;
  if (arguments.Resume && fs::exists(arguments.Output))
  {
    evidence = ReadEvidence(arguments.Output, settings);
  }
  const auto keep = [&]()
  {
    WriteAndReserve(arguments.Output, EvidenceJson(evidence, settings));
    if (!arguments.Table.empty())
    {
      WriteAndReserve(arguments.Table, TwinTable(evidence.Twins));
    }
    if (!arguments.Curve.empty())
    {
      WriteAndReserve(arguments.Curve, TrustCurveSvg(evidence));
    }
  };
  try
  {
    GatherEvidence(arguments.Evidence, evidence, keep, MakeProgressBar());
  }
  catch (const Interrupted&)
  {
    std::fputs(EvidenceTables(evidence).c_str(), stdout);
    std::fprintf(stderr, "mammoray: note: --resume goes on from %s\n", arguments.Output.c_str());
    throw;
  }
  keep();
  std::fputs(EvidenceTables(evidence).c_str(), stdout);
}
}

void AddEvidenceCommand(CLI::App& application)
{
  AddCommand<EvidenceArguments>(application, "evidence",
    "Measure how well registration works, on breasts whose truth is known; prints tables", Declare,
    Run);
}
}
