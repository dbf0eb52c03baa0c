// SPDX-License-Identifier: Apache-2.0
// Numbers (TR, TE) count before words where both tell.
#include "Private/SeriesRules.h"

#include "Private/HeaderWords.h"
#include "Private/SeriesWords.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

namespace mammoray
{
namespace
{
/// The description, or where there is none the protocol, which does not tell what was made of it.
std::string WordsOf(const DicomHeader& header)
{
  return PlainWords(
    header.SeriesDescription.empty() ? header.ProtocolName : header.SeriesDescription);
}

std::string Named(const std::string& what, const std::string& where, const std::string& found)
{
  return what + " (" + where + " " + found + ")";
}

/// How the evidence begins where scan options tell of fat suppression.
const std::string ScanOptionEvidence = "ScanOptions ";

/// A kind of picture that no tissue is segmented from: by values of Image Type that are or hold
/// something, or by words of the description.
struct OtherKind
{
  const char* Name;
  SeriesMeaning Words;
  std::initializer_list<const char*> Values;
  std::initializer_list<const char*> Parts;
};

const OtherKind OtherKinds[] = {
  { "projection", SeriesMeaning::Projection, { "PROJECTION IMAGE" }, { "MIP" } },
  { "subtraction", SeriesMeaning::Subtraction, { "SUB" }, { "SUBTR" } },
  { "localizer", SeriesMeaning::Localizer, { "SURVEY", "SCOUT" }, { "LOCALI" } },
  { "calibration", SeriesMeaning::Calibration, {}, {} },
  { "diffusion", SeriesMeaning::Diffusion, { "ADC" }, { "DIFFUSION", "TRACE", "ADC_" } },
  { "map computed from others", SeriesMeaning::ComputedMap,
    { "MAP", "FIT", "TTP", "PEI", "MIPT", "IAUC", "WASH_IN", "WASH_OUT" },
    { "T1 MAP", "T2 MAP", "T1_MAP", "T2_MAP", "PARAMETRIC", "PERFUSION", "COLOR", "T2_STAR" } },
  { "reformat of another series", SeriesMeaning::Reformat, {}, { "MPR", "REFORMAT" } },
  { "phase image", SeriesMeaning::PhaseImage, { "P", "R", "I", "PHASE MAP", "PHASE" },
    { "VELOCITY" } },
  { "spectrum", SeriesMeaning::Spectrum, { "SPECTROSCOPY" }, {} },
};

/// Whether a Dixon reconstruction is told: images of water, of fat, and of both in or out of phase.
struct DixonImage
{
  enum class Kind
  {
    None,
    Water,
    Fat,
    InPhase,
    OutOfPhase
  };
  Kind What = Kind::None;
  std::string Evidence;
};

DixonImage FindDixon(const DicomHeader& header)
{
  using Kind = DixonImage::Kind;
  const std::vector<std::string>& type = header.ImageType;
  const auto byValue = [&](std::initializer_list<const char*> values, Kind kind)
  {
    const std::string value = FindValue(type, values);
    return value.empty() ? DixonImage{} : DixonImage{ kind, "ImageType " + value };
  };
  for (const DixonImage& image :
    { byValue({ "W", "WATER", "W_FFE" }, Kind::Water), byValue({ "F", "FAT", "F_FFE" }, Kind::Fat),
      byValue({ "IP", "IN_PHASE", "INPHASE", "IP_FFE" }, Kind::InPhase),
      byValue({ "OP", "OUT_PHASE", "OUTPHASE", "OPP_PHASE", "OPPOSED_PHASE", "OP_FFE" },
        Kind::OutOfPhase) })
  {
    if (image.What != Kind::None)
    {
      return image;
    }
  }
  const std::string words = WordsOf(header);
  using M = SeriesMeaning;
  const bool dixon = !FindMeaning(words, M::DixonTechnique).empty();
  const auto byWords = [&](M meaning, Kind kind)
  {
    const std::string found = FindMeaning(words, meaning);
    return found.empty() ? DixonImage{} : DixonImage{ kind, "description '" + found + "'" };
  };
  // "WATER: Ax VIBRANT-Flex" (GE), "t1_vibe_dixon_tra_W" (Siemens).
  for (const DixonImage& image : { byWords(dixon ? M::DixonWater : M::WaterImage, Kind::Water),
         byWords(dixon ? M::DixonFat : M::FatImage, Kind::Fat),
         byWords(dixon ? M::DixonInPhase : M::InPhaseImage, Kind::InPhase),
         byWords(dixon ? M::DixonOutOfPhase : M::OutOfPhaseImage, Kind::OutOfPhase) })
  {
    if (image.What != Kind::None)
    {
      return image;
    }
  }
  return {};
}

void FindFatSuppression(const DicomHeader& header, StudySeries& series)
{
  const auto tell = [&series](FatSuppression fat, const std::string& evidence)
  {
    series.Fat = fat;
    series.FatEvidence = evidence;
  };
  if (const DixonImage dixon = FindDixon(header); dixon.What == DixonImage::Kind::Water)
  {
    return tell(FatSuppression::Present, dixon.Evidence);
  }
  else if (dixon.What != DixonImage::Kind::None)
  {
    return tell(FatSuppression::Absent, dixon.Evidence);
  }
  // FS is the standard's word, the others are those of scanners.
  if (const std::string option = FindValue(header.ScanOptions,
        { "FS", "SFS", "WE", "SPIR", "SPAIR", "PROSET", "FATSAT", "FSS" });
      !option.empty())
  {
    return tell(FatSuppression::Present, ScanOptionEvidence + option);
  }
  // WATER: what is suppressed, which leaves fat.
  if (header.SpectralSuppression == "FAT")
  {
    return tell(FatSuppression::Present, "Spectrally Selected Suppression FAT");
  }
  std::string words = PlainWords(header.SeriesDescription) + ' ';
  words += PlainWords(header.ProtocolName) + ' ' + PlainWords(header.SequenceName);
  if (const std::string none = FindMeaning(words, SeriesMeaning::NotFatSuppressed); !none.empty())
  {
    return tell(FatSuppression::Absent, "description '" + none + "'");
  }
  if (const std::string some = FindMeaning(words, SeriesMeaning::FatSuppressed); !some.empty())
  {
    return tell(FatSuppression::Present, "description '" + some + "'");
  }
  if (header.SpectralSuppression == "NONE")
  {
    return tell(FatSuppression::Absent, "Spectrally Selected Suppression NONE");
  }
  // Siemens writes the option wherever fat is suppressed.
  const std::string maker = HeaderWords(header.Manufacturer);
  if (header.HasScanOptions && maker.find("siemens") != std::string::npos)
  {
    tell(FatSuppression::Absent, "ScanOptions of this maker without FS");
  }
}

enum class Weighting
{
  T1,
  T2,
  ProtonDensity,
  InversionRecovery,
  SteadyState,
  Unknown
};

/// Spin echoes by TR and TE, gradient echoes by TE, both by words where numbers leave it open.
Weighting FindWeighting(const DicomHeader& header, std::string& evidence)
{
  const std::string words = WordsOf(header);
  const double tr = header.RepetitionTimeMs.value_or(0);
  const double te = header.EchoTimeMs.value_or(0);
  const double ti = header.InversionTimeMs.value_or(0);
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "TR %g TE %g ms", tr, te);
  const bool inversion = !FindValue(header.ScanningSequence, { "IR" }).empty();
  const bool spin = !FindValue(header.ScanningSequence, { "SE" }).empty() || inversion;
  const bool gradient = !FindValue(header.ScanningSequence, { "GR" }).empty() && !spin;
  if (const std::string word = FindMeaning(words, SeriesMeaning::InversionRecovery); !word.empty())
  {
    evidence = "description '" + word + "'";
    return Weighting::InversionRecovery;
  }
  if (inversion && ti > 80 && ti < 300 && tr > 1500)
  {
    evidence = "inversion time of fat";
    return Weighting::InversionRecovery;
  }
  if (const std::string word = FindMeaning(words, SeriesMeaning::SteadyState); !word.empty())
  {
    evidence = "description '" + word + "'";
    return Weighting::SteadyState;
  }
  evidence = numbers;
  if (spin && tr > 0 && te > 0)
  {
    // Between them the words decide: the T1 of fat is 0.25-0.4 s, of gland 0.9-1.5 s, their T2
    // 50-70 ms.
    if (te >= 60)
    {
      return Weighting::T2;
    }
    if (te <= 35 && tr <= 1200)
    {
      return Weighting::T1;
    }
  }
  const std::string word = FindMeaning(words, SeriesMeaning::NamedWeighting);
  if (!word.empty() && !(gradient && te > 0 && te < 8 && tr < 100))
  {
    evidence = "description '" + word + "'";
    return word.find("t1") != std::string::npos ? Weighting::T1
      : word.find("t2") != std::string::npos    ? Weighting::T2
                                                : Weighting::ProtonDensity;
  }
  if (gradient && te > 0)
  {
    return te < 15 ? Weighting::T1 : Weighting::T2;
  }
  if (spin && te > 0)
  {
    return Weighting::ProtonDensity;
  }
  if (header.AcquisitionContrast == "T1")
  {
    evidence = "Acquisition Contrast T1";
    return Weighting::T1;
  }
  evidence = FindMeaning(words, SeriesMeaning::T1Sequence);
  return evidence.empty() ? Weighting::Unknown : Weighting::T1;
}

std::string SequenceOf(const DicomHeader& header, Weighting weighting)
{
  std::string text = weighting == Weighting::T1 ? "T1 "
    : weighting == Weighting::T2                ? "T2 "
    : weighting == Weighting::ProtonDensity     ? "PD "
    : weighting == Weighting::InversionRecovery ? "IR "
                                                : "";
  const bool spin = !FindValue(header.ScanningSequence, { "SE" }).empty();
  const bool gradient = !FindValue(header.ScanningSequence, { "GR" }).empty();
  text += spin ? "spin echo" : gradient ? "gradient echo" : "MR";
  text += header.AcquisitionType.empty() ? "" : " " + header.AcquisitionType;
  const auto add = [&text](const char* name, const std::optional<double>& value)
  {
    char number[48];
    std::snprintf(number, sizeof number, " %s %.4g", name, value.value_or(0));
    text += value ? number : "";
  };
  add("TR", header.RepetitionTimeMs);
  add("TE", header.EchoTimeMs);
  return text;
}

/// Why the header of a slice says that it shows no tissue as it is.
std::string WhyNoTissue(const DicomHeader& header, Weighting weighting, const std::string& evidence)
{
  if (header.SamplesPerPixel > 1 || header.SopClassUid.starts_with("1.2.840.10008.5.1.4.1.1.7"))
  {
    return "screenshot (colours or secondary capture)";
  }
  if (header.Frames > 1)
  {
    return "multi-frame object without functional groups";
  }
  const std::string words = WordsOf(header);
  for (const OtherKind& kind : OtherKinds)
  {
    std::string value = FindValue(header.ImageType, kind.Values);
    value = value.empty() ? FindPart(header.ImageType, kind.Parts) : value;
    if (!value.empty())
    {
      return Named(kind.Name, "ImageType", value);
    }
    if (const std::string word = FindMeaning(words, kind.Words); !word.empty())
    {
      return Named(kind.Name, "description", "'" + word + "'");
    }
  }
  if (header.DiffusionBValue.value_or(0) > 0 ||
    !FindValue(header.ScanningSequence, { "EP" }).empty())
  {
    return "diffusion (echo-planar or with a b-value)";
  }
  if (const DixonImage dixon = FindDixon(header); dixon.What == DixonImage::Kind::Fat)
  {
    return "fat alone (" + dixon.Evidence + ")";
  }
  else if (dixon.What == DixonImage::Kind::OutOfPhase)
  {
    return "opposed phase (" + dixon.Evidence + ": fat and water cancel at their borders)";
  }
  switch (weighting)
  {
    case Weighting::T1:
      return {};
    case Weighting::T2:
      return "T2-weighted (" + evidence + ")";
    case Weighting::ProtonDensity:
      return "proton density (" + evidence + ")";
    case Weighting::InversionRecovery:
      return "inversion recovery (" + evidence + ")";
    case Weighting::SteadyState:
      return "steady state (" + evidence + ")";
    default:
      return "not known to be T1-weighted (neither TR and TE nor the description tell)";
  }
}

std::string PlaneOf(const DicomHeader& header)
{
  if (!header.Position)
  {
    return {};
  }
  const Vector3 normal = Cross(header.AlongRow, header.AlongColumn);
  // Within 25 degrees of an axis: oblique stacks are turned along the breast by less.
  static const char* const names[] = { "sagittal", "coronal", "axial" };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    if (std::abs(normal[axis]) > 0.906)
    {
      return names[axis];
    }
  }
  return "oblique";
}

