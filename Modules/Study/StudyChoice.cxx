// SPDX-License-Identifier: Apache-2.0
#include "Private/HeaderRules.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Mammogram.h"
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
/// The evidence in brackets, for a reason.
std::string InBrackets(const std::string& evidence)
{
  return evidence.empty() ? "" : " (" + evidence + ")";
}

bool IsBeforeForCertain(const StudySeries& series)
{
  return series.Contrast == ContrastPhase::Before && !series.ContrastByOrder;
}

/// Smaller is better: contrast, plane, the thickness of slices, voxels.
auto RankOf(const StudySeries& series)
{
  const Vector3 spacing = series.Grid->Spacing;
  const int contrast = IsBeforeForCertain(series) ? 0
    : series.Contrast != ContrastPhase::After     ? 1
                                                  : 2;
  // A tenth of a millimetre makes no better slices.
  const double thickness = std::round(10 * std::max({ spacing[0], spacing[1], spacing[2] }));
  return std::make_tuple(contrast, series.Plane == "axial" ? 0 : 1, thickness,
    spacing[0] * spacing[1] * spacing[2]);
}

bool ShowsSide(const StudySeries& series, char side)
{
  return side == '?' || (series.Side != 'L' && series.Side != 'R') || series.Side == side;
}

/// The series of the newest examination that show the side. Fills in the reason of all others.
std::vector<StudySeries*> FindCandidates(StudyChoice& choice)
{
  const StudySeries* newest = nullptr;
  for (const StudySeries& series : choice.Found.Series)
  {
    const bool counts = series.LeftOut.empty() && ShowsSide(series, choice.Laterality);
    newest = counts && (!newest || series.Date > newest->Date) ? &series : newest;
  }
  // An examination may go on over midnight.
  const auto isOlder = [newest](const StudySeries& series)
  {
    const auto& study = series.Header.Identity;
    const auto isOf = [&study](const DicomIdentity& other)
    {
      return !study.StudyInstanceUid.empty() && study.StudyInstanceUid == other.StudyInstanceUid &&
        study.StudyDate == other.StudyDate;
    };
    return newest && !series.Date.empty() && series.Date != newest->Date &&
      !isOf(newest->Header.Identity);
  };
  std::vector<StudySeries*> candidates;
  for (StudySeries& series : choice.Found.Series)
  {
    series.Reason = !series.LeftOut.empty() ? "left out: " + series.LeftOut
      : !ShowsSide(series, choice.Laterality)
      ? "left out: shows the " + SideName(series.Side) + " breast only"
      : isOlder(series) ? "left out: of an older examination"
                        : "";
    if (series.Reason.empty())
    {
      candidates.push_back(&series);
    }
  }
  return candidates;
}

/// Null if there is none.
StudySeries* BestOf(const std::vector<StudySeries*>& candidates, FatSuppression fat)
{
  StudySeries* best = nullptr;
  for (StudySeries* series : candidates)
  {
    if (series->Fat == fat && (!best || RankOf(*series) < RankOf(*best)))
    {
      best = series;
    }
  }
  return best;
}

bool AreOfOnePosition(const StudySeries& a, const StudySeries& b)
{
  const std::string& first = a.Header.FrameOfReferenceUid;
  const std::string& second = b.Header.FrameOfReferenceUid;
  return a.Header.PatientPosition == b.Header.PatientPosition &&
    (first.empty() || second.empty() || first == second);
}

std::string WhyTaken(const StudySeries& series)
{
  const std::string evidence = InBrackets(series.ContrastEvidence);
  return std::string("taken: T1 ") +
    (series.Fat == FatSuppression::Absent ? "without fat suppression"
        : series.Fat == FatSuppression::Present
        ? "with fat suppression"
        : "of which no header tells whether fat is suppressed") +
    InBrackets(series.FatEvidence) +
    (series.Contrast == ContrastPhase::Before
        ? ", before contrast" + evidence + (series.ContrastByOrder ? " by order alone" : "")
        : series.Contrast == ContrastPhase::After
        ? ", after contrast" + evidence + " for want of one before"
        : ", no header tells of contrast");
}

