// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/StudyAnswers.h"

#include "Private/CsvRows.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/ResultFile.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace mammoray
{
namespace
{
/// Size of a view's square pixels, mm, from the two points that lie farthest apart in its picture:
/// the truth has each point both on the receptor and in pixels.
double PixelSizeMm(const TrueView& view)
{
  double farthest = 0;
  double sizeMm = 0;
  for (std::size_t a = 0; a < view.Pixels.size(); ++a)
  {
    for (std::size_t b = 0; b < a; ++b)
    {
      const double pixels =
        std::hypot(view.Pixels[a][0] - view.Pixels[b][0], view.Pixels[a][1] - view.Pixels[b][1]);
      if (pixels > farthest)
      {
        farthest = pixels;
        sizeMm = std::hypot(view.Receptor[a][0] - view.Receptor[b][0],
                   view.Receptor[a][1] - view.Receptor[b][1]) /
          pixels;
      }
    }
  }
  if (!(sizeMm > 0))
  {
    throw InputError(
      "truth: expected points at different places of the view " + view.View + ", found none");
  }
  return sizeMm;
}

AnswerScore ScoreView(const TrueView& view, const std::vector<const StudyAnswer*>& answers)
{
  const double sizeMm = PixelSizeMm(view);
  const bool inSpace = std::all_of(answers.begin(), answers.end(),
    [](const StudyAnswer* answer) { return answer->Gantry.has_value(); });
  AnswerScore score;
  score.View = view.View;
  std::vector<bool> answered(view.Pixels.size(), false);
  for (const StudyAnswer* answer : answers)
  {
    const std::size_t point = answer->Point;
    answered[point] = true;
    PointErrors& errors = view.Receptor[point][1] < 0 ? score.Behind : score.Imaged;
    const double onReceptorMm = sizeMm *
      std::hypot(answer->Pixel[0] - view.Pixels[point][0],
        answer->Pixel[1] - view.Pixels[point][1]);
    if (inSpace)
    {
      errors.Add(*answer->Gantry - view.Gantry[point], onReceptorMm);
    }
    else
    {
      errors.OnReceptorMm.push_back(onReceptorMm);
    }
  }
  for (std::size_t point = 0; point < answered.size(); ++point)
  {
    score.Missing += !answered[point] && view.Receptor[point][1] >= 0 ? 1 : 0;
  }
  return score;
}
}

std::vector<StudyAnswer> ReadStudyAnswers(const std::string& path)
{
  const CsvRows read =
    ReadCsvRows(path, { "view,point,column,row", "view,point,column,row,x,y,z" });
  std::vector<StudyAnswer> answers;
  std::set<std::pair<std::string, std::size_t>> known;
  for (const CsvRow& row : read.Rows)
  {
    StudyAnswer& answer = answers.emplace_back();
    answer.View = row.Fields[0];
    if (answer.View != "CC" && answer.View != "MLO")
    {
      throw InputError(read.Refusal(row, "the view CC or MLO"));
    }
    const double point = read.Number(row, 1);
    if (!(point >= 0 && point < 1e9 && point == std::floor(point)))
    {
      throw InputError(read.Refusal(row, "a point's number, from 0 on"));
    }
    answer.Point = static_cast<std::size_t>(point);
    if (!known.insert({ answer.View, answer.Point }).second)
    {
      throw InputError(read.Refusal(row, "each point once in a view"));
    }
    answer.Pixel = { read.Number(row, 2), read.Number(row, 3) };
    if (read.Header == 1)
    {
      answer.Gantry = Vector3{ read.Number(row, 4), read.Number(row, 5), read.Number(row, 6) };
    }
  }
  return answers;
}

std::vector<AnswerScore> ScoreAnswers(const StudyTruth& truth,
  const std::vector<StudyAnswer>& answers)
{
  std::map<const TrueView*, std::vector<const StudyAnswer*>> byView;
  for (const StudyAnswer& answer : answers)
  {
    const TrueView* view = truth.FindView(answer.View);
    if (!view || answer.Point >= truth.MriPoints.size())
    {
      throw InputError("answers: expected the study's " + std::to_string(truth.MriPoints.size()) +
        " points in its views, found point " + std::to_string(answer.Point) + " in " + answer.View);
    }
    byView[view].push_back(&answer);
  }
  std::vector<AnswerScore> scores;
  for (const TrueView& view : truth.Views)
  {
    if (byView.count(&view) != 0)
    {
      scores.push_back(ScoreView(view, byView[&view]));
    }
  }
  if (scores.empty())
  {
    throw InputError("answers: expected a point in a view, found none");
  }
  return scores;
}

AnswerScore ScoreResult(const StudyTruth& truth, const ResultFile& result,
  const BreastInUnit& breast)
{
  const TrueView* view = truth.FindView(result.Mammogram.View);
  if (!view)
  {
    throw InputError(result.Folder +
      ": expected a result of one of the study's mammograms, found the view '" +
      result.Mammogram.View + "'");
  }
  AnswerScore score;
  score.View = view->View;
  const std::vector<Vector3> moved = Displace(truth.MriPoints, breast.Uncompressed);
  for (std::size_t index = 0; index < moved.size(); ++index)
  {
    const Vector3 found = breast.Placed.ToGantry(moved[index]);
    const ReceptorPoint shadow = ShadowOf(found, breast.Unit);
    PointErrors& errors = view->Receptor[index][1] < 0 ? score.Behind : score.Imaged;
    errors.Add(found - view->Gantry[index],
      std::hypot(shadow[0] - view->Receptor[index][0], shadow[1] - view->Receptor[index][1]));
  }
  return score;
}
}