/// How far a grid reaches along the patient's axes (left, back, head), mm, and its middle.
struct GridExtent
{
  Vector3 Length{ 0, 0, 0 };
  Vector3 Middle{ 0, 0, 0 };
};

GridExtent ExtentOf(const VolumeGrid& grid)
{
  GridExtent extent;
  extent.Middle =
    grid.PointAt(0.5 * (grid.Size[0] - 1), 0.5 * (grid.Size[1] - 1), 0.5 * (grid.Size[2] - 1));
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (std::size_t along = 0; along < 3; ++along)
    {
      extent.Length[axis] +=
        std::abs(grid.Direction[along][axis]) * grid.Spacing[along] * grid.Size[along];
    }
  }
  return extent;
}

/// The side that the header names: of the frame or series, or in words.
char NamedSide(const DicomHeader& header)
{
  return header.Laterality != '?' ? header.Laterality : SideInWords(WordsOf(header));
}

char SideOf(const VolumeGrid& grid, const DicomHeader& header)
{
  const GridExtent extent = ExtentOf(grid);
  // Both breasts are wider than this together, and one is not.
  if (extent.Length[0] > 220)
  {
    return 'B';
  }
  // One breast that was moved to the magnet's middle is told by words only.
  return std::abs(extent.Middle[0]) < 25 ? NamedSide(header) : extent.Middle[0] > 0 ? 'L' : 'R';
}
}