/// `better`: the best candidate of the same kind.
std::string WhyNotTaken(const StudySeries& series, const StudySeries& better,
  const StudyChoice& choice)
{
  if (series.Fat == FatSuppression::Unknown && !choice.Undetermined)
  {
    return "left out: no header tells whether fat is suppressed, and of others it is known";
  }
  if (series.Contrast == ContrastPhase::After && better.Contrast != ContrastPhase::After)
  {
    return "left out: after contrast (" + series.ContrastEvidence + ")";
  }
  return "left out: '" + better.Description + "' is of the same kind, " +
    (IsBeforeForCertain(better) && !IsBeforeForCertain(series)
        ? "before contrast for certain"
        : "finer, earlier or of a lower number");
}

/// Lists the kinds of series that there are instead.
std::string WhyNoSeries(const std::vector<StudySeries>& all)
{
  if (all.empty())
  {
    return "expected an MRI of the breast, found none";
  }
  std::map<std::string, int> kinds;
  for (const StudySeries& series : all)
  {
    const std::string reason = series.Reason.substr(std::string("left out: ").size());
    ++kinds[reason.substr(0, reason.find(" ("))];
  }
  std::string found;
  for (const auto& [kind, count] : kinds)
  {
    found += (found.empty() ? "" : ", ") + kind + (count > 1 ? " x " + std::to_string(count) : "");
  }
  return "expected a T1-weighted MRI of the breast, found only: " + found;
}

/// Whether a series of which no header tells whether fat is suppressed may add anything to one
/// where it is. `suppressed`: null if there is none.
bool IsOfUse(const StudySeries& series, const StudySeries* suppressed)
{
  return !suppressed ||
    (series.Contrast != ContrastPhase::After && AreOfOnePosition(series, *suppressed));
}

/// How the patient lay, as given or by the volume that is segmented.
void SettlePosition(std::optional<PatientPosition> given, StudyChoice& choice)
{
  if (!choice.Mri())
  {
    return;
  }
  const StudySeries& taken = *choice.Mri();
  choice.Position = given ? given : taken.Position;
  if (given)
  {
    return;
  }
  if (!taken.Position && taken.Header.PatientPosition.empty())
  {
    choice.Warnings.emplace_back(
      "the MRI's header does not say whether the patient lay prone or supine");
  }
  else if (!taken.Position)
  {
    choice.Refusal = "expected an MRI of a patient prone or supine, found the position " +
      taken.Header.PatientPosition + " in '" + taken.Description + "'";
    choice.Remedy = "ImagePosition";
  }
}

/// Takes the volumes of these numbers, from 1, whatever speaks against them.
void TakeTissue(StudyChoice& choice, const std::vector<int>& numbers)
{
  std::vector<StudySeries>& all = choice.Found.Series;
  for (StudySeries& series : all)
  {
    series.Reason = "left out: another one was asked for";
  }
  for (const int number : numbers)
  {
    StudySeries& series = VolumeOfNumber(choice.Found, number);
    std::optional<StudySeries>& place = series.Fat == FatSuppression::Absent ? choice.Plain
      : series.Fat == FatSuppression::Present                                ? choice.FatSuppressed
                                                                             : choice.Undetermined;
    if (place)
    {
      throw InputError(choice.Found.Folder +
          ": expected one volume without and one with fat suppression, found '" +
          place->Description + "' and '" + series.Description + "', of one kind",
        { "Series", std::to_string(number) });
    }
    series.Reason = "taken: asked for" + InBrackets(series.FatEvidence);
    if (const std::string against = AgainstVolume(series); !against.empty())
    {
      choice.Warnings.push_back(against);
    }
    place = series;
  }
}

