// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SeriesWords_h
#define mammoray_Private_SeriesWords_h

#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Meaning of words in the descriptions of MRI series.
enum class SeriesMeaning
{
  // Kinds of images that no tissue is segmented from.
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
  BeforeContrast,
  AfterContrast,
  NoAgent
};

/// A row of the vocabulary of scanners (Siemens, GE, Philips) and sites.
struct SeriesWord
{
  SeriesMeaning Meaning;
  /// Language code, or "" for a term that all sites use.
  const char* Language;
  /// Regular expression for whole words in lower case without accents. <fat> stands for words for
  /// fat suppression, <agent> and <given> for words for a contrast agent.
  const char* Pattern;
  /// A description that the row recognises.
  const char* Example;
};

/// The vocabulary. Where two rows of one meaning match at one place, the earlier row counts.
MAMMORAYSTUDY_EXPORT const std::vector<SeriesWord>& SeriesVocabulary();

/// The text as HeaderWords, with accented letters of UTF-8 and Latin 1 replaced by plain ones.
MAMMORAYSTUDY_EXPORT std::string PlainWords(const std::string& text);

/// The first words with this meaning in PlainWords. Empty if there are none.
MAMMORAYSTUDY_EXPORT std::string FindMeaning(const std::string& words, SeriesMeaning meaning);

/// The regular expression of a row, its placeholders replaced.
MAMMORAYSTUDY_EXPORT std::string PatternOf(const SeriesWord& row);
}

#endif
