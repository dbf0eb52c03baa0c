// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MammogramViews_h
#define mammoray_Private_MammogramViews_h

#include "mammoray/Foundation/Mammogram.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

class DcmItem;

namespace mammoray
{
/// A view of DICOM context group 4014: codes of SNOMED CT and, in older files, SNOMED RT, View
/// Position and the code's meaning.
struct MammogramView
{
  const char* SnomedCt;
  const char* SnomedRt;
  const char* Name;
  const char* Meaning;
};

inline constexpr MammogramView MammogramViews[] = {
  { "399162004", "R-10242", "CC", "cranio-caudal" },
  { "399368009", "R-10226", "MLO", "medio-lateral oblique" },
  { "399260004", "R-10224", "ML", "medio-lateral" },
  { "399352003", "R-10228", "LM", "latero-medial" },
  { "399099002", "R-10230", "LMO", "latero-medial oblique" },
  { "399196006", "R-10244", "FB", "caudo-cranial (from below)" },
};

/// View Position, or the name of the view code; unknown codes yield their meaning. Empty if the
/// header has neither.
std::string MammogramViewOf(DcmItem& data);

/// Meanings of the view modifier codes (context group 4015).
std::vector<std::string> MammogramViewModifiers(DcmItem& data);

/// 'L', 'R' or '?'.
char MammogramLaterality(DcmItem& data);

/// Notes views and sides of one header that contradict each other, and which of them is taken.
void NoteContradictions(DcmItem& data, const std::string& path);

/// Distances of rows and of columns at the receptor, mm: Imager Pixel Spacing, or else Pixel
/// Spacing times the magnification. Nothing if they are not known; `why` is the refusal then:
/// "expected Imager Pixel Spacing ..., found neither: ...".
std::optional<std::array<double, 2>> ReceptorSpacingOf(DcmItem& data, std::string& why);

/// IsForProcessingClass is true for mammograms and tomosynthesis projections For Processing,
/// IsBreastProjection for tomosynthesis projections of either intent (PS3.3 A.74).
bool IsForProcessingClass(const std::string& sopClass);
bool IsBreastProjection(const std::string& sopClass);

/// Presentation Intent Type, or the intent of the SOP class if that is missing.
Mammogram::Intent MammogramIntent(DcmItem& data);
}

#endif
