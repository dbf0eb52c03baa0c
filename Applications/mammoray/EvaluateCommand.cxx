// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OutputFiles.h"
#include "SharedOptions.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/Study/StudyAnswers.h"

#include "vtkUnstructuredGrid.h"

#include <cstdio>
#include <optional>

namespace mammoray
{
namespace
{
struct EvaluateArguments
{
  std::string Result;
  std::string Landmarks;
  std::string SecondReader;
  /// A virtual study's truth.json.
  std::string Study;
  std::string Answers;
  std::string TruthOrientation = "LPS";
  Vector3 TruthOrigin{ 0, 0, 0 };
  LandmarkTruth Truth;
};

void Declare(const OptionList& add, EvaluateArguments& arguments)
{
  add(Shared::Result, arguments.Result);
  add.File("--landmarks", arguments.Landmarks,
    "CSV with ux,uy,uz,cx,cy,cz and imaged, mm\n(uncompressed in the frame of the label volume, "
    "compressed in the frame of the truth; imaged is 0 or 1 and may be left out)");
  add
    .File("--second-reader", arguments.SecondReader,
      "the same landmarks in the same order, marked by somebody else\n(how far two readers' marks "
      "lie apart is printed beside the errors)")
    ->needs("--landmarks");
  add
    .File("--truth", arguments.Study,
      "truth.json of a virtual study, in place of --landmarks\n(of mammoray-validate; for the "
      "result "
      "of 'register --study' on its export)")
    ->excludes("--landmarks");
  add
    .File("--answers", arguments.Answers,
      "CSV of any method's answers to --truth, in place of --result\n(view,point,column,row, or "
      "view,point,column,row,x,y,z: pixels; gantry frame, mm)")
    ->needs("--truth")
    ->excludes("--result");
  const OptionList expert = add.Expert();
  expert("--truth-orientation", arguments.TruthOrientation,
    "directions of the truth frame's axes, e.g. LPS or ALS");
  expert.Numbers("--truth-origin", arguments.TruthOrigin, "X Y Z",
    "the gantry frame's origin in the truth's frame, mm");
  expert("--truth-source-to-detector", arguments.Truth.SourceToDetectorMm, Positive("mm"),
    "source to detector distance of the truth");
}

void PrintRow(const std::string& method, const char* group, const std::vector<double>& inSpaceMm,
  const std::vector<double>& onReceptorMm)
{
  const ErrorSummary space = Summarise(inSpaceMm);
  const ErrorSummary receptor = Summarise(onReceptorMm);
  std::printf("%-36s %-10s %3d  %7.2f %7.2f %7.2f   %7.2f %7.2f %7.2f\n", method.c_str(), group,
    space.Count, space.Median, space.Mean, space.Largest, receptor.Median, receptor.Mean,
    receptor.Largest);
}

void PrintPointErrors(const std::string& view, const char* group, const PointErrors& errors)
{
  if (errors.OnReceptorMm.empty())
  {
    return;
  }
  std::printf("%-8s %-7s %6zu ", view.c_str(), group, errors.OnReceptorMm.size());
  for (const std::vector<double>& of : { errors.InSpaceMm, errors.OnReceptorMm })
  {
    if (of.empty()) // the method gives no depth
    {
      std::printf(" %7s %7s %7s  ", "-", "-", "-");
      continue;
    }
    std::printf(" %7.2f %7.2f %7.2f  ", Quantile(of, 0.5), Quantile(of, 0.95), Quantile(of, 1));
  }
  std::printf("\n");
}

std::vector<AnswerScore> ScoresOf(const EvaluateArguments& arguments)
{
  const StudyTruth truth = ReadStudyTruth(arguments.Study);
  if (!arguments.Answers.empty())
  {
    return ScoreAnswers(truth, ReadStudyAnswers(arguments.Answers));
  }
  std::vector<AnswerScore> scores;
  for (const ResultFile& result : ReadResultFiles(arguments.Result))
  {
    scores.push_back(ScoreResult(truth, result, ReadBreastInUnit(result)));
  }
  return scores;
}

void PrintStudyErrors(const EvaluateArguments& arguments)
{
  const std::vector<AnswerScore> scores = ScoresOf(arguments);
  std::printf("%-16s %6s  %23s   %23s\n", "error, mm", "", "in 3D", "on the receptor");
  std::printf("%-8s %-7s %6s  %7s %7s %7s   %7s %7s %7s\n", "view", "", "points", "median", "95 %",
    "max", "median", "95 %", "max");
  for (const AnswerScore& score : scores)
  {
    PrintPointErrors(score.View, "imaged", score.Imaged);
    PrintPointErrors(score.View, "not", score.Behind);
    if (score.Missing > 0)
    {
      std::printf("%-8s %zu imaged points were not answered\n", score.View.c_str(), score.Missing);
    }
  }
}

void Run(EvaluateArguments& arguments)
{
  if (arguments.Result.empty() && arguments.Answers.empty())
  {
    throw CLI::RequiredError("--result or --answers");
  }
  if (!arguments.Study.empty())
  {
    PrintStudyErrors(arguments);
    return;
  }
  if (arguments.Landmarks.empty())
  {
    throw CLI::RequiredError("--landmarks or --truth");
  }
  const ResultFile result = ReadResultFile(arguments.Result);
  const auto grid = ReadBreastInUnit(result).Uncompressed;
  const std::vector<Landmark> landmarks = ReadLandmarks(arguments.Landmarks);
  const AnatomicalAxes axes = AnatomicalAxes::FromCode(arguments.TruthOrientation);
  arguments.Truth.Placed = { arguments.TruthOrigin, axes.Left, axes.Anterior, axes.Superior };
  const std::vector<LandmarkErrors> methods =
    EvaluateLandmarks(landmarks, arguments.Truth, grid, result.Placed, result.Unit);
  std::optional<ReaderDistances> apart;
  if (!arguments.SecondReader.empty())
  {
    apart = DistancesBetween(landmarks, ReadLandmarks(arguments.SecondReader), arguments.Truth);
  }

  std::printf("Landmark error, mm             (landmarks are never used to fit)\n");
  std::printf("%-36s %-10s %3s  %23s   %23s\n", "", "", "", "in 3D", "on the receptor");
  std::printf("%-36s %-10s %3s  %7s %7s %7s   %7s %7s %7s\n", "method", "landmarks", "n", "median",
    "mean", "max", "median", "mean", "max");
  for (const LandmarkErrors& errors : methods)
  {
    PrintRow(errors.Method, "imaged", errors.Imaged.InSpaceMm, errors.Imaged.OnReceptorMm);
    PrintRow("", "all", errors.All.InSpaceMm, errors.All.OnReceptorMm);
  }
  if (apart)
  {
    PrintRow("two readers, compressed", "all", apart->Compressed, apart->OnReceptor);
    const ErrorSummary before = Summarise(apart->Uncompressed);
    std::printf("%-36s %-10s %3d  %7.2f %7.2f %7.2f\n", "two readers, uncompressed", "all",
      before.Count, before.Median, before.Mean, before.Largest);
  }
  std::printf("Mean distance of the outlines: %.2f mm\n", result.After.MeanOutlineDistanceMm);
}
}

void AddEvaluateCommand(CLI::App& application)
{
  AddCommand<EvaluateArguments>(application, "evaluate",
    "Measure a registration's error at landmarks known before and after compression",
    "evaluate --result result --landmarks landmarks.csv", Declare, Run);
}
}