void ChooseTissue(StudyChoice& choice)
{
  const std::vector<StudySeries*> candidates = FindCandidates(choice);
  if (candidates.empty())
  {
    choice.Refusal = WhyNoSeries(choice.Found.Series);
    return;
  }
  StudySeries* plain = BestOf(candidates, FatSuppression::Absent);
  StudySeries* suppressed = BestOf(candidates, FatSuppression::Present);
  if (plain && suppressed && !AreOfOnePosition(*plain, *suppressed))
  {
    // The one before contrast is taken, or else the finer one.
    StudySeries*& other = RankOf(*suppressed) < RankOf(*plain) ? plain : suppressed;
    other->Reason = "left out: the patient lay otherwise (another frame of reference or position)";
    other = nullptr;
  }
  const auto take = [&choice](StudySeries* series, std::optional<StudySeries>& place)
  {
    if (!series)
    {
      return;
    }
    series->Reason = WhyTaken(*series);
    place = *series;
    if (series->ContrastByOrder && series->Phases == 1 && MomentOf(series->Header).empty())
    {
      choice.Warnings.push_back("'" + series->Description +
        "' is taken for the one before contrast by the numbers of series alone: their headers have "
        "neither times nor an agent");
    }
    if (series->Contrast == ContrastPhase::After && series->Fat != FatSuppression::Absent)
    {
      choice.Warnings.push_back("'" + series->Description +
        "' was taken after contrast: what enhances is as bright as gland");
    }
  };
  take(plain, choice.Plain);
  take(suppressed, choice.FatSuppressed);
  if (StudySeries* const other = BestOf(candidates, FatSuppression::Unknown);
      other && !plain && IsOfUse(*other, suppressed))
  {
    take(other, choice.Undetermined);
  }
  for (StudySeries* series : candidates)
  {
    if (series->Reason.empty())
    {
      series->Reason = WhyNotTaken(*series, *BestOf(candidates, series->Fat), choice);
    }
  }
}

/// Settles the side: the one asked for, or that of all mammograms that can be registered. If none
/// of these names a side, the one asked for is theirs.
void SettleSide(std::optional<char> laterality, StudyChoice& choice)
{
  std::set<char> sides;
  for (const StudyMammogram& image : choice.Found.Mammograms)
  {
    if (image.LeftOut.empty())
    {
      sides.insert(image.Header.Laterality);
    }
  }
  choice.Laterality = laterality ? *laterality : sides.size() == 1 ? *sides.begin() : '?';
  if (laterality && sides == std::set<char>{ '?' })
  {
    for (StudyMammogram& image : choice.Found.Mammograms)
    {
      image.Header.Laterality = *laterality;
    }
    choice.Warnings.push_back(
      "no mammogram names its side; taken for the " + SideName(*laterality) + " breast");
  }
}

void ChooseViews(StudyChoice& choice)
{
  const std::string side = SideName(choice.Laterality);
  for (StudyMammogram& image : choice.Found.Mammograms)
  {
    const DicomHeader& header = image.Header;
    image.Reason = !image.LeftOut.empty() ? "left out: " + image.LeftOut
      : header.Laterality == '?'          ? "left out: its header names no side"
      : choice.Laterality != '?' && header.Laterality != choice.Laterality
      ? "left out: the " + SideName(header.Laterality) + " breast"
      : header.View != "CC" && header.View != "MLO" ? "left out: neither CC nor MLO"
                                                    : "left out: the side is not settled";
  }
  if (choice.Laterality == '?')
  {
    return;
  }
  for (auto* view : { &choice.Cc, &choice.Mlo })
  {
    const char* name = view == &choice.Cc ? "CC" : "MLO";
    if (const auto index = ChooseMammogram(choice.Found.Mammograms, choice.Laterality, name))
    {
      StudyMammogram& taken = choice.Found.Mammograms[*index];
      taken.Reason +=
        taken.Header.WhyNoPixelSize.empty() ? "" : ", whose pixels' size is not known";
      *view = taken;
    }
  }
  if (choice.Cc.has_value() != choice.Mlo.has_value())
  {
    choice.Warnings.push_back(std::string("no ") + (choice.Cc ? "MLO" : "CC") + " of the " + side +
      " breast: one view alone leaves the depth along its rays open");
  }
}

