// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/EvidenceTables.h"

#include "Private/TableText.h"
#include "Private/TrustTables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace mammoray
{
namespace
{
/// A run converges when the median error of its points is below this, mm.
constexpr double ConvergedMm = 3;

/// Of some runs.
struct TwinSummary
{
  int Count = 0;
  int Converged = 0;
  std::size_t ModelCells = 0;
  std::vector<double> Errors;
  std::vector<double> Iterations;
  std::vector<double> Equilibria;
  std::vector<double> Seconds;
  /// By parameter: errors, and how many are within two of their standard deviations.
  std::map<std::string, std::vector<double>> ParameterErrors;
  std::map<std::string, int> Within;
  int WithinAll = 0;
  int ParametersAll = 0;

  void Add(const TwinRun& run)
  {
    ++this->Count;
    this->Converged += run.MedianErrorMm < ConvergedMm ? 1 : 0;
    if (!std::isfinite(run.MedianErrorMm))
    {
      return;
    }
    this->ModelCells = run.ModelCells;
    this->Errors.push_back(run.MedianErrorMm);
    this->Iterations.push_back(run.Iterations);
    this->Equilibria.push_back(run.Equilibria);
    this->Seconds.push_back(run.Seconds);
    for (std::size_t index = 0; index < run.Names.size(); ++index)
    {
      if (std::isfinite(run.Sigma[index]))
      {
        const double error = std::abs(run.Found[index] - run.Truth[index]);
        const int within = error <= 2 * run.Sigma[index] ? 1 : 0;
        this->ParameterErrors[run.Names[index]].push_back(error);
        this->Within[run.Names[index]] += within;
        this->WithinAll += within;
        ++this->ParametersAll;
      }
    }
  }
};

/// By kind, then by phantom, the last of which is "all".
using TwinSummaries = std::map<std::string, std::map<std::string, TwinSummary>>;

constexpr const char* AllPhantoms = "all";

std::string RunTable(const TwinSummaries& summaries)
{
  std::string text = "| twins | phantom | cells | runs | 3D error: median (largest), mm | below 3 "
                     "mm | iterations, median "
                     "(most) | equilibria | time, s | true values within 2 sigma |\n"
                     "|---|---|---|---|---|---|---|---|---|---|\n";
  const auto row = [&](const std::string& kind, const std::string& phantom, const TwinSummary& of)
  {
    text +=
      Line("| %s | %s | %s | %d | %.2f (%.2f) | %d %% | %.0f (%.0f) | %.0f | %.0f | %d %% |\n",
        kind.c_str(), phantom.c_str(),
        phantom == AllPhantoms ? "" : Line("%zu", of.ModelCells).c_str(), of.Count,
        Median(of.Errors), Largest(of.Errors), Percent(of.Converged, of.Count),
        Median(of.Iterations), Largest(of.Iterations), Median(of.Equilibria), Median(of.Seconds),
        Percent(of.WithinAll, of.ParametersAll));
  };
  for (const TwinKind kind : RightTwins)
  {
    const auto found = summaries.find(NameOf(kind));
    if (found == summaries.end())
    {
      continue;
    }
    for (const auto& [phantom, summary] : found->second)
    {
      if (phantom != AllPhantoms)
      {
        row(found->first, phantom, summary);
      }
    }
    row(found->first, AllPhantoms, found->second.at(AllPhantoms));
  }
  return text + "\n";
}

std::string ParameterTable(const TwinSummaries& summaries)
{
  std::string text = "| error: median (largest); true value within 2 sigma |";
  std::string rule = "|---|";
  for (const TwinKind kind : RightTwins)
  {
    if (summaries.count(NameOf(kind)) != 0)
    {
      text += std::string(" ") + NameOf(kind) + " |";
      rule += "---|";
    }
  }
  text += "\n" + rule + "\n";
  for (const RegistrationParameter& parameter : DefaultParameters({}))
  {
    std::string row;
    bool any = false;
    for (const TwinKind kind : RightTwins)
    {
      if (summaries.count(NameOf(kind)) == 0)
      {
        continue;
      }
      const TwinSummary& summary = summaries.at(NameOf(kind)).at(AllPhantoms);
      const auto errors = summary.ParameterErrors.find(parameter.Name);
      const bool found = errors != summary.ParameterErrors.end();
      any = any || found;
      row += found
        ? Line(" %.2f (%.2f); %d %% |", Median(errors->second), Largest(errors->second),
            Percent(summary.Within.at(parameter.Name), static_cast<double>(errors->second.size())))
        : " - |";
    }
    if (any)
    {
      text += "| " + parameter.Name + (parameter.Unit.empty() ? "" : ", " + parameter.Unit) + " |" +
        row + "\n";
    }
  }
  return text + "\n";
}

std::string TwinTables(const std::vector<TwinRun>& runs)
{
  TwinSummaries summaries;
  for (const TwinRun& run : runs)
  {
    if (run.Search == NameOf(TwinSearch::Register) && IsRight(run))
    {
      summaries[run.Kind][run.Phantom].Add(run);
      summaries[run.Kind][AllPhantoms].Add(run);
    }
  }
  return summaries.empty() ? "" : RunTable(summaries) + ParameterTable(summaries);
}

/// Time after `from` until the cost is as low as `cost`; NaN where it never is.
double SecondsTo(const TwinRun& run, double cost, double from)
{
  for (std::size_t index = 0; index < run.IterationCosts.size(); ++index)
  {
    if (run.IterationCosts[index] <= cost)
    {
      return run.IterationSeconds[index] - from;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::string SearchTable(const RegistrationEvidence& evidence)
{
  std::string text =
    "| search | phantom, twin | equilibria | time, s | cost | time to the exact search's cost, s "
    "(without the start) | 3D error, mm |\n|---|---|---|---|---|---|---|\n";
  bool any = false;
  std::vector<double> ratios;
  for (const TwinRun& exact : evidence.Twins)
  {
    if (exact.Search != NameOf(TwinSearch::Exact) || exact.IterationCosts.empty())
    {
      continue;
    }
    // As low: what the search itself takes for nothing.
    const double reached = exact.IterationCosts.back() + 0.125;
    // All searches have the same start.
    const double begin = exact.IterationSeconds.front();
    const double ownSeconds = SecondsTo(exact, reached, begin);
    for (const TwinSearch search :
      { TwinSearch::Exact, TwinSearch::CentralDifferences, TwinSearch::Annealing })
    {
      if (const TwinRun* run =
            evidence.Find(exact.Phantom, exact.Kind, NameOf(search), exact.Number))
      {
        const double seconds = SecondsTo(*run, reached, begin);
        text += Line("| %s | %s, %d | %d | %.1f | %.2f | %s | %.2f |\n", NameOf(search),
          run->Phantom.c_str(), run->Number, run->Equilibria, run->Seconds,
          run->IterationCosts.empty() ? std::numeric_limits<double>::quiet_NaN()
                                      : run->IterationCosts.back(),
          std::isfinite(seconds) ? Line("%.1f", seconds).c_str() : "never", run->MedianErrorMm);
        if (search == TwinSearch::CentralDifferences && std::isfinite(seconds) && ownSeconds > 0)
        {
          ratios.push_back(seconds / ownSeconds);
        }
        any = true;
      }
    }
  }
  if (!ratios.empty())
  {
    text += Line("\nExact derivatives get there %.1f times as fast as differences (median).\n",
      Median(ratios));
  }
  return any ? text + "\n" : "";
}

std::string LandmarkTable(const LandmarkEvidence& found)
{
  std::string text = Line("| %s, imaged landmarks: median (largest) error, mm | in 3D | on the "
                          "receptor |\n|---|---|---|\n",
    found.Name.c_str());
  for (const LandmarkSummary& row : found.Rows)
  {
    text += Line("| %s | %.2f (%.2f) | %.2f (%.2f) |\n", row.Method.c_str(), row.InSpace.Median,
      row.InSpace.Largest, row.OnReceptor.Median, row.OnReceptor.Largest);
  }
  text += "\n";
  if (std::isfinite(found.GlandDice))
  {
    text +=
      Line("Gland overlap (Dice) %.2f, at rest %.2f. ", found.GlandDice, found.GlandDiceAtRest);
  }
  return text +
    Line("Trust: %s, expected: %s mm. %d iterations, %d equilibria, %.0f s.\n\n",
      found.Trust.c_str(),
      std::isfinite(found.ExpectedMedianMm) ? Line("%.2f", found.ExpectedMedianMm).c_str() : "-",
      found.Iterations, found.Equilibria, found.Seconds);
}

std::string MammogramTable(const std::vector<MammogramEvidence>& found)
{
  std::string text =
    "| real mammogram with another breast | outline: mean (largest), mm | correlation, of tissue "
    "| trust that the report claims | time, s |\n|---|---|---|---|---|\n";
  for (const MammogramEvidence& row : found)
  {
    text += row.Failure.empty()
      ? Line("| %s | %.2f (%.2f) | %.2f, %.2f | %s | %.0f |\n", row.Name.c_str(), row.MeanOutlineMm,
          row.LargestOutlineMm, row.Correlation, row.TissueCorrelation, row.Trust.c_str(),
          row.Seconds)
      : Line("| %s | - | - | no result: %s | - |\n", row.Name.c_str(), row.Failure.c_str());
  }
  return text + "\n";
}

void Append(std::vector<double>& all, const std::vector<double>& more)
{
  all.insert(all.end(), more.begin(), more.end());
}

std::string MedianCell(const std::vector<double>& errors)
{
  return errors.empty() ? " - |"
                        : Line(" %.2f (%.2f) |", Quantile(errors, 0.5), Quantile(errors, 0.95));
}

std::string MedianText(const std::vector<double>& errors, const char* end)
{
  return errors.empty() ? std::string(" -") + end
                        : Line(" %.2f mm in the middle, 95 %% below %.2f mm%s",
                            Quantile(errors, 0.5), Quantile(errors, 0.95), end);
}

std::string StudyTable(const std::vector<StudyRun>& runs)
{
  std::string text =
    "| virtual study | side | CC, in 3D: median (95 %), mm | MLO, in 3D | on the receptor | not "
    "imaged, in 3D | trust | time, s |\n|---|---|---|---|---|---|---|---|\n";
  PointErrors imaged;
  std::vector<double> behind;
  std::vector<double> seconds;
  int refused = 0;
  for (const StudyRun& run : runs)
  {
    text += Line("| %s, %u | %s |", run.Phantom.c_str(), run.Seed,
      run.Laterality == 'L' ? "left" : "right");
    if (!run.Failure.empty())
    {
      ++refused;
      text += " no result: " + run.Failure + " | | | | | |\n";
      continue;
    }
    std::vector<double> onReceptor;
    std::vector<double> unseen;
    std::string trust;
    for (const char* name : { "CC", "MLO" })
    {
      const auto view = std::find_if(run.Views.begin(), run.Views.end(),
        [&](const StudyViewErrors& errors) { return errors.View == name; });
      if (view == run.Views.end())
      {
        text += " - |";
        continue;
      }
      text += MedianCell(view->Imaged.InSpaceMm);
      Append(imaged.InSpaceMm, view->Imaged.InSpaceMm);
      Append(onReceptor, view->Imaged.OnReceptorMm);
      Append(unseen, view->Behind.InSpaceMm);
      trust += (trust.empty() ? "" : ", ") + view->Trust;
    }
    Append(imaged.OnReceptorMm, onReceptor);
    Append(behind, unseen);
    seconds.push_back(run.Seconds);
    text += MedianCell(onReceptor) + MedianCell(unseen) +
      Line(" %s | %.0f |\n", trust.c_str(), run.Seconds);
  }
  return text +
    Line("\nAll %zu imaged points of %zu studies: in 3D%s on the receptor%s those behind the "
         "receptor's edge (%zu):%s %.0f s in the middle. %d without a result.\n\n",
      imaged.InSpaceMm.size(), runs.size() - static_cast<std::size_t>(refused),
      MedianText(imaged.InSpaceMm, ";").c_str(), MedianText(imaged.OnReceptorMm, ";").c_str(),
      behind.size(), MedianText(behind, ".").c_str(), Quantile(seconds, 0.5), refused);
}

/// What the model's own error must be multiplied by for two deviations to hold 95 % of the
/// coordinates of studies whose anatomy and number are wanted; NaN where there are none.
double ModelErrorFor95(const std::vector<StudyRun>& runs,
  const std::function<bool(const StudyRun&)>& wanted)
{
  std::vector<double> needed;
  for (const StudyRun& run : runs)
  {
    if (!wanted(run))
    {
      continue;
    }
    for (const StudyViewErrors& view : run.Views)
    {
      Append(needed, view.ModelErrorNeeded);
    }
  }
  return needed.empty() ? std::numeric_limits<double>::quiet_NaN() : Quantile(needed, 0.95);
}

/// What the model's own error is calibrated by: one half of the numbers and the other.
std::string ModelErrorText(const std::vector<StudyRun>& runs)
{
  const auto half = [&](std::uint32_t odd)
  { return ModelErrorFor95(runs, [odd](const StudyRun& run) { return run.Seed % 2 == odd; }); };
  const double even = half(0);
  const double odd = half(1);
  return std::isfinite(even) && std::isfinite(odd)
    ? Line("For 95 %%: the model's own error times %.2f by studies of even numbers, times %.2f by "
           "those of odd ones.\n\n",
        even, odd)
    : "";
}

/// Of the points' coordinates and of the parameters, by anatomy.
std::string CoverageTable(const RegistrationEvidence& evidence)
{
  struct Shares
  {
    std::vector<double> Points;
    TwinSummary Runs;
  };
  std::map<std::string, std::array<Shares, 2>> all; // twins, studies
  const auto addPoints = [&](const std::string& phantom, std::size_t column, double share)
  {
    if (std::isfinite(share))
    {
      all[phantom][column].Points.push_back(share);
      all[AllPhantoms][column].Points.push_back(share);
    }
  };
  for (const TwinRun& run : evidence.Twins)
  {
    if (run.Search != NameOf(TwinSearch::Register) || !IsRight(run))
    {
      continue;
    }
    addPoints(run.Phantom, 0, run.CoordinatesWithin);
    all[run.Phantom][0].Runs.Add(run);
    all[AllPhantoms][0].Runs.Add(run);
  }
  for (const StudyRun& run : evidence.Studies)
  {
    for (const StudyViewErrors& view : run.Views)
    {
      addPoints(run.Phantom, 1, view.CoordinatesWithin);
    }
  }
  if (all.empty())
  {
    return "";
  }
  std::string text = "| within 2 sigma | parameters, twins | points' coordinates, twins | points' "
                     "coordinates, studies | of studies 95 % with the model's own error times "
                     "|\n|---|---|---|---|---|\n";
  const auto cell = [](const std::vector<double>& shares)
  {
    double sum = 0;
    for (const double share : shares)
    {
      sum += share;
    }
    return shares.empty()
      ? std::string("-")
      : Line("%.1f %% (%zu)", 100 * sum / static_cast<double>(shares.size()), shares.size());
  };
  for (const auto& [phantom, columns] : all)
  {
    const TwinSummary& runs = columns[0].Runs;
    const double times = ModelErrorFor95(evidence.Studies,
      [&name = phantom](const StudyRun& run)
      { return name == AllPhantoms || name == run.Phantom; });
    text += Line("| %s | %s | %s | %s | %s |\n", phantom.c_str(),
      runs.ParametersAll > 0
        ? Line("%.1f %% (%d)", 100.0 * runs.WithinAll / runs.ParametersAll, runs.ParametersAll)
            .c_str()
        : "-",
      cell(columns[0].Points).c_str(), cell(columns[1].Points).c_str(),
      std::isfinite(times) ? Line("%.2f", times).c_str() : "-");
  }
  return text + "\n" + ModelErrorText(evidence.Studies);
}

/// What a second mammogram adds of the place along the X-ray.
std::string TwoViewText(const std::vector<StudyRun>& runs)
{
  TwoViewErrors all;
  for (const StudyRun& run : runs)
  {
    Append(all.OneViewMm, run.Together.OneViewMm);
    Append(all.BothViewsMm, run.Together.BothViewsMm);
  }
  return all.OneViewMm.empty()
    ? ""
    : Line("From the places of %zu shadows back into the MRI: from CC alone (the middle of the "
           "tissue behind it)%s from CC and MLO%s\n\n",
        all.OneViewMm.size(), MedianText(all.OneViewMm, ";").c_str(),
        MedianText(all.BothViewsMm, ".").c_str());
}

/// What a second mammogram and what projections of one compression add to a CC.
std::string SweepTable(const std::vector<StudyRun>& runs)
{
  struct Row
  {
    const char* Name;
    PointErrors Errors;
    std::vector<double> Within;
  };
  std::vector<Row> rows{ { "CC alone", {}, {} }, { "CC with MLO", {}, {} },
    { "projections of the CC's compression", {}, {} } };
  const auto add = [](Row& row, const std::vector<StudyViewErrors>& views)
  {
    for (const StudyViewErrors& view : views)
    {
      if (view.View == "CC")
      {
        Append(row.Errors.InSpaceMm, view.Imaged.InSpaceMm);
        Append(row.Errors.AlongBeamMm, view.Imaged.AlongBeamMm);
        Append(row.Errors.OnReceptorMm, view.Imaged.OnReceptorMm);
        row.Within.push_back(view.CoordinatesWithin);
      }
    }
  };
  for (const StudyRun& run : runs)
  {
    if (!run.Swept.empty())
    {
      add(rows[0], run.CcAlone);
      add(rows[1], run.Views);
      add(rows[2], run.Swept);
    }
  }
  if (rows[2].Errors.InSpaceMm.empty())
  {
    return "";
  }
  std::string text =
    Line("| imaged points of %zu studies' CC: median (95 %%), mm | in 3D | along the beam | on the "
         "receptor | coordinates within 2 sigma |\n|---|---|---|---|---|\n",
      rows[2].Within.size());
  for (const Row& row : rows)
  {
    text += std::string("| ") + row.Name + " |" + MedianCell(row.Errors.InSpaceMm) +
      MedianCell(row.Errors.AlongBeamMm) + MedianCell(row.Errors.OnReceptorMm) +
      Line(" %.1f %% |\n", 100 * Summarise(row.Within).Mean);
  }
  return text + "\n";
}

/// Errors beside what the results themselves expect.
std::string ExpectedText(const std::vector<StudyRun>& runs)
{
  std::vector<double> medians;
  std::vector<double> below;
  for (const StudyRun& run : runs)
  {
    for (const StudyViewErrors& view : run.Views)
    {
      const std::vector<double>& errors = view.Imaged.InSpaceMm;
      if (std::isfinite(view.ExpectedMedianMm) && !errors.empty())
      {
        medians.push_back(Quantile(errors, 0.5) / view.ExpectedMedianMm);
        below.push_back(static_cast<double>(std::count_if(errors.begin(), errors.end(),
                          [&](double error) { return error <= view.Expected95Mm; })) /
          static_cast<double>(errors.size()));
      }
    }
  }
  return medians.empty()
    ? ""
    : Line("Median error over what the result expects: %.2f in the middle of %zu views (%.2f to "
           "%.2f); %.1f %% of the points lie within what 95 %% are expected to.\n\n",
        Quantile(medians, 0.5), medians.size(), Quantile(medians, 0), Quantile(medians, 1),
        100 * Summarise(below).Mean);
}
}

std::string TwinTable(const std::vector<TwinRun>& runs)
{
  std::string text = "phantom,kind,search,number,median_error_mm,largest_error_mm,outline_mm,"
                     "correlation,iterations,equilibria,seconds,converged";
  for (const RegistrationParameter& parameter : DefaultParameters({}))
  {
    for (const char* what : { "truth", "start", "found", "sigma" })
    {
      text += "," + parameter.Name + "_" + what;
    }
  }
  text += "\n";
  for (const TwinRun& run : runs)
  {
    text += run.Phantom + "," + run.Kind + "," + run.Search +
      Line(",%d,%.4f,%.4f,%.4f,%.4f,%d,%d,%.2f,%d", run.Number, run.MedianErrorMm,
        run.LargestErrorMm, run.MeanOutlineMm, run.Correlation, run.Iterations, run.Equilibria,
        run.Seconds, run.Converged ? 1 : 0);
    for (std::size_t index = 0; index < run.Names.size(); ++index)
    {
      text += Line(",%.5f,%.5f,%.5f,%.5f", run.Truth[index], run.Start[index], run.Found[index],
        run.Sigma[index]);
    }
    text += "\n";
  }
  return text;
}

std::string EvidenceTables(const RegistrationEvidence& evidence)
{
  std::string text;
  for (const LandmarkEvidence& landmarks : evidence.Landmarks)
  {
    text += LandmarkTable(landmarks);
  }
  text += TwinTables(evidence.Twins) + SearchTable(evidence);
  if (!evidence.Mammograms.empty())
  {
    text += MammogramTable(evidence.Mammograms);
  }
  if (!evidence.Studies.empty())
  {
    text += StudyTable(evidence.Studies) + ExpectedText(evidence.Studies) +
      TwoViewText(evidence.Studies) + SweepTable(evidence.Studies);
  }
  return text + CoverageTable(evidence) + TrustTable(evidence) + ScoreText(evidence);
}
}