std::string MomentOf(const DicomHeader& header)
{
  const bool acquired = !header.AcquisitionTime.empty();
  const std::string& time = acquired ? header.AcquisitionTime : header.SeriesTime;
  std::string date = acquired ? header.AcquisitionDate : header.SeriesDate;
  date = date.empty() ? header.Identity.StudyDate : date;
  return time.empty() ? std::string() : date + ' ' + time;
}

void DescribeSeries(SeriesCandidate& candidate)
{
  const DicomHeader& header = candidate.First;
  StudySeries& series = candidate.Series;
  series.Description =
    header.SeriesDescription.empty() ? header.ProtocolName : header.SeriesDescription;
  if (header.SeriesNumber && std::abs(*header.SeriesNumber) < 1e9)
  {
    series.Number = static_cast<int>(*header.SeriesNumber);
  }
  series.SeriesInstanceUid = header.SeriesInstanceUid;
  series.StudyInstanceUid = header.Identity.StudyInstanceUid;
  series.FrameOfReferenceUid = header.FrameOfReferenceUid;
  series.Date = !header.AcquisitionDate.empty() ? header.AcquisitionDate
    : !header.SeriesDate.empty()                ? header.SeriesDate
                                                : header.Identity.StudyDate;
  series.Plane = PlaneOf(header);
  series.PositionCode = header.PatientPosition;
  // Head or feet first makes no difference: positions in DICOM are the patient's own.
  if (series.PositionCode == "HFP" || series.PositionCode == "FFP")
  {
    series.Position = PatientPosition::Prone;
  }
  else if (series.PositionCode == "HFS" || series.PositionCode == "FFS")
  {
    series.Position = PatientPosition::Supine;
  }
  series.Side = series.Grid ? SideOf(*series.Grid, header) : '?';
  FindFatSuppression(header, series);
  std::string evidence;
  const Weighting weighting = FindWeighting(header, evidence);
  series.Sequence = SequenceOf(header, weighting);
  const std::string why = WhyNoTissue(header, weighting, evidence);
  series.LeftOut = why.empty() ? series.LeftOut : why;
}

