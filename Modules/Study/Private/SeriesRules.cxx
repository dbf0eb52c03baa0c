// SPDX-License-Identifier: Apache-2.0
// Numbers (TR, TE) count before words where both tell.
#include "Private/HeaderRules.h"
#include "Private/HeaderWords.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <regex>
#include <set>

namespace mammoray
{
namespace
{
using M = HeaderMeaning;

/// The description, or the protocol if there is none.
const std::string& DescriptionOf(const DicomHeader& header)
{
  return header.SeriesDescription.empty() ? header.ProtocolName : header.SeriesDescription;
}

std::string WordsOf(const DicomHeader& header)
{
  return PlainWords(DescriptionOf(header));
}

/// First words of the evidence where scan options name fat suppression.
const std::string ScanOptionEvidence = "ScanOptions ";

/// Kinds of MRI that no tissue is segmented from.
const ImageKind OtherKinds[] = {
  { "projection", M::Projection, { "PROJECTION IMAGE" }, { "MIP" } },
  { "subtraction", M::Subtraction, { "SUB" }, { "SUBTR" } },
  { "localizer", M::Localizer, { "SURVEY", "SCOUT" }, { "LOCALI" } },
  { "calibration", M::Calibration, {}, {} },
  { "diffusion", M::Diffusion, { "ADC" }, { "DIFFUSION", "TRACE", "ADC_" } },
  { "map computed from others", M::ComputedMap,
    { "MAP", "FIT", "TTP", "PEI", "MIPT", "IAUC", "WASH_IN", "WASH_OUT" },
    { "T1 MAP", "T2 MAP", "T1_MAP", "T2_MAP", "PARAMETRIC", "PERFUSION", "COLOR", "T2_STAR" } },
  { "reformat of another series", M::Reformat, {}, { "MPR", "REFORMAT" } },
  { "phase image", M::PhaseImage, { "P", "R", "I", "PHASE MAP", "PHASE" }, { "VELOCITY" } },
  { "spectrum", M::Spectrum, { "SPECTROSCOPY" }, {} },
};

/// Dixon reconstructions: images of water, of fat, and of both in or out of phase.
const ImageKind DixonKinds[] = {
  { "water", M::WaterImage, { "W", "WATER", "W_FFE" }, {} },
  { "fat alone", M::FatImage, { "F", "FAT", "F_FFE" }, {} },
  { "in phase", M::InPhaseImage, { "IP", "IN_PHASE", "INPHASE", "IP_FFE" }, {} },
  { "opposed phase", M::OutOfPhaseImage,
    { "OP", "OUT_PHASE", "OUTPHASE", "OPP_PHASE", "OPPOSED_PHASE", "OP_FFE" }, {} },
};
/// The same by descriptions that name the technique: "t1_vibe_dixon_tra_W" (Siemens).
const ImageKind NamedDixonKinds[] = {
  { "water", M::DixonWater, {}, {} },
  { "fat alone", M::DixonFat, {}, {} },
  { "in phase", M::DixonInPhase, {}, {} },
  { "opposed phase", M::DixonOutOfPhase, {}, {} },
};

FoundKind FindDixon(const DicomHeader& header)
{
  const FoundKind byType = FindKind(DixonKinds, header.ImageType, {});
  const std::string words = WordsOf(header);
  return !byType.Name.empty()                       ? byType
    : FindMeaning(words, M::DixonTechnique).empty() ? FindKind(DixonKinds, {}, words)
                                                    : FindKind(NamedDixonKinds, {}, words);
}

void FindFatSuppression(StudySeries& series)
{
  const DicomHeader& header = series.Header;
  const auto tell = [&series](FatSuppression fat, const std::string& evidence)
  {
    series.Fat = fat;
    series.FatEvidence = evidence;
  };
  if (const FoundKind dixon = FindDixon(header); !dixon.Name.empty())
  {
    return tell(dixon.Name == "water" ? FatSuppression::Present : FatSuppression::Absent,
      dixon.Evidence);
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
  const std::string words =
    PlainWords(header.SeriesDescription + ' ' + header.ProtocolName + ' ' + header.SequenceName);
  if (const std::string none = FindMeaning(words, M::NotFatSuppressed); !none.empty())
  {
    return tell(FatSuppression::Absent, "description '" + none + "'");
  }
  if (const std::string some = FindMeaning(words, M::FatSuppressed); !some.empty())
  {
    return tell(FatSuppression::Present, "description '" + some + "'");
  }
  if (header.SpectralSuppression == "NONE")
  {
    return tell(FatSuppression::Absent, "Spectrally Selected Suppression NONE");
  }
  // Siemens writes the option wherever fat is suppressed.
  if (header.HasScanOptions &&
    HeaderWords(header.Manufacturer).find("siemens") != std::string::npos)
  {
    tell(FatSuppression::Absent, "ScanOptions of this maker without FS");
  }
}

/// What makes tissues bright and dark in a series.
struct Weighting
{
  /// In front of the sequence's name, with a blank.
  const char* Short;
  /// As a reason to leave the series out. Empty for T1.
  const char* Long;
  /// What in the header shows it.
  std::string Evidence;

  static Weighting T1(const std::string& evidence) { return { "T1 ", "", evidence }; }
  static Weighting T2(const std::string& evidence) { return { "T2 ", "T2-weighted", evidence }; }
  static Weighting ProtonDensity(const std::string& evidence)
  {
    return { "PD ", "proton density", evidence };
  }
  static Weighting InversionRecovery(const std::string& evidence)
  {
    return { "IR ", "inversion recovery", evidence };
  }
};

/// Spin echoes by TR and TE, gradient echoes by TE, both by words where numbers leave it open.
Weighting FindWeighting(const DicomHeader& header)
{
  const std::string words = WordsOf(header);
  const auto quoted = [](const std::string& word) { return "description '" + word + "'"; };
  const double tr = header.RepetitionTimeMs.value_or(0);
  const double te = header.EchoTimeMs.value_or(0);
  const double ti = header.InversionTimeMs.value_or(0);
  const bool inversion = !FindValue(header.ScanningSequence, { "IR" }).empty();
  const bool spin = !FindValue(header.ScanningSequence, { "SE" }).empty() || inversion;
  const bool gradient = !FindValue(header.ScanningSequence, { "GR" }).empty() && !spin;
  if (const std::string word = FindMeaning(words, M::InversionRecovery); !word.empty())
  {
    return Weighting::InversionRecovery(quoted(word));
  }
  if (inversion && ti > 80 && ti < 300 && tr > 1500)
  {
    return Weighting::InversionRecovery("inversion time of fat");
  }
  if (const std::string word = FindMeaning(words, M::SteadyState); !word.empty())
  {
    return { "", "steady state", quoted(word) };
  }
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "TR %g TE %g ms", tr, te);
  // Between these the words decide: the T1 of fat is 0.25-0.4 s, of gland 0.9-1.5 s, their T2
  // 50-70 ms.
  if (spin && tr > 0 && te >= 60)
  {
    return Weighting::T2(numbers);
  }
  if (spin && tr > 0 && te > 0 && te <= 35 && tr <= 1200)
  {
    return Weighting::T1(numbers);
  }
  const std::string word = FindMeaning(words, M::NamedWeighting);
  if (!word.empty() && !(gradient && te > 0 && te < 8 && tr < 100))
  {
    return word.find("t1") != std::string::npos ? Weighting::T1(quoted(word))
      : word.find("t2") != std::string::npos    ? Weighting::T2(quoted(word))
                                                : Weighting::ProtonDensity(quoted(word));
  }
  if (gradient && te > 0)
  {
    return te < 15 ? Weighting::T1(numbers) : Weighting::T2(numbers);
  }
  if (spin && te > 0)
  {
    return Weighting::ProtonDensity(numbers);
  }
  return header.AcquisitionContrast == "T1" || !FindMeaning(words, M::T1Sequence).empty()
    ? Weighting::T1("")
    : Weighting{ "", "not known to be T1-weighted", "neither TR and TE nor the description tell" };
}

std::string SequenceOf(const DicomHeader& header, const Weighting& weighting)
{
  const bool spin = !FindValue(header.ScanningSequence, { "SE" }).empty();
  const bool gradient = !FindValue(header.ScanningSequence, { "GR" }).empty();
  std::string text = weighting.Short;
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

/// Why the header of a slice says that it does not show tissue as it is. Empty if it does not.
std::string WhyNoTissue(const DicomHeader& header, const Weighting& weighting)
{
  const auto named = [](std::string_view name, const std::string& evidence)
  { return std::string(name) + " (" + evidence + ")"; };
  if (header.SamplesPerPixel > 1 || header.SopClassUid.starts_with(SecondaryCaptureClass))
  {
    return "screenshot (colours or secondary capture)";
  }
  if (header.Frames > 1)
  {
    return "multi-frame object without functional groups";
  }
  const FoundKind other = FindKind(OtherKinds, header.ImageType, WordsOf(header));
  if (!other.Name.empty())
  {
    return named(other.Name, other.Evidence);
  }
  if (header.DiffusionBValue.value_or(0) > 0 ||
    !FindValue(header.ScanningSequence, { "EP" }).empty())
  {
    return "diffusion (echo-planar or with a b-value)";
  }
  const FoundKind dixon = FindDixon(header);
  if (dixon.Name == "fat alone")
  {
    return named(dixon.Name, dixon.Evidence);
  }
  if (dixon.Name == "opposed phase")
  {
    return named(dixon.Name, dixon.Evidence + ": fat and water cancel at their borders");
  }
  return *weighting.Long == '\0' ? "" : named(weighting.Long, weighting.Evidence);
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

char SideOf(const VolumeGrid& grid, const DicomHeader& header)
{
  const GridExtent extent = ExtentOf(grid);
  // Both breasts are wider than this together, and one is not.
  if (extent.Length[0] > 220)
  {
    return 'B';
  }
  if (std::abs(extent.Middle[0]) >= 25)
  {
    return extent.Middle[0] > 0 ? 'L' : 'R';
  }
  // One breast that was moved to the magnet's middle: only the header tells.
  return header.Laterality != '?' ? header.Laterality : SideInWords(WordsOf(header));
}

/// Why the volume is not one of a breast by its grid or the lack of one. Empty if it is.
std::string WhyNoBreastVolume(const StudySeries& series)
{
  constexpr double WidestSpacingMm = 6;
  constexpr double LeastExtentMm = 70;
  char text[128];
  if (!series.Header.Position)
  {
    return "no place in the patient (position, orientation or pixel spacing missing)";
  }
  if (series.Slices.size() < FewestSlicesOfBreast)
  {
    return "too few slices (" + std::to_string(series.Slices.size()) + ")";
  }
  if (!series.Grid && !series.WhyNoGrid.empty())
  {
    return series.WhyNoGrid;
  }
  if (!series.Grid)
  {
    std::snprintf(text, sizeof text,
      "missing slices or irregular distances (%zu slices, %.2f mm apart on average)",
      series.Slices.size(), series.SliceSpacingMm);
    return text;
  }
  const Vector3& spacing = series.Grid->Spacing;
  const double widest = *std::max_element(spacing.begin(), spacing.end());
  if (widest > WidestSpacingMm)
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

bool NamesAgent(const StudySeries& series)
{
  const std::string agent = PlainWords(series.Header.ContrastAgent);
  return !agent.empty() && FindMeaning(agent, M::NoAgent).empty();
}

/// Words of a description with '#' for each number that may count volumes, and these numbers.
struct NumberedWords
{
  std::string Pattern;
  std::vector<double> Numbers;

  explicit NumberedWords(const std::string& words)
  {
    // "t1" and "3d" count nothing.
    static const std::regex number("(?:^| )t[12]|\\d+d|(\\d+)(?:st|nd|rd|th)?");
    auto last = words.begin();
    for (std::sregex_iterator found(words.begin(), words.end(), number), end; found != end; ++found)
    {
      this->Pattern.append(last, (*found)[0].first);
      last = (*found)[0].second;
      const bool counts = (*found)[1].matched;
      this->Pattern += counts ? "#" : found->str();
      if (counts)
      {
        this->Numbers.push_back(std::strtod((*found)[1].str().c_str(), nullptr));
      }
    }
    this->Pattern.append(last, words.end());
  }

  /// Which number is part of what `plain` lacks of this pattern, one piece: of "ph# ax dyn" and "ax
  /// dyn" the first, 0. Nothing if they differ otherwise.
  std::optional<std::size_t> CounterBeyond(const NumberedWords& plain) const
  {
    const std::string& all = this->Pattern;
    const std::string& some = plain.Pattern;
    if (some.empty() || all.size() <= some.size())
    {
      return {};
    }
    for (std::size_t before = 0; before <= some.size(); ++before)
    {
      const std::string piece = all.substr(before, all.size() - some.size());
      if (all.compare(0, before, some, 0, before) == 0 &&
        all.compare(before + piece.size(), std::string::npos, some, before) == 0 &&
        piece.find('#') != std::string::npos)
      {
        return static_cast<std::size_t>(std::count(all.begin(), all.begin() + before, '#'));
      }
    }
    return {};
  }
};

/// Volumes of one protocol in their order: the same but for numbers in the description.
struct DynamicGroup
{
  NumberedWords Words;
  std::vector<StudySeries*> Volumes;
};

/// Whether two series differ in nothing but what their descriptions say. Images whose distortion a
/// scanner has corrected are copies of those that it has not.
bool IsOfOneProtocol(const StudySeries& a, const StudySeries& b)
{
  const auto corrected = [](const StudySeries& series) {
    return FindValue(series.Header.ImageType, { "ND", "DIS2D", "DIS3D" });
  };
  // A fiftieth: scanners adapt the repetition time a little.
  const auto near = [](const std::optional<double>& x, const std::optional<double>& y)
  { return std::abs(x.value_or(0) - y.value_or(0)) <= 0.02 * std::abs(x.value_or(0)); };
  const DicomHeader& first = a.Header;
  const DicomHeader& second = b.Header;
  return first.Identity.StudyInstanceUid == second.Identity.StudyInstanceUid && a.Fat == b.Fat &&
    a.Side == b.Side && corrected(a) == corrected(b) && a.Slices.size() == b.Slices.size() &&
    first.Columns == second.Columns && first.Rows == second.Rows &&
    near(first.RepetitionTimeMs, second.RepetitionTimeMs) &&
    near(first.EchoTimeMs, second.EchoTimeMs) && near(first.FlipAngleDeg, second.FlipAngleDeg);
}

/// Whether another series of the same words and protocol has the same number of its acquisition, or
/// none as this one: six series "dyn 1+5".
bool SharesAcquisition(const StudySeries& series, const std::vector<StudySeries>& all)
{
  return std::any_of(all.begin(), all.end(),
    [&series](const StudySeries& other)
    {
      return &other != &series && other.LeftOut.empty() && IsOfOneProtocol(series, other) &&
        other.Header.AcquisitionNumber == series.Header.AcquisitionNumber &&
        WordsOf(other.Header) == WordsOf(series.Header);
    });
}

/// How many volumes "1+5" has before contrast. Nothing if the words count none.
std::optional<double> CountBefore(const std::string& words)
{
  static const std::regex counted("(?:^| )(\\d)\\+(\\d+)(?= |$)");
  std::smatch plus;
  return std::regex_search(words, plus, counted) ? std::optional(std::stod(plus[1].str()))
                                                 : std::nullopt;
}

/// Fills in the contrast phase if the words of a series tell it, with its number where they count.
void TellByWords(StudySeries& series, const std::vector<StudySeries>& all)
{
  const std::string words = WordsOf(series.Header);
  const auto tell = [&series](bool before, const std::string& evidence)
  {
    series.Contrast = before ? ContrastPhase::Before : ContrastPhase::After;
    series.ContrastEvidence = evidence;
  };
  if (const std::optional<double> before = CountBefore(words))
  {
    const std::optional<double> number = series.Phases > 1 ? std::optional<double>(series.Phase)
      : SharesAcquisition(series, all)                     ? std::nullopt
                                                           : series.Header.AcquisitionNumber;
    if (number)
    {
      tell(*number <= *before,
        "acquisition " + std::to_string(static_cast<int>(std::clamp(*number, 0., 1e6))) + " of '" +
          series.Description + "'");
    }
    return; // Otherwise the order tells.
  }
  if (!FindMeaning(words, M::BothContrasts).empty())
  {
    return;
  }
  const std::string pre = FindMeaning(words, M::BeforeContrast);
  // Not the contrast that it is without: "pre contrast", "ohne KM".
  std::string others = words;
  if (!pre.empty())
  {
    others.erase((' ' + words).find(' ' + pre), pre.size());
  }
  const std::string post = FindMeaning(others, M::AfterContrast);
  if (pre.empty() != post.empty())
  {
    tell(post.empty(), "description '" + pre + post + "'");
  }
}

/// Groups the volumes whose contrast no words tell.
std::vector<DynamicGroup> FindDynamicGroups(std::vector<StudySeries>& all)
{
  std::vector<DynamicGroup> groups;
  for (StudySeries& series : all)
  {
    if (!series.LeftOut.empty() || series.Contrast != ContrastPhase::Unknown)
    {
      continue;
    }
    const NumberedWords words(WordsOf(series.Header));
    const auto alike = std::find_if(groups.begin(), groups.end(),
      [&](const DynamicGroup& group)
      {
        return group.Words.Pattern == words.Pattern &&
          IsOfOneProtocol(*group.Volumes.front(), series);
      });
    if (alike != groups.end())
    {
      alike->Volumes.push_back(&series);
    }
    else
    {
      groups.push_back({ words, { &series } });
    }
  }
  return groups;
}

/// The group's last earlier volume of the same protocol that says "pre" or lacks the group's
/// number: "ax dyn" of "Ph1/ax dyn", "Ph2/ax dyn". Null if there is none, or numbers start at 0.
StudySeries* FindUncounted(const DynamicGroup& group, std::vector<StudySeries>& all)
{
  StudySeries* found = nullptr;
  for (StudySeries& series : all)
  {
    if (&series == group.Volumes.front() || CountBefore(WordsOf(group.Volumes.front()->Header)))
    {
      break;
    }
    std::string words = ' ' + WordsOf(series.Header) + ' ';
    const std::string pre = FindMeaning(words, M::BeforeContrast);
    if (!pre.empty())
    {
      words.replace(words.find(' ' + pre + ' '), pre.size() + 2, " ");
    }
    const auto begin = words.find_first_not_of(' ');
    const NumberedWords plain(begin == std::string::npos
        ? std::string()
        : words.substr(begin, words.find_last_not_of(' ') + 1 - begin));
    const auto counter = group.Words.CounterBeyond(plain);
    const bool counted = counter &&
      std::all_of(group.Volumes.begin(), group.Volumes.end(),
        [&counter](const StudySeries* volume)
        { return NumberedWords(WordsOf(volume->Header)).Numbers.at(*counter) >= 1; });
    const bool saysPre = !pre.empty() && plain.Pattern == group.Words.Pattern;
    if ((counted || saysPre) && series.LeftOut.empty() && series.Contrast != ContrastPhase::After &&
      IsOfOneProtocol(series, *group.Volumes.front()))
    {
      found = &series;
    }
  }
  return found;
}

/// Whether the name of a subtraction has the volume's number as what it subtracts: "Ph2-Ph1".
bool IsSubtracted(const StudySeries& volume, const std::vector<StudySeries>& all)
{
  const std::vector<double> numbers = NumberedWords(WordsOf(volume.Header)).Numbers;
  return std::any_of(all.begin(), all.end(),
    [&](const StudySeries& series)
    {
      const std::vector<double> pair = NumberedWords(WordsOf(series.Header)).Numbers;
      return series.LeftOut.starts_with("subtraction") && pair.size() == 2 && pair[0] > pair[1] &&
        series.Header.Identity.StudyInstanceUid == volume.Header.Identity.StudyInstanceUid &&
        std::count(numbers.begin(), numbers.end(), pair[1]) > 0;
    });
}

/// Volumes of which nothing is said are before contrast if later ones of their protocol, which
/// count from 1, say that they are after it: "ax dyn" of "ax dyn 1st pass".
void TellUncounted(std::vector<StudySeries>& all)
{
  for (StudySeries& plain : all)
  {
    if (!plain.LeftOut.empty() || plain.Contrast != ContrastPhase::Unknown)
    {
      continue;
    }
    const NumberedWords words(WordsOf(plain.Header));
    const auto counted = std::find_if(all.begin(), all.end(),
      [&](const StudySeries& other)
      {
        return &other > &plain && other.LeftOut.empty() && other.Contrast == ContrastPhase::After &&
          IsOfOneProtocol(plain, other) &&
          NumberedWords(WordsOf(other.Header)).CounterBeyond(words);
      });
    if (counted != all.end())
    {
      plain.Contrast = ContrastPhase::Before;
      plain.ContrastEvidence = "'" + counted->Description + "' of its protocol follows it";
      plain.ContrastByOrder = MomentOf(plain.Header).empty() || MomentOf(counted->Header).empty();
    }
  }
}

/// The first of several volumes of one protocol, or as many as "2+4" says, is before contrast,
/// unless an earlier series says so of itself and this one names an agent, or an earlier one lacks
/// the number that these have. Their order alone makes nothing certain.
void TellByOrder(std::vector<StudySeries>& all)
{
  TellUncounted(all);
  for (const DynamicGroup& group : FindDynamicGroups(all))
  {
    const std::vector<StudySeries*>& volumes = group.Volumes;
    StudySeries& front = *volumes.front();
    const auto tell = [](StudySeries& series, bool before, const std::string& evidence)
    {
      series.Contrast = before ? ContrastPhase::Before : ContrastPhase::After;
      series.ContrastEvidence = evidence;
    };
    if (StudySeries* const plain = FindUncounted(group, all))
    {
      for (StudySeries* const volume : volumes)
      {
        tell(*volume, false, "follows '" + plain->Description + "' of its protocol");
      }
      if (plain->Contrast == ContrastPhase::Unknown || plain->ContrastByOrder)
      {
        tell(*plain, true, "'" + front.Description + "' of its protocol follows it");
        plain->ContrastByOrder = MomentOf(plain->Header).empty() || MomentOf(front.Header).empty();
      }
      continue;
    }
    if (volumes.size() < 2)
    {
      continue;
    }
    const bool before = std::any_of(all.data(), volumes.front(),
      [](const StudySeries& series) { return series.Contrast == ContrastPhase::Before; });
    const bool oneSeries = front.Phases == static_cast<int>(volumes.size());
    const bool agentTells = !NamesAgent(front) &&
      std::any_of(volumes.begin(), volumes.end(),
        [](const StudySeries* v) { return NamesAgent(*v); });
    const auto first = static_cast<std::size_t>(CountBefore(WordsOf(front.Header)).value_or(1));
    for (std::size_t number = 0; number < volumes.size(); ++number)
    {
      StudySeries& volume = *volumes[number];
      tell(volume, number < first && !(before && NamesAgent(front)),
        (oneSeries ? "phase " : "volume ") + std::to_string(number + 1) + " of " +
          std::to_string(volumes.size()) + (oneSeries ? "" : " of one protocol"));
      volume.ContrastByOrder =
        volume.Contrast == ContrastPhase::Before && !agentTells && !IsSubtracted(volume, all);
    }
  }
}

/// By the time at which the injection began, where it lies within the examination: some scanners
/// write any time there.
void TellByInjection(std::vector<StudySeries>& all)
{
  for (StudySeries& series : all)
  {
    const std::string& start = series.Header.ContrastStartTime;
    const std::string& time = series.Header.AcquisitionTime;
    const auto other = [&](bool later)
    {
      return std::any_of(all.begin(), all.end(),
        [&](const StudySeries& one)
        {
          const std::string& moment = one.Header.AcquisitionTime;
          return one.Header.Identity.StudyInstanceUid == series.Header.Identity.StudyInstanceUid &&
            !moment.empty() && (later ? moment > start : moment < start);
        });
    };
    if (start.empty() || time.empty() || !other(false) || !other(true))
    {
      continue;
    }
    if (series.Contrast == ContrastPhase::Before && time > start)
    {
      series.ContrastEvidence += ", though its header has the injection before it";
    }
    if (series.Contrast == ContrastPhase::Unknown)
    {
      series.Contrast = time < start ? ContrastPhase::Before : ContrastPhase::After;
      series.ContrastEvidence = std::string("taken ") + (time < start ? "before" : "after") +
        " the time of the injection in its header";
    }
  }
}

void CompareScanOptions(std::vector<StudySeries>& all)
{
  std::set<std::string> telling;
  for (const StudySeries& series : all)
  {
    if (series.FatEvidence.starts_with(ScanOptionEvidence))
    {
      telling.insert(series.Header.Identity.StudyInstanceUid);
    }
  }
  for (StudySeries& series : all)
  {
    if (series.Fat == FatSuppression::Unknown && series.Header.HasScanOptions &&
      telling.count(series.Header.Identity.StudyInstanceUid) > 0)
    {
      series.Fat = FatSuppression::Absent;
      series.FatEvidence = "ScanOptions name it in other series only";
    }
  }
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

void DescribeSeries(StudySeries& series)
{
  const DicomHeader& header = series.Header;
  series.Description = DescriptionOf(header);
  series.Date = !header.AcquisitionDate.empty() ? header.AcquisitionDate
    : !header.SeriesDate.empty()                ? header.SeriesDate
                                                : header.Identity.StudyDate;
  series.Plane = PlaneOf(header);
  // Head or feet first makes no difference: positions in DICOM are the patient's own.
  const std::string& code = header.PatientPosition;
  if (code == "HFP" || code == "FFP")
  {
    series.Position = PatientPosition::Prone;
  }
  else if (code == "HFS" || code == "FFS")
  {
    series.Position = PatientPosition::Supine;
  }
  series.Side = series.Grid ? SideOf(*series.Grid, header) : '?';
  FindFatSuppression(series);
  const Weighting weighting = FindWeighting(header);
  series.Sequence = SequenceOf(header, weighting);
  const std::string why = WhyNoTissue(header, weighting);
  series.LeftOut = why.empty() ? series.LeftOut : why;
  series.LeftOut = series.LeftOut.empty() ? WhyNoBreastVolume(series) : series.LeftOut;
}

void CompareSeries(std::vector<StudySeries>& all)
{
  CompareScanOptions(all);
  std::for_each(all.begin(), all.end(), [&all](StudySeries& series) { TellByWords(series, all); });
  TellByInjection(all);
  TellByOrder(all);
  // A scanner that names the agent in every header names it before the injection, too.
  const bool agentTells = !std::all_of(all.begin(), all.end(), NamesAgent);
  bool given = false;
  std::string sinceStudy;
  for (StudySeries& series : all)
  {
    const std::string& study = series.Header.Identity.StudyInstanceUid;
    given = given && study == sinceStudy;
    sinceStudy = study;
    const bool isNamed = agentTells && NamesAgent(series);
    const bool follows = given && !MomentOf(series.Header).empty();
    if (series.Contrast == ContrastPhase::Unknown && (isNamed || follows))
    {
      series.Contrast = ContrastPhase::After;
      series.ContrastEvidence =
        isNamed ? "the header names an agent" : "taken after a series with contrast";
    }
    given = given || series.Contrast == ContrastPhase::After;
  }
}
}
