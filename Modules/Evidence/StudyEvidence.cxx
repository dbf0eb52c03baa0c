// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/StudyEvidence.h"

#include "Private/PatientTissue.h"
#include "Private/PointCoverage.h"
#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScratchFolder.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/Silhouette.h"
#include "mammoray/Study/BreastInUnit.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationCaseWriter.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/Study/StudyCase.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

/**
 * A breast coil squeezes a large breast from both sides: 50 to 65 mm wide and 170 to 190 mm high in
 * uta11-b. What is free of load is about as wide as it is high; so is this one then, by stretching
 * to the sides and shrinking along the body at an unchanged volume. `breast` in DICOM LPS.
 */
LabelVolume FreeOfCoil(LabelVolume breast, const std::vector<bool>& held)
{
  constexpr double MostStretch = 1.8;
  std::array<double, 2> sums{};
  std::array<double, 2> squares{};
  double count = 0;
  breast.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const std::size_t material = breast.Voxels[voxel];
      if (material != 0 && !held[material])
      {
        const Vector3 at = breast.PointAt(i, j, k);
        for (std::size_t axis = 0; axis < 2; ++axis)
        {
          sums[axis] += at[2 * axis];
          squares[axis] += at[2 * axis] * at[2 * axis];
        }
        ++count;
      }
    });
  const auto deviation = [&](std::size_t axis)
  {
    const double mean = sums[axis] / count;
    return std::sqrt(squares[axis] / count - mean * mean);
  };
  const double stretch =
    std::clamp(std::sqrt(deviation(1) / std::max(deviation(0), 1e-9)), 1.0, MostStretch);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const Vector3& direction = breast.Direction[axis];
    breast.Spacing[axis] *= std::abs(direction[0]) > 0.7 ? stretch
      : std::abs(direction[2]) > 0.7                     ? 1 / stretch
                                                         : 1.0;
  }
  return breast;
}

/// The breast of a patient, as tissue.
LabelVolume BreastOfMri(const EvidenceStudy& study, const MaterialTable& table,
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
  return FreeOfCoil(std::move(breast), table.Fixed());
}

StudyViewErrors ErrorsIn(const VirtualStudyTruth& truth, const VirtualView& view,
  const ResultFile& result)
{
  const BreastInUnit breast = ReadBreastInUnit(result);
  const std::vector<Vector3> moved = Displace(truth.MriPoints, breast.Uncompressed);
  StudyViewErrors errors;
  errors.View = view.View;
  errors.MeanOutlineMm = result.After.MeanOutlineDistanceMm;
  errors.Correlation = result.After.Correlation;
  errors.TissueCorrelation = result.After.TissueCorrelation;
  errors.ExpectedMedianMm = result.Expected.MedianMm;
  errors.Expected95Mm = result.Expected.Most95Mm;
  errors.Trust = NameOf(result.Trust.Level);
  errors.Reasons = result.Trust.Reasons;
  PointCoverage coverage(breast);
  for (std::size_t index = 0; index < moved.size(); ++index)
  {
    const Vector3& point = moved[index];
    const Vector3 error = breast.Placed.ToGantry(point) - view.Gantry[index];
    const bool imaged = view.Receptor[index][1] >= 0;
    PointErrors& points = imaged ? errors.Imaged : errors.Behind;
    points.InSpaceMm.push_back(Norm(error));
    points.AlongBeamMm.push_back(std::abs(error[2]));
    if (imaged)
    {
      coverage.Add(truth.MriPoints[index], error);
    }
    const ReceptorPoint shadow =
      ProjectToReceptor({ point[0], point[1], point[2] }, breast.Placed, breast.Unit).front();
    points.OnReceptorMm.push_back(
      std::hypot(shadow[0] - view.Receptor[index][0], shadow[1] - view.Receptor[index][1]));
  }
  errors.CoordinatesWithin = coverage.Share();
  errors.ModelErrorNeeded = std::move(coverage.ModelErrorNeeded);
  return errors;
}
}

VirtualStudyTruth MakeEvidenceStudy(const EvidenceStudy& study, const std::string& folder,
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

std::vector<StudyViewErrors> MeasureStudy(const VirtualStudyTruth& truth,
  const std::string& resultFolder)
{
  std::vector<StudyViewErrors> errors;
  for (const ResultFile& result : ReadResultFiles(resultFolder))
  {
    const auto view = std::find_if(truth.Views.begin(), truth.Views.end(),
      [&](const VirtualView& known) { return known.View == result.Mammogram.View; });
    if (view == truth.Views.end())
    {
      throw InputError(resultFolder +
        ": expected a result of one of the study's mammograms, found "
        "the view '" +
        result.Mammogram.View + "'");
    }
    errors.push_back(ErrorsIn(truth, *view, result));
  }
  return errors;
}

TwoViewErrors MeasureTwoViews(const VirtualStudyTruth& truth, const std::string& resultFolder)
{
  struct Registered
  {
    const VirtualView* View;
    RegisteredBreast Breast;
  };
  std::vector<Registered> views;
  for (const char* name : { "CC", "MLO" })
  {
    const auto view = std::find_if(truth.Views.begin(), truth.Views.end(),
      [&](const VirtualView& known) { return known.View == name; });
    for (const ResultFile& result : ReadResultFiles(resultFolder))
    {
      if (view != truth.Views.end() && result.Mammogram.View == name)
      {
        views.push_back({ &*view, RegisteredBreast(ReadBreastInUnit(result)) });
      }
    }
  }
  TwoViewErrors errors;
  for (std::size_t index = 0; views.size() == 2 && index < truth.MriPoints.size(); ++index)
  {
    if (views[0].View->Receptor[index][1] < 0 || views[1].View->Receptor[index][1] < 0)
    {
      continue;
    }
    const SeenInView first{ &views[0].Breast, views[0].View->Pixels[index] };
    const SeenInView second{ &views[1].Breast, views[1].View->Pixels[index] };
    const std::optional<Vector3> middle = MiddleBehind(first);
    const std::optional<TissueInTwoViews> both = FindInTwoViews(first, second);
    if (middle && both)
    {
      errors.OneViewMm.push_back(Norm(*middle - truth.MriPoints[index]));
      errors.BothViewsMm.push_back(Norm(both->Point - truth.MriPoints[index]));
    }
  }
  return errors;
}

StudyRun RunStudy(const EvidenceStudy& study, const std::string& keepIn,
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
  const VirtualStudyTruth truth = fs::exists(made + "/truth.json")
    ? ReadVirtualStudyTruth(made + "/truth.json")
    : MakeEvidenceStudy(study, made, ShareOf(progress, 0, 0.2));
  StudyRun run;
  run.Phantom = study.Phantom;
  run.Seed = study.Options.Seed;
  run.Laterality = study.Options.Laterality;
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
    run.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    WriteRegistrationCase(input, found, result);
    run.Views = MeasureStudy(truth, result);
    run.Together = MeasureTwoViews(truth, result);
    const auto alone = [&](const std::string& mammogram, const std::string& name, double from)
    {
      RegistrationCase one = input;
      one.Mammograms = { mammogram };
      const std::string output = result + name;
      WriteRegistrationCase(one, registered(one, from, from + 0.25), output);
      return MeasureStudy(truth, output);
    };
    if (sweeps)
    {
      run.CcAlone = alone(input.Mammograms.front(), "-cc", 0.5);
      run.Swept = alone(made + "/" + StudyProjectionsFile, "-projections", 0.75);
    }
  }
  catch (const InputError& error)
  {
    run.Failure = error.what();
  }
  catch (const ConvergenceError& error)
  {
    run.Failure = error.what();
  }
  return run;
}
}