std::string WhyNoBreastVolume(const SeriesCandidate& candidate)
{
  const StudySeries& series = candidate.Series;
  constexpr double WidestSpacingMm = 6;
  constexpr double LeastExtentMm = 70;
  char text[128];
  if (!candidate.First.Position)
  {
    return "no place in the patient (position, orientation or pixel spacing missing)";
  }
  if (series.Slices.size() < FewestSlicesOfBreast)
  {
    return "too few slices (" + std::to_string(series.Slices.size()) + ")";
  }
  if (!series.Grid)
  {
    std::snprintf(text, sizeof text,
      "missing slices or irregular distances (%zu slices, %.2f mm apart on average)",
      series.Slices.size(), series.SliceSpacingMm);
    return text;
  }
  const Vector3& spacing = series.Grid->Spacing;
  if (const double widest = std::max({ spacing[0], spacing[1], spacing[2] });
      widest > WidestSpacingMm)
  {
    std::snprintf(text, sizeof text, "too coarse (voxels of %.1f mm, at most %.0f)", widest,
      WidestSpacingMm);
    return text;
  }
  const GridExtent extent = ExtentOf(*series.Grid);
  static const char* const names[] = { "left to right", "front to back", "head to foot" };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    if (extent.Length[axis] < LeastExtentMm)
    {
      std::snprintf(text, sizeof text, "too small a field of view (%.0f mm from %s)",
        extent.Length[axis], names[axis]);
      return text;
    }
  }
  return {};
}

