// SPDX-License-Identifier: Apache-2.0
#include "Private/TrustTables.h"

#include "Private/TableText.h"
#include "mammoray/Evidence/EvidenceTables.h"
#include "mammoray/Registration/RegistrationResult.h"

#include <utility>

namespace mammoray
{
namespace
{
/// How many of some results were trusted how far, and errors of those that are good, mm.
struct TrustSummary
{
  int Good = 0;
  int Doubtful = 0;
  int None = 0;
  std::vector<double> GoodErrors;

  void Add(const std::string& trust, double errorMm)
  {
    (trust == "good" ? this->Good : trust == "doubtful" ? this->Doubtful : this->None) += 1;
    if (trust == "good" && std::isfinite(errorMm))
    {
      this->GoodErrors.push_back(errorMm);
    }
  }
};

/// A result that is right or wrong, and by which its tissue tells that.
struct JudgedResult
{
  bool Right = false;
  /// Of the half that limits are chosen on.
  bool Chosen = false;
  double Score = 0;
};

/// Right: tissue found to 5 mm in the middle. Wrong: farther off, or of another breast.
std::vector<JudgedResult> JudgedResults(const RegistrationEvidence& evidence)
{
  constexpr double RightMm = 5;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<JudgedResult> results;
  const auto add = [&](double errorMm, int number, double score)
  {
    // Refused: no score is lower.
    results.push_back({ errorMm < RightMm, number % 2 == 0, std::isfinite(score) ? score : -1 });
  };
  for (const TwinRun& run : evidence.Twins)
  {
    if (run.Search == NameOf(TwinSearch::Register))
    {
      add(run.MedianErrorMm, run.Number, run.TissueCorrelation);
    }
  }
  for (const StudyRun& run : evidence.Studies)
  {
    for (const StudyViewErrors& view : run.Views)
    {
      add(Quantile(view.Imaged.InSpaceMm, 0.5), static_cast<int>(run.Seed), view.TissueCorrelation);
    }
  }
  for (std::size_t index = 0; index < evidence.Mammograms.size(); ++index)
  {
    const MammogramEvidence& run = evidence.Mammograms[index];
    add(nan, static_cast<int>(index), run.Failure.empty() ? run.TissueCorrelation : nan);
  }
  return results;
}

/// The share of right (wrong) results of a half whose score is at least `limit`.
double ShareAbove(const std::vector<JudgedResult>& results, bool right, bool chosen, double limit)
{
  double above = 0;
  double all = 0;
  for (const JudgedResult& result : results)
  {
    if (result.Right == right && result.Chosen == chosen)
    {
      all += 1;
      above += result.Score >= limit ? 1 : 0;
    }
  }
  return all > 0 ? above / all : std::numeric_limits<double>::quiet_NaN();
}
}

std::string TrustTable(const RegistrationEvidence& evidence)
{
  // In the order in which they are first met.
  std::vector<std::pair<std::string, TrustSummary>> groups;
  const auto add = [&](const std::string& name, const std::string& trust, double errorMm)
  {
    auto group = std::find_if(groups.begin(), groups.end(),
      [&](const auto& each) { return each.first == name; });
    if (group == groups.end())
    {
      group = groups.insert(groups.end(), { name, {} });
    }
    group->second.Add(trust, errorMm);
  };
  for (const TwinRun& run : evidence.Twins)
  {
    if (run.Search == NameOf(TwinSearch::Register))
    {
      add(IsRight(run) ? "twins" : run.Kind, run.Trust, run.MedianErrorMm);
    }
  }
  for (const StudyRun& run : evidence.Studies)
  {
    for (const StudyViewErrors& view : run.Views)
    {
      add("virtual studies", view.Trust, Quantile(view.Imaged.InSpaceMm, 0.5));
    }
  }
  for (const MammogramEvidence& run : evidence.Mammograms)
  {
    add("real mammograms, another breast", run.Failure.empty() ? run.Trust : NameOf(Trust::None),
      std::numeric_limits<double>::quiet_NaN());
  }
  if (groups.empty())
  {
    return "";
  }
  std::string text =
    "| trust | results | good | doubtful | none, or refused | 3D error of the good: "
    "median (largest), mm |\n|---|---|---|---|---|---|\n";
  for (const auto& [name, of] : groups)
  {
    text += Line("| %s | %d | %d | %d | %d | %s |\n", name.c_str(), of.Good + of.Doubtful + of.None,
      of.Good, of.Doubtful, of.None,
      of.GoodErrors.empty()
        ? "-"
        : Line("%.2f (%.2f)", Median(of.GoodErrors), Largest(of.GoodErrors)).c_str());
  }
  return text + "\n";
}

std::string ScoreText(const RegistrationEvidence& evidence)
{
  constexpr double MostWrong = 0.02;
  const std::vector<JudgedResult> results = JudgedResults(evidence);
  const auto count = [&](bool right)
  {
    return static_cast<int>(std::count_if(results.begin(), results.end(),
      [&](const JudgedResult& result) { return result.Right == right; }));
  };
  if (count(true) == 0 || count(false) == 0)
  {
    return "";
  }
  // The lowest limit, in hundredths, that lets few wrong ones of the even numbers pass.
  int hundredths = 0;
  while (hundredths < 100 && ShareAbove(results, false, true, 0.01 * hundredths) > MostWrong)
  {
    ++hundredths;
  }
  const auto shares = [&](double limit, bool chosen)
  {
    return Line("%d %% of the wrong and %d %% of the right ones",
      Percent(ShareAbove(results, false, chosen, limit), 1),
      Percent(ShareAbove(results, true, chosen, limit), 1));
  };
  return Line(
    "Tissue correlation, %d right results (3D error below 5 mm in the middle) and %d wrong "
    "ones (above, of another breast, or refused). Limit of %.2f, chosen on even numbers: "
    "%s pass; of odd numbers %s. Limit of the report, %.2f: of even numbers %s, of odd "
    "ones %s.\n\n",
    count(true), count(false), 0.01 * hundredths, shares(0.01 * hundredths, true).c_str(),
    shares(0.01 * hundredths, false).c_str(), GoodTissueCorrelation,
    shares(GoodTissueCorrelation, true).c_str(), shares(GoodTissueCorrelation, false).c_str());
}

std::string TrustCurveSvg(const RegistrationEvidence& evidence)
{
  const std::vector<JudgedResult> results = JudgedResults(evidence);
  constexpr double Edge = 400;
  constexpr double Left = 60;
  constexpr double Top = 20;
  std::string text =
    Line("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" "
         "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%%\" "
         "height=\"100%%\" fill=\"#fff\"/>\n<rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" "
         "height=\"%.0f\" fill=\"none\" stroke=\"#6b7280\"/>\n",
      Edge + 90, Edge + 75, Left, Top, Edge, Edge);
  for (const bool chosen : { true, false })
  {
    text += Line("<polyline fill=\"none\" stroke-width=\"2\" stroke=\"%s\" points=\"",
      chosen ? "#9ca3af" : "#0284c7");
    for (int hundredths = 101; hundredths >= -101; --hundredths)
    {
      text +=
        Line("%.1f,%.1f ", Left + Edge * ShareAbove(results, false, chosen, 0.01 * hundredths),
          Top + Edge * (1 - ShareAbove(results, true, chosen, 0.01 * hundredths)));
    }
    text += "\"/>\n";
  }
  // Marks may coincide, as where all right results and no wrong ones pass: labels one below
  // another.
  const auto mark = [&](double limit, int line)
  {
    const double x = Left + Edge * ShareAbove(results, false, false, limit);
    const double y = Top + Edge * (1 - ShareAbove(results, true, false, limit));
    return Line("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"#0284c7\"/><text x=\"%.1f\" "
                "y=\"%.1f\">%.2f</text>\n",
      x, y, x + 8, y + 16 + 14 * line, limit);
  };
  return text + mark(LeastTissueCorrelation, 0) + mark(GoodTissueCorrelation, 1) +
    Line("<text x=\"%.0f\" y=\"%.0f\" text-anchor=\"middle\">share of wrong results that pass, 0 "
         "to 1</text>\n<text transform=\"translate(22 %.0f) rotate(-90)\" "
         "text-anchor=\"middle\">share of right results that pass, 0 to 1</text>\n<text x=\"%.0f\" "
         "y=\"%.0f\" text-anchor=\"end\" fill=\"#6b7280\">grey: even numbers, by which limits "
         "are chosen; blue: odd</text>\n</svg>\n",
      Left + Edge / 2, Top + Edge + 28, Top + Edge / 2, Left + Edge, Top + Edge + 48);
}
}
