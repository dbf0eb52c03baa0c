// SPDX-License-Identifier: Apache-2.0
#include "StudyRuns.h"

#include "PatientTissue.h"
#include "PointCoverage.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScratchFolder.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/Study/StudyAnswers.h"
#include "mammoray/Study/StudyCase.h"

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

/// Material indices of a patient's breast, DICOM LPS.
LabelVolume BreastOfMri(const PlannedStudy& study, const MaterialTable& table,
  const ProgressCallback& progress)
{
  const Study found = ReadStudy(study.Mri);
  StudyChoice choice;
  for (const StudySeries& series : found.Series)
  {
    if (series.LeftOut.empty() && !choice.Undetermined)
    {
      choice.Undetermined = series;
    }
  }
  if (!choice.Undetermined)
  {
    throw InputError(study.Mri + ": expected a T1-weighted MRI, found none");
  }
  choice.Laterality = study.Options.Laterality;
  LabelVolume breast = SegmentStudy(choice, table, progress).Breast;
  HoldCutTissue(breast, table.Fixed());
  return FlattenChest(FreeOfCoil(std::move(breast), table.Fixed()), table.Fixed());
}

nlohmann::json ErrorsJson(const PointErrors& errors)
{
  return { { "in3dMm", errors.InSpaceMm }, { "onReceptorMm", errors.OnReceptorMm },
    { "alongBeamMm", errors.AlongBeamMm } };
}

/// Errors of the imaged points' coordinates relative to their standard deviations.
PointCoverage CoverageOf(const StudyTruth& truth, const TrueView& view, const BreastInUnit& breast)
{
  PointCoverage coverage(breast);
  const std::vector<Vector3> moved = Displace(truth.MriPoints, breast.Uncompressed);
  for (std::size_t index = 0; index < moved.size(); ++index)
  {
    if (view.Receptor[index][1] >= 0)
    {
      coverage.Add(truth.MriPoints[index],
        breast.Placed.ToGantry(moved[index]) - view.Gantry[index]);
    }
  }
  return coverage;
}

nlohmann::json ViewsJson(const StudyTruth& truth, const std::string& resultFolder)
{
  nlohmann::json views = nlohmann::json::array();
  for (const ResultFile& result : ReadResultFiles(resultFolder))
  {
    const BreastInUnit breast = ReadBreastInUnit(result);
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    const ExpectedError expected = result.Expected.value_or(ExpectedError{ unknown, unknown });
    const AnswerScore score = ScoreResult(truth, result, breast);
    const PointCoverage coverage = CoverageOf(truth, *truth.FindView(score.View), breast);
    views.push_back({ { "view", score.View }, { "imaged", ErrorsJson(score.Imaged) },
      { "behind", ErrorsJson(score.Behind) }, { "coordinatesWithin", coverage.Share() },
      { "modelErrorNeeded", coverage.ModelErrorNeeded },
      { "meanOutlineDistanceMm", result.After.MeanOutlineDistanceMm },
      { "correlation", result.After.Correlation },
      { "tissueCorrelation", result.After.TissueCorrelation },
      { "expectedMedianMm", expected.MedianMm }, { "expected95Mm", expected.Most95Mm },
      { "trust", NameOf(result.Trust.Level) }, { "reasons", result.Trust.Reasons } });
  }
  return views;
}

/// The middle of the tissue behind a pixel, at rest: the best guess from one mammogram alone. Empty
/// if the X-ray misses the breast.
std::optional<Vector3> MiddleBehind(const RegisteredBreast& breast,
  const std::array<double, 2>& pixel)
{
  std::vector<Vector3> curve;
  for (const RaySegment& segment : breast.ToVolume(pixel[0], pixel[1], 0.5))
  {
    curve.insert(curve.end(), segment.Uncompressed.begin(), segment.Uncompressed.end());
  }
  return curve.empty() ? std::nullopt : std::optional(curve[curve.size() / 2]);
}

/**
 * Adds how far the points that both mammograms show were found in the MRI from where they are, from
 * the true places of their shadows, mm: from CC alone, in the middle of the tissue behind the
 * pixel, and from both (FindInTwoViews).
 */
