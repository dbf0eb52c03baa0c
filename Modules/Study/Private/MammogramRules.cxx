// SPDX-License-Identifier: Apache-2.0
#include "Private/MammogramRules.h"

#include "Private/HeaderWords.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace mammoray
{
namespace
{
constexpr const char* TomosynthesisClass = "1.2.840.10008.5.1.4.1.1.13.1.3";
constexpr const char* ProjectionClass = "1.2.840.10008.5.1.4.1.1.13.1.4";

std::string WhyLeftOut(const DicomHeader& header)
{
  if (header.Modality != "MG")
  {
    return "modality " + header.Modality + ", not a digital mammogram";
  }
  if (header.SamplesPerPixel > 1 || header.SopClassUid.starts_with("1.2.840.10008.5.1.4.1.1.7"))
  {
    return "screenshot (colours or secondary capture)";
  }
  if (header.SopClassUid == TomosynthesisClass || header.Frames > 1)
  {
    return "tomosynthesis (" + std::to_string(header.Frames) + " frames)";
  }
  if (header.SopClassUid.starts_with(ProjectionClass) ||
    !FindPart(header.ImageType, { "TOMO_PROJ" }).empty())
  {
    return "single projection of a tomosynthesis";
  }
  const std::string reason = WhyNotWholeBreast(header);
  return reason.empty() && header.View.empty() ? "its header names no view" : reason;
}

/// Seconds of the day of HHMMSS; negative where there is none.
double SecondsOf(const std::string& time)
{
  if (time.size() < 6)
  {
    return -1;
  }
  const double number = std::strtod(time.c_str(), nullptr);
  const double hours = std::floor(number / 10000);
  const double minutes = std::floor(number / 100) - 100 * hours;
  return 3600 * hours + 60 * minutes + std::fmod(number, 100);
}

/// Forms of one exposure are stored within seconds of each other.
bool SameExposure(const StudyMammogram& a, const StudyMammogram& b)
{
  const double first = SecondsOf(a.Time);
  const double second = SecondsOf(b.Time);
  return a.Date == b.Date && (first < 0 || second < 0 || std::abs(first - second) <= 10);
}
}

std::string WhyNotWholeBreast(const DicomHeader& header)
{
  const std::string words = HeaderWords(header.SeriesDescription) + ' ' + HeaderWords(header.View) +
    ' ' + HeaderWords(header.PaddleDescription);
  if (!FindValue(header.ImageType, { "SUBTRACTION", "RECOMBINED", "HIGH_ENERGY" }).empty() ||
    !FindWords(words, "recombined|subtracted|subtraction|high energy|he").empty())
  {
    return "contrast mammography (high energy or recombined)";
  }
  if (!FindPart(header.ImageType, { "STEREO", "BIOPSY" }).empty() ||
    !FindWords(words, "stereo\\w*|biops\\w*|scout|wire|specimen|probe|stanz\\w*").empty())
  {
    return "specimen or biopsy";
  }
  for (const std::string& modifier : header.ViewModifiers)
  {
    if (const std::string text = HeaderWords(modifier); text != "nipple in profile")
    {
      return text + " view";
    }
  }
  if (!FindWords(words, "id|implant displaced|eklund|cc ?id|mlo ?id|[lr]ccid|[lr]mloid").empty())
  {
    return "implant displaced view";
  }
  if (header.Magnification.value_or(1) > 1.3 ||
    !FindWords(words, "mag|m?magnif\\w*|\\w+mag").empty())
  {
    return "magnification view";
  }
  if (!FindWords(words, "spot\\w*|\\w+spot|spt\\w*|cone\\w*").empty())
  {
    return "spot compression view";
  }
  if (header.PartialView)
  {
    return "part of a breast (partial view)";
  }
  if (header.ImplantPresent)
  {
    return "implant (its mechanics are not known)";
  }
  return {};
}

bool IsMammogram(const DicomHeader& header)
{
  // Plates and films of older units, and what was captured of them.
  const bool breast =
    HeaderWords(header.SeriesDescription + ' ' + header.ProtocolName).find("mammo") !=
    std::string::npos;
  return header.Modality == "MG" ||
    (breast && (header.Modality == "CR" || header.Modality == "DX" || header.Modality == "OT"));
}

StudyMammogram DescribeMammogram(const DicomHeader& header)
{
  StudyMammogram mammogram;
  mammogram.File = header.Path;
  mammogram.View = header.View;
  const std::string words = HeaderWords(header.SeriesDescription);
  // "L CC", "R-MLO", "Mamografia esquerda": the side that only the description names.
  mammogram.Laterality =
    header.Laterality == '?' ? SideInWords(words, "l|lcc|lmlo", "r|rcc|rmlo") : header.Laterality;
  mammogram.Intent = header.PresentationIntent;
  mammogram.Synthetic = !FindPart(header.ImageType, { "GENERATED_2D" }).empty() ||
    !FindWords(words, "c view|cview|intelligent 2d|v preview|insight 2d|synth\\w*|s2d").empty();
  if (header.BodyPartThicknessMm.value_or(0) > 0)
  {
    mammogram.ThicknessMm = header.BodyPartThicknessMm;
  }
  mammogram.AngleDeg = header.PositionerPrimaryAngleDeg;
  mammogram.Columns = header.Columns;
  mammogram.Rows = header.Rows;
  mammogram.Date =
    header.AcquisitionDate.empty() ? header.Identity.StudyDate : header.AcquisitionDate;
  mammogram.Time = header.AcquisitionTime.empty() ? header.ContentTime : header.AcquisitionTime;
  mammogram.LeftOut = WhyLeftOut(header);
  return mammogram;
}

std::optional<std::size_t> ChooseMammogram(const std::vector<StudyMammogram>& mammograms, char side,
  const std::string& view, std::vector<std::string>& reasons)
{
  std::vector<std::size_t> known;
  for (std::size_t index = 0; index < mammograms.size(); ++index)
  {
    const StudyMammogram& image = mammograms[index];
    if (image.LeftOut.empty() && image.Laterality == side && image.View == view)
    {
      known.push_back(index);
    }
  }
  if (known.empty())
  {
    return std::nullopt;
  }
  const auto newest = [&](std::size_t a, std::size_t b)
  {
    const StudyMammogram& left = mammograms[a];
    const StudyMammogram& right = mammograms[b];
    return left.Synthetic != right.Synthetic ? !left.Synthetic
      : left.Date != right.Date              ? left.Date > right.Date
                                             : SecondsOf(left.Time) > SecondsOf(right.Time);
  };
  std::stable_sort(known.begin(), known.end(), newest);
  const StudyMammogram& last = mammograms[known.front()];
  std::size_t taken = known.front();
  for (const std::size_t index : known)
  {
    const StudyMammogram& image = mammograms[index];
    const bool better = image.Intent == Mammogram::Intent::ForProcessing &&
      mammograms[taken].Intent != Mammogram::Intent::ForProcessing;
    taken =
      better && image.Synthetic == last.Synthetic && SameExposure(image, last) ? index : taken;
  }
  const StudyMammogram& chosen = mammograms[taken];
  for (const std::size_t index : known)
  {
    const StudyMammogram& image = mammograms[index];
    const bool processing = image.Intent == Mammogram::Intent::ForProcessing;
    if (index == taken)
    {
      reasons[index] = std::string("taken: the ") + (known.size() > 1 ? "newest " : "") + view +
        (image.Synthetic ? ", computed from tomosynthesis for want of an exposure"
            : processing ? ", For Processing"
                         : ", For Presentation");
    }
    else
    {
      reasons[index] = image.Synthetic != chosen.Synthetic ? "left out: computed from tomosynthesis"
        : SameExposure(image, chosen) && image.Intent != chosen.Intent
        ? "left out: the other form of the exposure that is taken"
        : "left out: an older exposure";
    }
  }
  return taken;
}
}
