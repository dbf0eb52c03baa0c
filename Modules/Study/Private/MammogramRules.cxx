// SPDX-License-Identifier: Apache-2.0
#include "Private/HeaderRules.h"
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

const ImageKind UnusableMammograms[] = {
  { "contrast mammography (high energy or recombined)", HeaderMeaning::ContrastMammogram,
    { "SUBTRACTION", "RECOMBINED", "HIGH_ENERGY" }, {} },
  { "specimen or biopsy", HeaderMeaning::Biopsy, {}, { "STEREO", "BIOPSY" } },
  { "implant displaced view", HeaderMeaning::ImplantDisplaced, {}, {} },
  { "magnification view", HeaderMeaning::Magnified, {}, {} },
  { "spot compression view", HeaderMeaning::SpotCompression, {}, {} },
};

std::string WhyLeftOut(const DicomHeader& header)
{
  if (header.Modality != "MG")
  {
    return "modality " + header.Modality + ", not a digital mammogram";
  }
  if (header.SamplesPerPixel > 1 || header.SopClassUid.starts_with(SecondaryCaptureClass))
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
  return reason.empty() && header.View.empty() ? NamesNoView : reason;
}

/// Seconds of the day of HHMMSS. Negative if there is no time.
double SecondsOf(const StudyMammogram& mammogram)
{
  const std::string& time = mammogram.Header.AcquisitionTime;
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
  const double first = SecondsOf(a);
  const double second = SecondsOf(b);
  return a.Header.AcquisitionDate == b.Header.AcquisitionDate &&
    (first < 0 || second < 0 || std::abs(first - second) <= 10);
}

bool IsForProcessing(const StudyMammogram& mammogram)
{
  return mammogram.Header.PresentationIntent == Mammogram::Intent::ForProcessing;
}

/// Whether a mammogram is the better choice of those of one side and view.
bool IsNewer(const StudyMammogram& a, const StudyMammogram& b)
{
  return a.Synthetic != b.Synthetic ? !a.Synthetic
    : a.Header.AcquisitionDate != b.Header.AcquisitionDate
    ? a.Header.AcquisitionDate > b.Header.AcquisitionDate
    : SecondsOf(a) > SecondsOf(b);
}
}

std::string WhyNotWholeBreast(const DicomHeader& header)
{
  for (const std::string& modifier : header.ViewModifiers)
  {
    if (const std::string text = HeaderWords(modifier); text != "nipple in profile")
    {
      return text + " view";
    }
  }
  const std::string words =
    PlainWords(header.SeriesDescription + ' ' + header.View + ' ' + header.PaddleDescription);
  const FoundKind kind = FindKind(UnusableMammograms, header.ImageType, words);
  return !kind.Name.empty()                  ? std::string(kind.Name)
    : header.Magnification.value_or(1) > 1.3 ? "magnification view"
    : header.PartialView                     ? "part of a breast (partial view)"
    : header.ImplantPresent                  ? "implant (its mechanics are not known)"
                                             : "";
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
  mammogram.LeftOut = WhyLeftOut(header);
  const std::string words = PlainWords(header.SeriesDescription);
  mammogram.Synthetic = !FindPart(header.ImageType, { "GENERATED_2D" }).empty() ||
    !FindMeaning(words, HeaderMeaning::SyntheticMammogram).empty();
  DicomHeader& known = mammogram.Header = header;
  // "L CC", "R-MLO", "Mamografia esquerda": the side that only the description names.
  known.Laterality = header.Laterality == '?' ? SideInWords(words, true) : header.Laterality;
  if (!(header.BodyPartThicknessMm.value_or(0) > 0))
  {
    known.BodyPartThicknessMm.reset();
  }
  known.AcquisitionDate =
    header.AcquisitionDate.empty() ? header.Identity.StudyDate : header.AcquisitionDate;
  known.AcquisitionTime =
    header.AcquisitionTime.empty() ? header.ContentTime : header.AcquisitionTime;
  return mammogram;
}

std::optional<std::size_t> ChooseMammogram(std::vector<StudyMammogram>& mammograms, char side,
  const std::string& view)
{
  std::vector<StudyMammogram*> known;
  for (StudyMammogram& image : mammograms)
  {
    if (image.LeftOut.empty() && image.Header.Laterality == side && image.Header.View == view)
    {
      known.push_back(&image);
    }
  }
  if (known.empty())
  {
    return std::nullopt;
  }
  std::stable_sort(known.begin(), known.end(),
    [](const StudyMammogram* a, const StudyMammogram* b) { return IsNewer(*a, *b); });
  const StudyMammogram& newest = *known.front();
  StudyMammogram* taken = known.front();
  for (StudyMammogram* image : known)
  {
    const bool better = IsForProcessing(*image) && !IsForProcessing(*taken) &&
      image->Synthetic == newest.Synthetic && SameExposure(*image, newest);
    taken = better ? image : taken;
  }
  for (StudyMammogram* image : known)
  {
    const bool isOtherForm =
      SameExposure(*image, *taken) && IsForProcessing(*image) != IsForProcessing(*taken);
    image->Reason = image->Synthetic != taken->Synthetic ? "left out: computed from tomosynthesis"
      : isOtherForm ? "left out: the other form of the exposure that is taken"
                    : "left out: an older exposure";
  }
  taken->Reason = "taken: the " + std::string(known.size() > 1 ? "newest " : "") + view +
    (taken->Synthetic             ? ", computed from tomosynthesis for want of an exposure"
        : IsForProcessing(*taken) ? ", For Processing"
                                  : ", For Presentation");
  return static_cast<std::size_t>(taken - mammograms.data());
}
}