namespace
{
/// What the words of one series tell of contrast.
void TellByWords(SeriesCandidate& candidate)
{
  const DicomHeader& header = candidate.First;
  StudySeries& series = candidate.Series;
  const std::string words = WordsOf(header);
  const auto tell = [&series](bool before, const std::string& evidence)
  {
    series.Contrast = before ? ContrastPhase::Before : ContrastPhase::After;
    series.ContrastEvidence = evidence;
  };
  const std::string pre = FindMeaning(words, SeriesMeaning::BeforeContrast);
  // Not the contrast that it is without: "pre contrast", "ohne KM".
  const std::size_t denied = pre.empty() ? words.size() : (' ' + words).find(' ' + pre);
  const std::string others =
    words.substr(0, denied) + words.substr(std::min(words.size(), denied + pre.size()));
  const std::string post = FindMeaning(others, SeriesMeaning::AfterContrast);
  std::smatch plus;
  static const std::regex counted("(?:^| )(\\d)\\+(\\d+)(?= |$)");
  if (std::regex_search(words, plus, counted))
  {
    // "1+5": one volume before contrast and five after it.
    const double number = series.Phases > 1 ? series.Phase : header.AcquisitionNumber.value_or(1);
    const bool before = number <= std::stod(plus[1].str());
    return tell(before,
      "acquisition " + std::to_string(static_cast<int>(std::clamp(number, 0., 1e6))) + " of " +
        plus[1].str() + "+" + plus[2].str());
  }
  if (!pre.empty() && post.empty())
  {
    return tell(true, "description '" + pre + "'");
  }
  if (!post.empty() && pre.empty())
  {
    return tell(false, "description '" + post + "'");
  }
  if (series.Phases > 1)
  {
    tell(series.Phase == 1,
      "phase " + std::to_string(series.Phase) + " of " + std::to_string(series.Phases));
  }
}

bool NamesAgent(const DicomHeader& header)
{
  const std::string agent = PlainWords(header.ContrastAgent);
  return !agent.empty() && FindMeaning(agent, SeriesMeaning::NoAgent).empty();
}

/// Volumes of one protocol, one after the other: the same but for numbers in the description.
std::string DynamicKey(const SeriesCandidate& candidate)
{
  const DicomHeader& header = candidate.First;
  std::string words = WordsOf(header);
  static const std::regex numbers("\\d(?:st|nd|rd|th)|\\d+");
  words = std::regex_replace(words, numbers, "#");
  char sizes[128];
  std::snprintf(sizes, sizeof sizes, "|%g|%g|%g|%dx%dx%zu", header.RepetitionTimeMs.value_or(0),
    header.EchoTimeMs.value_or(0), header.FlipAngleDeg.value_or(0), header.Columns, header.Rows,
    candidate.Series.Slices.size());
  return words + sizes;
}

/// Of several volumes of one protocol the first is before contrast, unless one before it says so of
/// itself and this one names an agent.
void TellByOrder(std::vector<SeriesCandidate>& candidates)
{
  std::map<std::string, std::vector<SeriesCandidate*>> groups;
  const SeriesCandidate* before = nullptr;
  for (SeriesCandidate& candidate : candidates)
  {
    before = candidate.Series.Contrast == ContrastPhase::Before ? &candidate : before;
    if (candidate.Series.LeftOut.empty() && candidate.Series.Phases == 1 &&
      candidate.Series.Contrast == ContrastPhase::Unknown)
    {
      groups[DynamicKey(candidate)].push_back(&candidate);
    }
  }
  for (auto& [key, volumes] : groups)
  {
    for (std::size_t number = 0; volumes.size() > 1 && number < volumes.size(); ++number)
    {
      StudySeries& series = volumes[number]->Series;
      const bool first = number == 0 && !(before && NamesAgent(volumes.front()->First));
      series.Contrast = first ? ContrastPhase::Before : ContrastPhase::After;
      series.ContrastEvidence = "volume " + std::to_string(number + 1) + " of " +
        std::to_string(volumes.size()) + " of one protocol";
    }
  }
}
}