std::string WhyNoViews(const StudyChoice& choice)
{
  const std::vector<StudyMammogram>& all = choice.Found.Mammograms;
  std::set<std::string> views;
  for (const StudyMammogram& image : all)
  {
    if (image.LeftOut.empty())
    {
      views.insert(SideName(image.Header.Laterality) + ' ' + image.Header.View);
    }
  }
  if (views.empty())
  {
    return all.empty() ? "expected a mammogram, found none"
                       : "expected a mammogram that can be registered, found none among " +
        std::to_string(all.size()) + " (first: " + all.front().LeftOut + ")";
  }
  std::string found;
  for (const std::string& view : views)
  {
    found += (found.empty() ? ", found " : ", ") + view;
  }
  return choice.Laterality == '?'
    ? "expected mammograms of one breast, or its side to be named" + found
    : "expected a CC or MLO mammogram of the " + SideName(choice.Laterality) + " breast" + found;
}
}

const std::optional<StudySeries>& StudyChoice::Mri() const
{
  return this->Plain ? this->Plain : this->FatSuppressed ? this->FatSuppressed : this->Undetermined;
}

void StudyChoice::Require() const
{
  if (!this->Refusal.empty())
  {
    throw InputError(this->Refusal,
      { this->Remedy, "",
        this->Remedy.empty() ? std::vector<std::string>() : std::vector{ this->Remedy } });
  }
}

std::string AgainstVolume(const StudySeries& series)
{
  const std::string why = !series.LeftOut.empty() ? series.LeftOut
    : series.Contrast == ContrastPhase::After
    ? "after contrast (" + series.ContrastEvidence + "): what enhances is as bright as gland"
    : "";
  return why.empty() ? why : "'" + series.Description + "' is taken as asked for, although: " + why;
}

StudySeries& VolumeOfNumber(Study& study, int number)
{
  if (number < 1 || static_cast<std::size_t>(number) > study.Series.size())
  {
    throw InputError(study.Folder + ": expected a volume from 1 to " +
        std::to_string(study.Series.size()) + ", found " + std::to_string(number) +
        VolumesText(study),
      { "Series", std::to_string(number) });
  }
  StudySeries& series = study.Series[static_cast<std::size_t>(number) - 1];
  if (!series.Grid)
  {
    throw InputError(study.Folder + ": expected slices that make a volume, found in number " +
        std::to_string(number) + ", '" + series.Description +
        "': " + (series.DoubledFiles.empty() ? series.LeftOut : series.DoubledFiles) +
        (study.Damaged.empty() ? "" : "; damaged: " + DamagedText(study)),
      { "Series", std::to_string(number) });
  }
  return series;
}

StudyChoice ChooseForRegistration(Study study, std::optional<char> laterality,
  const std::vector<int>& series, std::optional<PatientPosition> position)
{
  if (laterality && *laterality != 'L' && *laterality != 'R')
  {
    throw InputError("side: expected L or R, found '" + std::string(1, *laterality) + "'");
  }
  StudyChoice choice;
  choice.Found = std::move(study);
  choice.Warnings = choice.Found.Warnings;
  SettleSide(laterality, choice);
  ChooseViews(choice);
  if (series.empty())
  {
    ChooseTissue(choice);
  }
  else
  {
    TakeTissue(choice, series);
  }
  SettlePosition(position, choice);
  if (choice.Refusal.empty() && !choice.Cc && !choice.Mlo)
  {
    choice.Refusal = WhyNoViews(choice);
    choice.Remedy =
      choice.Laterality == '?' && !choice.Found.Mammograms.empty() ? "Laterality" : "";
  }
  for (const auto* view : { &choice.Cc, &choice.Mlo })
  {
    if (choice.Refusal.empty() && *view && !(*view)->Header.WhyNoPixelSize.empty())
    {
      choice.Refusal = (*view)->Header.WhyNoPixelSize + " in " + (*view)->Header.Path;
      choice.Remedy = "PixelSpacingMm";
    }
  }
  const std::vector<std::string>& damaged = choice.Found.Damaged;
  choice.Warnings.insert(choice.Warnings.end(), damaged.begin(), damaged.end());
  if (!choice.Refusal.empty())
  {
    choice.Refusal = choice.Found.Folder + ": " + choice.Refusal +
      (damaged.empty()
          ? ""
          : " (" + std::to_string(damaged.size()) + " damaged: " + damaged.front() + ")");
  }
  return choice;
}
}
