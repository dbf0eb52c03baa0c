// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/EvidenceTables.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <map>

namespace mammoray
{
namespace
{
/// A run converges when the median error of its points is below this, mm.
constexpr double ConvergedMm = 3;

/// One line of text.
__attribute__((format(printf, 1, 2))) std::string Line(const char* format, ...)
{
  char text[1000];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

double Median(const std::vector<double>& values)
{
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : Summarise(values).Median;
}

double Largest(const std::vector<double>& values)
{
  return values.empty() ? std::numeric_limits<double>::quiet_NaN()
                        : *std::max_element(values.begin(), values.end());
}

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

int Percent(double part, double whole)
{
  return whole > 0 ? static_cast<int>(std::lround(100 * part / whole)) : 0;
}

/// By kind, then by phantom, the last of which is "all".
using TwinSummaries = std::map<std::string, std::map<std::string, TwinSummary>>;

constexpr const char* AllPhantoms = "all";
constexpr TwinKind AllKinds[] = { TwinKind::Plain, TwinKind::WrongMaterial, TwinKind::WrongStart,
  TwinKind::EveryParameter };

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
  for (const TwinKind kind : AllKinds)
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
  for (const TwinKind kind : AllKinds)
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
    for (const TwinKind kind : AllKinds)
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
    if (run.Search == NameOf(TwinSearch::Register))
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
  std::string text = "| imaged landmarks: median (largest) error, mm | in 3D | on the receptor |\n"
                     "|---|---|---|\n";
  for (const LandmarkSummary& row : found.Rows)
  {
    text += Line("| %s | %.2f (%.2f) | %.2f (%.2f) |\n", row.Method.c_str(), row.InSpace.Median,
      row.InSpace.Largest, row.OnReceptor.Median, row.OnReceptor.Largest);
  }
  if (std::isfinite(found.GlandDice))
  {
    text +=
      Line("\nGland overlap (Dice) %.2f, at rest %.2f. ", found.GlandDice, found.GlandDiceAtRest);
  }
  return text +
    Line("%d iterations, %d equilibria, %.0f s.\n\n", found.Iterations, found.Equilibria,
      found.Seconds);
}

std::string MammogramTable(const std::vector<MammogramEvidence>& found)
{
  std::string text =
    "| real mammogram | outline: mean (largest), mm | correlation | trust that the "
    "report claims | time, s |\n|---|---|---|---|---|\n";
  for (const MammogramEvidence& row : found)
  {
    text += row.Failure.empty()
      ? Line("| %s | %.2f (%.2f) | %.2f | %s | %.0f |\n", row.Name.c_str(), row.MeanOutlineMm,
          row.LargestOutlineMm, row.Correlation, row.Trust.c_str(), row.Seconds)
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
  if (evidence.Landmarks)
  {
    text += LandmarkTable(*evidence.Landmarks);
  }
  text += TwinTables(evidence.Twins) + SearchTable(evidence);
  if (!evidence.Mammograms.empty())
  {
    text += MammogramTable(evidence.Mammograms);
  }
  if (!evidence.Studies.empty())
  {
    text += StudyTable(evidence.Studies);
  }
  return text;
}
}
