// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Assessment_h
#define mammoray_Assessment_h

#include "mammoray/Registration/Registration.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// How far a result may be relied on.
enum class Trust
{
  Good,
  Doubtful,
  None
};

/// "good", "doubtful" or "none".
MAMMORAYSTUDY_EXPORT const char* NameOf(Trust trust);

/// The same in words: "The two mammograms match", "The match should be checked by eye", "The match
/// is not to be trusted".
MAMMORAYSTUDY_EXPORT const char* VerdictOf(Trust trust);

struct Assessment
{
  Trust Level = Trust::Good;
  /// Why not better, a sentence each in plain words.
  std::vector<std::string> Reasons;
};

/// Tissue correlations (Agreement::TissueCorrelation) from which on pictures are those of one
/// breast, and below which they are not. Of wrong results (of another breast, or off by more than 5
/// mm) the most was 0.47, of right ones 4 % have less than 0.55 (docs/accuracy.md, "Trust").
inline constexpr double GoodTissueCorrelation = 0.55;
inline constexpr double LeastTissueCorrelation = 0.3;

/**
 * Judges a result by its figures. Whether picture and volume are of one breast, the correlation of
 * the tissue tells: below GoodTissueCorrelation doubtful, below LeastTissueCorrelation none. What
 * else is doubtful: a correlation of the whole below 0.5, mean outline distance
 * above 1.5 mm (3 mm: none), largest above 5 mm (10 mm: none), a search that did not converge, a
 * parameter at its bound or more than three standard deviations (its prior's and its own) away from
 * where it was expected, figures that are not numbers (none). Doubtful, too, is what mechanics do
 * not settle: a plate that presses with less than a twentieth of the other's force, where the chest
 * wall holds the breast instead, a breast that glides along the chest wall by more than 30 mm, and
 * one that has another equilibrium at this pose, 3 mm off on average or more. So is what the header
 * disagrees on: a thickness more than 5 mm or 15 % from the one found, as far as units may be off
 * (twice as much: none), and RegistrationResult::Disagreements. The limits are rules of thumb, not
 * clinical validation.
 */
MAMMORAYSTUDY_EXPORT Assessment Assess(const RegistrationResult& result);

/// Whether a free parameter's value lies at a bound, up to a thousandth of the way between them.
MAMMORAYSTUDY_EXPORT bool AtBound(const RegistrationParameter& parameter, double value);
}

#endif
