// SPDX-License-Identifier: Apache-2.0
#include "Private/MammogramRules.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/Intake.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace mammoray
{
namespace
{
const char* SideName(char side)
{
  return side == 'L' ? "left" : side == 'R' ? "right" : "unnamed";
}

const char* SuppressionWords(FatSuppression fat)
{
  return fat == FatSuppression::Absent ? "without fat suppression"
    : fat == FatSuppression::Present   ? "with fat suppression"
                                       : "of which no header tells whether fat is suppressed";
}

/// Smaller is better: contrast, plane, the thickness of slices, voxels, order.
auto RankOf(const StudySeries& series)
{
  const Vector3 spacing = series.Grid->Spacing;
  const int contrast = series.Contrast == ContrastPhase::Before ? 0
    : series.Contrast == ContrastPhase::Unknown                 ? 1
                                                                : 2;
  // A tenth of a millimetre makes no better slices.
  const double thickness = std::round(10 * std::max({ spacing[0], spacing[1], spacing[2] }));
  return std::make_tuple(contrast, series.Plane == "axial" ? 0 : 1, thickness,
    spacing[0] * spacing[1] * spacing[2]);
}

/// The place of each series in the study, of which this chooses.
class TissueChoice
{
public:
  TissueChoice(const Study& study, StudyChoice& choice)
    : All(study.Series)
    , Choice(choice)
  {
  }

  void Choose()
  {
    this->FindCandidates();
    if (this->Candidates.empty())
    {
      this->Choice.Refusal = this->WhyNone();
      return;
    }
    const auto plain = this->Best(FatSuppression::Absent);
    auto suppressed = this->Best(FatSuppression::Present);
    auto kept = plain;
    if (plain && suppressed && !this->OnePosition(*plain, *suppressed))
    {
      // The one that comes before contrast, or is finer.
      kept = RankOf(this->All[*suppressed]) < RankOf(this->All[*plain]) ? std::nullopt : plain;
      suppressed = kept ? std::nullopt : suppressed;
      this->Choice.SeriesReasons[kept ? *this->Best(FatSuppression::Present) : *plain] =
        "left out: the patient lay otherwise (another frame of reference or position)";
    }
    this->Take(kept, this->Choice.Plain);
    this->Take(suppressed, this->Choice.FatSuppressed);
    if (!kept && !suppressed)
    {
      this->Take(this->Best(FatSuppression::Unknown), this->Choice.Undetermined);
    }
    this->ExplainOthers();
    this->FindPosition();
  }

private:
  /// Of the newest examination that has one, those that hold the side.
  void FindCandidates()
  {
    std::string newest;
    for (const StudySeries& series : this->All)
    {
      newest =
        series.LeftOut.empty() && this->HoldsSide(series) ? std::max(newest, series.Date) : newest;
    }
    for (std::size_t index = 0; index < this->All.size(); ++index)
    {
      const StudySeries& series = this->All[index];
      std::string& reason = this->Choice.SeriesReasons[index];
      if (!series.LeftOut.empty())
      {
        reason = "left out: " + series.LeftOut;
      }
      else if (!this->HoldsSide(series))
      {
        reason = std::string("left out: shows the ") + SideName(series.Side) + " breast only";
      }
      else if (series.Date != newest && !series.Date.empty())
      {
        reason = "left out: of an older examination";
      }
      else
      {
        this->Candidates.push_back(index);
      }
    }
  }

  bool HoldsSide(const StudySeries& series) const
  {
    const char side = this->Choice.Laterality;
    return side == '?' || (series.Side != 'L' && series.Side != 'R') || series.Side == side;
  }

  std::optional<std::size_t> Best(FatSuppression fat) const
  {
    std::optional<std::size_t> best;
    for (const std::size_t index : this->Candidates)
    {
      const StudySeries& series = this->All[index];
      if (series.Fat == fat && (!best || RankOf(series) < RankOf(this->All[*best])))
      {
        best = index;
      }
    }
    return best;
  }

  bool OnePosition(std::size_t a, std::size_t b) const
  {
    const StudySeries& first = this->All[a];
    const StudySeries& second = this->All[b];
    return first.PositionCode == second.PositionCode &&
      (first.FrameOfReferenceUid.empty() || second.FrameOfReferenceUid.empty() ||
        first.FrameOfReferenceUid == second.FrameOfReferenceUid);
  }

  void Take(const std::optional<std::size_t>& index, std::optional<StudySeries>& place)
  {
    if (!index)
    {
      return;
    }
    const StudySeries& series = this->All[*index];
    place = series;
    std::string why = std::string("taken: T1 ") + SuppressionWords(series.Fat);
    why += series.FatEvidence.empty() ? "" : " (" + series.FatEvidence + ")";
    const std::string evidence =
      series.ContrastEvidence.empty() ? "" : " (" + series.ContrastEvidence + ")";
    why += series.Contrast == ContrastPhase::Before ? ", before contrast" + evidence
      : series.Contrast == ContrastPhase::After
      ? ", after contrast" + evidence + " for want of one before"
      : ", no header tells of contrast";
    this->Choice.SeriesReasons[*index] = why;
    if (series.Contrast == ContrastPhase::After && series.Fat != FatSuppression::Absent)
    {
      this->Choice.Warnings.push_back("'" + series.Description +
        "' was taken after contrast: what enhances is as bright as gland");
    }
  }

  void ExplainOthers()
  {
    for (const std::size_t index : this->Candidates)
    {
      std::string& reason = this->Choice.SeriesReasons[index];
      const StudySeries& series = this->All[index];
      if (!reason.empty())
      {
        continue;
      }
      const auto better = this->Best(series.Fat);
      if (series.Fat == FatSuppression::Unknown && !this->Choice.Undetermined)
      {
        reason = "left out: no header tells whether fat is suppressed, and of others it is known";
      }
      else if (series.Contrast == ContrastPhase::After &&
        this->All[*better].Contrast != ContrastPhase::After)
      {
        reason = "left out: after contrast (" + series.ContrastEvidence + ")";
      }
      else
      {
        reason = "left out: '" + this->All[*better].Description + "' is of the same kind, " +
          (this->All[*better].Contrast != series.Contrast ? "before contrast for certain"
                                                          : "finer or earlier");
      }
    }
  }

  void FindPosition()
  {
    const StudySeries& series = this->Choice.FatSuppressed ? *this->Choice.FatSuppressed
      : this->Choice.Plain                                 ? *this->Choice.Plain
                                                           : *this->Choice.Undetermined;
    this->Choice.Position = series.Position;
    if (series.Position)
    {
      return;
    }
    if (series.PositionCode.empty())
    {
      this->Choice.Warnings.emplace_back(
        "the MRI's header does not say whether the patient lay prone or supine");
    }
    else
    {
      this->Choice.Refusal = "expected an MRI of a patient prone or supine, found the position " +
        series.PositionCode + " in '" + series.Description + "'";
    }
  }

  /// Which kinds of series there are instead.
  std::string WhyNone() const
  {
    if (this->All.empty())
    {
      return "expected an MRI of the breast, found none";
    }
    std::map<std::string, int> kinds;
    for (std::size_t index = 0; index < this->All.size(); ++index)
    {
      std::string reason =
        this->Choice.SeriesReasons[index].substr(std::string("left out: ").size());
      ++kinds[reason.substr(0, reason.find(" ("))];
    }
    std::string found;
    for (const auto& [kind, count] : kinds)
    {
      found +=
        (found.empty() ? "" : ", ") + kind + (count > 1 ? " x " + std::to_string(count) : "");
    }
    return "expected a T1-weighted MRI of the breast, found only: " + found;
  }

  const std::vector<StudySeries>& All;
  StudyChoice& Choice;
  std::vector<std::size_t> Candidates;
};

/// Sides and views that there are, "left CC, left MLO".
std::string ViewsOf(const Study& study)
{
  std::set<std::string> views;
  for (const StudyMammogram& image : study.Mammograms)
  {
    if (image.LeftOut.empty())
    {
      views.insert(std::string(SideName(image.Laterality)) + ' ' + image.View);
    }
  }
  std::string text;
  for (const std::string& view : views)
  {
    text += (text.empty() ? "" : ", ") + view;
  }
  return text;
}

/**
 * The side asked for or that of all mammograms that can be registered. Where none of these names a
 * side the one asked for is theirs. Answers the mammograms with their sides.
 */
std::vector<StudyMammogram> SettleSide(const Study& study, std::optional<char> laterality,
  StudyChoice& choice)
{
  std::vector<StudyMammogram> images = study.Mammograms;
  std::set<char> sides;
  for (const StudyMammogram& image : images)
  {
    if (image.LeftOut.empty())
    {
      sides.insert(image.Laterality);
    }
  }
  if (laterality)
  {
    choice.Laterality = *laterality;
    if (sides == std::set<char>{ '?' })
    {
      for (StudyMammogram& image : images)
      {
        image.Laterality = *laterality;
      }
      choice.Warnings.push_back(std::string("no mammogram names its side; taken for the ") +
        SideName(*laterality) + " breast");
    }
  }
  else if (sides.size() == 1)
  {
    choice.Laterality = *sides.begin();
  }
  return images;
}

void ChooseViews(const std::vector<StudyMammogram>& images, StudyChoice& choice)
{
  for (std::size_t index = 0; index < images.size(); ++index)
  {
    const StudyMammogram& image = images[index];
    choice.MammogramReasons[index] = !image.LeftOut.empty() ? "left out: " + image.LeftOut
      : image.Laterality == '?'                             ? "left out: its header names no side"
      : choice.Laterality != '?' && image.Laterality != choice.Laterality
      ? std::string("left out: the ") + SideName(image.Laterality) + " breast"
      : image.View != "CC" && image.View != "MLO" ? "left out: neither CC nor MLO"
                                                  : "left out: the side is not settled";
  }
  if (choice.Laterality == '?')
  {
    return;
  }
  const auto take = [&](const char* view, std::optional<StudyMammogram>& place)
  {
    if (const auto index =
          ChooseMammogram(images, choice.Laterality, view, choice.MammogramReasons))
    {
      place = images[*index];
    }
  };
  take("CC", choice.Cc);
  take("MLO", choice.Mlo);
  for (const auto& [here, missing] : { std::pair{ &choice.Cc, "MLO" }, { &choice.Mlo, "CC" } })
  {
    const auto& other = here == &choice.Cc ? choice.Mlo : choice.Cc;
    if (*here && !other)
    {
      choice.Warnings.push_back(std::string("no ") + missing + " of the " +
        SideName(choice.Laterality) +
        " breast: one view alone leaves the depth along its rays open");
    }
  }
}

std::string WhyNoViews(const Study& study, const StudyChoice& choice)
{
  const std::string views = ViewsOf(study);
  if (views.empty())
  {
    return study.Mammograms.empty()
      ? std::string("expected a mammogram, found none")
      : "expected a mammogram that can be registered, found none among " +
        std::to_string(study.Mammograms.size()) + " (first: " + study.Mammograms.front().LeftOut +
        ")";
  }
  if (choice.Laterality == '?')
  {
    return "expected mammograms of one breast, or its side to be named, found " + views;
  }
  return std::string("expected a CC or MLO mammogram of the ") + SideName(choice.Laterality) +
    " breast, found " + views;
}
}

void StudyChoice::Require() const
{
  if (!this->Refusal.empty())
  {
    throw InputError(this->Refusal);
  }
}

StudyChoice ChooseForRegistration(const Study& study, std::optional<char> laterality)
{
  if (laterality && *laterality != 'L' && *laterality != 'R')
  {
    throw InputError("side: expected L or R, found '" + std::string(1, *laterality) + "'");
  }
  StudyChoice choice;
  choice.Warnings = study.Warnings;
  choice.SeriesReasons.resize(study.Series.size());
  choice.MammogramReasons.resize(study.Mammograms.size());
  ChooseViews(SettleSide(study, laterality, choice), choice);
  TissueChoice(study, choice).Choose();
  if (choice.Refusal.empty() && !choice.Cc && !choice.Mlo)
  {
    choice.Refusal = WhyNoViews(study, choice);
  }
  for (const std::string& file : study.Damaged)
  {
    choice.Warnings.push_back(file);
  }
  if (!choice.Refusal.empty())
  {
    choice.Refusal = study.Folder + ": " + choice.Refusal +
      (study.Damaged.empty() ? ""
                             : " (" + std::to_string(study.Damaged.size()) +
            " damaged: " + study.Damaged.front() + ")");
  }
  return choice;
}
}