void MeasureTwoViews(const StudyTruth& truth, const std::string& resultFolder, nlohmann::json& run)
{
  struct Registered
  {
    const TrueView* View;
    ReceptorGrid Grid;
    RegisteredBreast Breast;

    bool Shows(std::size_t point) const { return this->Grid.Contains(this->View->Receptor[point]); }
  };
  std::vector<Registered> views;
  for (const char* name : { "CC", "MLO" })
  {
    const TrueView* view = truth.FindView(name);
    for (const ResultFile& result : ReadResultFiles(resultFolder))
    {
      if (view && result.Mammogram.View == name)
      {
        const BreastInUnit breast = ReadBreastInUnit(result);
        views.push_back({ view, breast.Grid, RegisteredBreast(breast) });
      }
    }
  }
  for (std::size_t index = 0; views.size() == 2 && index < truth.MriPoints.size(); ++index)
  {
    if (!views[0].Shows(index) || !views[1].Shows(index))
    {
      continue;
    }
    const SeenInView first{ &views[0].Breast, views[0].View->Pixels[index] };
    const SeenInView second{ &views[1].Breast, views[1].View->Pixels[index] };
    const std::optional<Vector3> middle = MiddleBehind(*first.Breast, first.Pixel);
    const std::optional<TissueInTwoViews> both = FindInTwoViews(first, second);
    if (middle && both)
    {
      run["oneViewMm"].push_back(Norm(*middle - truth.MriPoints[index]));
      run["bothViewsMm"].push_back(Norm(both->Point - truth.MriPoints[index]));
    }
  }
}
}

StudyTruth MakePlannedStudy(const PlannedStudy& study, const std::string& folder,
  const ProgressCallback& progress)
{
  if (!study.Mri.empty())
  {
    const MaterialTable table = FindMaterialTable(StudyMaterials);
    return MakeVirtualStudy(BreastOfMri(study, table, ShareOf(progress, 0, 0.3)), table,
      AnatomicalAxes::FromCode("LPS"), study.Options, folder, ShareOf(progress, 0.3, 1));
  }
  const MaterialTable table = FindMaterialTable(study.Materials);
  return MakeVirtualStudy(ReadMaterials(study.Labels, table), table,
    AnatomicalAxes::FromCode(study.Orientation), study.Options, folder, progress);
}

nlohmann::json RunStudy(const PlannedStudy& study, const std::string& keepIn,
  const ProgressCallback& progress)
{
  const ScratchFolder scratch;
  const fs::path folder = keepIn.empty()
    ? fs::path(scratch.File("run"))
    : fs::path(keepIn) / (study.Phantom + "-" + std::to_string(study.Options.Seed));
  const std::string resultName = std::string("result-") + NameOf(study.Registration.Comparison);
  if (fs::exists(folder / resultName))
  {
    throw InputError(
      (folder / resultName).string() + ": expected a folder that is not there yet, found it");
  }
  fs::create_directories(folder);
  const std::string made = (folder / "study").string();
  const StudyTruth truth = fs::exists(made + "/truth.json")
    ? ReadStudyTruth(made + "/truth.json")
    : MakePlannedStudy(study, made, ShareOf(progress, 0, 0.2));
  const nlohmann::json none = nlohmann::json::array();
  nlohmann::json run{ { "phantom", study.Phantom }, { "seed", study.Options.Seed },
    { "laterality", std::string(1, study.Options.Laterality) }, { "views", none },
    { "ccAlone", none }, { "projections", none }, { "oneViewMm", none }, { "bothViewsMm", none },
    { "seconds", 0 }, { "failure", "" } };
  const std::string result = (folder / resultName).string();
  const auto begin = std::chrono::steady_clock::now();
  try
  {
    RegistrationCase input;
    input.Options = study.Registration;
    TakeStudy(made + "/export", {}, input);
    const bool sweeps = study.Options.Projections > 1;
    const double both = sweeps ? 0.5 : 1;
    const auto registered = [&](const RegistrationCase& one, double from, double to)
    {
      RegistrationCaseResult found = RunRegistrationCase(one, ShareOf(progress, from, to));
      ReportProgress(progress, to, "registered"); // a search that is stopped gives what it has
      return found;
    };
    const RegistrationCaseResult found = registered(input, 0.2, both);
    run["seconds"] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    WriteRegistrationCase(input, found, result);
    run["views"] = ViewsJson(truth, result);
    MeasureTwoViews(truth, result, run);
    const auto alone = [&](const std::string& mammogram, const std::string& name, double from)
    {
      RegistrationCase one = input;
      one.Mammograms = { mammogram };
      const std::string output = result + name;
      WriteRegistrationCase(one, registered(one, from, from + 0.25), output);
      return ViewsJson(truth, output);
    };
    if (sweeps)
    {
      run["ccAlone"] = alone(input.Mammograms.front(), "-cc", 0.5);
      run["projections"] = alone(made + "/" + StudyProjectionsFile, "-projections", 0.75);
    }
  }
  catch (const InputError& error)
  {
    run["failure"] = error.what();
  }
  catch (const ConvergenceError& error)
  {
    run["failure"] = error.what();
  }
  return run;
}
}
