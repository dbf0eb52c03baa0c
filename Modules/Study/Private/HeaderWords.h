// SPDX-License-Identifier: Apache-2.0
// Words that people and scanners write into headers.
#ifndef mammoray_Private_HeaderWords_h
#define mammoray_Private_HeaderWords_h

#include "mammorayStudyModule.h"

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mammoray
{
/// Meaning of words in the descriptions of series and mammograms.
enum class HeaderMeaning
{
  Left,
  Right,
  // Kinds of MRI that no tissue is segmented from.
  Projection,
  Subtraction,
  Localizer,
  Calibration,
  Diffusion,
  ComputedMap,
  Reformat,
  PhaseImage,
  Spectrum,
  // Dixon reconstructions. The second four count only in a description that names the technique.
  WaterImage,
  FatImage,
  InPhaseImage,
  OutOfPhaseImage,
  DixonTechnique,
  DixonWater,
  DixonFat,
  DixonInPhase,
  DixonOutOfPhase,
  // Fat suppression.
  FatSuppressed,
  NotFatSuppressed,
  // Weighting.
  InversionRecovery,
  SteadyState,
  NamedWeighting,
  T1Sequence,
  // Contrast agent.
  BothContrasts,
  BeforeContrast,
  AfterContrast,
  NoAgent,
  // Mammograms.
  LeftMammogram,
  RightMammogram,
  ContrastMammogram,
  Biopsy,
  ImplantDisplaced,
  Magnified,
  SpotCompression,
  SyntheticMammogram
};

/// A row of the vocabulary of scanners (Siemens, GE, Philips) and sites: a list of words.
struct HeaderVocabularyRow
{
  HeaderMeaning Meaning;
  /// Language code, or "" for terms that all sites use.
  const char* Language;
  /// Regular expressions, separated by '|', for whole words in lower case without accents. <fat>
  /// stands for words for fat suppression, <agent> for words for a contrast agent and its
  /// injection.
  const char* Words;
  /// A description for each expression, separated by commas.
  const char* Examples;
};

/// The vocabulary. Where two expressions of one meaning match at one place, the earlier one counts.
MAMMORAYSTUDY_EXPORT const std::vector<HeaderVocabularyRow>& HeaderVocabulary();

/// The regular expression of a row, its placeholders replaced.
MAMMORAYSTUDY_EXPORT std::string PatternOf(const HeaderVocabularyRow& row);

/// A header's text in lower case, everything but letters, digits and '+' replaced by one blank.
MAMMORAYSTUDY_EXPORT std::string HeaderWords(const std::string& text);

/// The same with accented letters of UTF-8 and Latin 1 replaced by plain ones.
MAMMORAYSTUDY_EXPORT std::string PlainWords(const std::string& text);

/// The first words with this meaning in PlainWords. Empty if there are none.
MAMMORAYSTUDY_EXPORT std::string FindMeaning(const std::string& words, HeaderMeaning meaning);

/// The side that PlainWords name, 'L' or 'R'. '?' if they name none or both. `ofMammogram`: short
/// words such as "l" and "rcc" count, too.
MAMMORAYSTUDY_EXPORT char SideInWords(const std::string& words, bool ofMammogram = false);

/// The first of a header's values that equals one of `wanted`. Empty if none does.
MAMMORAYSTUDY_EXPORT std::string FindValue(const std::vector<std::string>& values,
  std::initializer_list<const char*> wanted);

/// The first of a header's values that contains one of `parts`. Empty if none does.
MAMMORAYSTUDY_EXPORT std::string FindPart(const std::vector<std::string>& values,
  std::initializer_list<const char*> parts);

/// A kind of image. An image is of this kind if its Image Type has one of `Values`, or a value that
/// contains one of `Parts`, or if its description has the meaning.
struct ImageKind
{
  const char* Name;
  HeaderMeaning Meaning;
  std::initializer_list<const char*> Values;
  std::initializer_list<const char*> Parts;
};

/// A kind that was found. Name is empty if there is none.
struct FoundKind
{
  std::string_view Name;
  /// What in the header shows it: "ImageType SUB", "description 'sub'".
  std::string Evidence;
};

/// The first of `kinds` that an image is of. `words`: PlainWords of its description.
FoundKind FindKind(std::span<const ImageKind> kinds, const std::vector<std::string>& imageType,
  const std::string& words);
}

#endif