void CompareScanOptions(std::vector<SeriesCandidate>& candidates)
{
  std::set<std::string> telling;
  for (const SeriesCandidate& candidate : candidates)
  {
    if (candidate.Series.FatEvidence.starts_with(ScanOptionEvidence))
    {
      telling.insert(candidate.Series.StudyInstanceUid);
    }
  }
  for (SeriesCandidate& candidate : candidates)
  {
    StudySeries& series = candidate.Series;
    if (series.Fat == FatSuppression::Unknown && candidate.First.HasScanOptions &&
      telling.count(series.StudyInstanceUid) > 0)
    {
      series.Fat = FatSuppression::Absent;
      series.FatEvidence = "ScanOptions name it in other series only";
    }
  }
}

void FindContrastPhases(std::vector<SeriesCandidate>& candidates)
{
  bool someWithout = false;
  for (SeriesCandidate& candidate : candidates)
  {
    TellByWords(candidate);
    someWithout = someWithout || !NamesAgent(candidate.First);
  }
  TellByOrder(candidates);
  // A scanner that names the agent in every header names it before the injection, too.
  bool given = false;
  std::string sinceStudy;
  for (SeriesCandidate& candidate : candidates)
  {
    StudySeries& series = candidate.Series;
    if (series.StudyInstanceUid != sinceStudy)
    {
      given = false;
      sinceStudy = series.StudyInstanceUid;
    }
    if (series.Contrast == ContrastPhase::Unknown && someWithout && NamesAgent(candidate.First))
    {
      series.Contrast = ContrastPhase::After;
      series.ContrastEvidence = "the header names an agent";
    }
    else if (series.Contrast == ContrastPhase::Unknown && given &&
      !MomentOf(candidate.First).empty())
    {
      series.Contrast = ContrastPhase::After;
      series.ContrastEvidence = "taken after a series with contrast";
    }
    given = given || series.Contrast == ContrastPhase::After;
  }
}
}
