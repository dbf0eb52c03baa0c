// SPDX-License-Identifier: Apache-2.0
#include "Private/MammogramViews.h"

#include "Private/DicomFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
/// Modifiers whose code older files give without a meaning, or in another language.
struct ModifierCode
{
  const char* SnomedCt;
  const char* SnomedRt;
  const char* Meaning;
};

constexpr ModifierCode ModifierCodes[] = {
  { "399161006", "R-102D2", "Cleavage" },
  { "399011000", "R-102D1", "Axillary Tail" },
  { "399197002", "R-102D3", "Rolled Lateral" },
  { "399226006", "R-102D4", "Rolled Medial" },
  { "414493004", "R-102CA", "Rolled Inferior" },
  { "415670009", "R-102C9", "Rolled Superior" },
  { "399209000", "R-102D5", "Implant Displaced" },
  { "399163009", "R-102D6", "Magnification" },
  { "399055006", "R-102D7", "Spot Compression" },
  { "399110001", "R-102C2", "Tangential" },
  { "442581004", "R-40AB3", "Nipple in profile" },
  { "441752004", "P2-00161", "Anterior compression" },
  { "442593008", "R-40ABE", "Infra-mammary fold" },
  { "442580003", "R-40AB2", "Axillary tissue" },
};

std::string ModifierOf(DcmItem& item)
{
  const std::string code = DicomText(item, DCM_CodeValue);
  for (const ModifierCode& known : ModifierCodes)
  {
    if (code == known.SnomedCt || code == known.SnomedRt)
    {
      return known.Meaning;
    }
  }
  const std::string meaning = EscapeControls(DicomText(item, DCM_CodeMeaning));
  return meaning.empty() ? code : meaning;
}

void AddModifiers(DcmItem& data, std::vector<std::string>& modifiers)
{
  DcmItem* item = nullptr;
  for (signed long index = 0;
       data.findAndGetSequenceItem(DCM_ViewModifierCodeSequence, item, index).good() && item;
       ++index)
  {
    modifiers.push_back(ModifierOf(*item));
  }
}
/// The view of the code; null if there is none or it is another one.
const MammogramView* CodedView(DcmItem& data)
{
  DcmItem* item = DicomFirstItem(data, DCM_ViewCodeSequence);
  const std::string code = item ? DicomText(*item, DCM_CodeValue) : "";
  const auto* const found = std::find_if(std::begin(MammogramViews), std::end(MammogramViews),
    [&code](const MammogramView& view) { return code == view.SnomedCt || code == view.SnomedRt; });
  return found == std::end(MammogramViews) ? nullptr : found;
}

/// Elements that tell the side, the first that does so counts.
const std::pair<DcmTagKey, const char*> Lateralities[] = {
  { DCM_ImageLaterality, "Image Laterality (0020,0062)" },
  { DCM_Laterality, "Laterality (0020,0060)" },
  { DCM_FrameLaterality, "Frame Laterality (0020,9072)" },
};
}

std::string MammogramViewOf(DcmItem& data)
{
  std::string position = EscapeControls(DicomText(data, DCM_ViewPosition));
  DcmItem* item = DicomFirstItem(data, DCM_ViewCodeSequence);
  if (!position.empty() || !item)
  {
    return position;
  }
  const MammogramView* const view = CodedView(data);
  return view ? view->Name : EscapeControls(DicomText(*item, DCM_CodeMeaning));
}

std::vector<std::string> MammogramViewModifiers(DcmItem& data)
{
  std::vector<std::string> modifiers;
  // Within the view's code as the standard has it, beside it in some files.
  if (DcmItem* view = DicomFirstItem(data, DCM_ViewCodeSequence))
  {
    AddModifiers(*view, modifiers);
  }
  AddModifiers(data, modifiers);
  return modifiers;
}

char MammogramLaterality(DcmItem& data)
{
  for (const auto& [tag, name] : Lateralities)
  {
    const std::string value = DicomText(data, tag);
    if (value == "L" || value == "R")
    {
      return value[0];
    }
  }
  return '?';
}

void NoteContradictions(DcmItem& data, const std::string& path)
{
  const std::string position = DicomText(data, DCM_ViewPosition);
  const bool isKnown = std::any_of(std::begin(MammogramViews), std::end(MammogramViews),
    [&position](const MammogramView& view) { return position == view.Name; });
  if (const MammogramView* const coded = CodedView(data);
      coded && isKnown && position != coded->Name)
  {
    Note({ path,
      "its View Position (0018,5101) says " + position + ", its View Code Sequence (0054,0220) " +
        coded->Name + " (" + coded->Meaning + "); " + position + " is taken" });
  }
  std::string taken;
  std::string from;
  for (const auto& [tag, name] : Lateralities)
  {
    const std::string value = DicomText(data, tag);
    if (value != "L" && value != "R")
    {
      continue;
    }
    if (!taken.empty() && value != taken)
    {
      Note({ path,
        "its " + from + " says " + taken + ", its " + name + " " + value + "; " + taken +
          " is taken" });
    }
    from = taken.empty() ? name : from;
    taken = taken.empty() ? value : taken;
  }
}

std::optional<std::array<double, 2>> ReceptorSpacingOf(DcmItem& data, std::string& why)
{
  const double magnification =
    DicomNumber(data, DCM_EstimatedRadiographicMagnificationFactor).value_or(0);
  std::string found;
  for (const auto& [tag, name, scale] :
    { std::tuple(DCM_ImagerPixelSpacing, "Imager Pixel Spacing ", 1.0),
      // Of digitised film, which lay on the receptor.
      std::tuple(DCM_NominalScannedPixelSpacing, "Nominal Scanned Pixel Spacing ", 1.0),
      std::tuple(DCM_PixelSpacing, "Pixel Spacing ", magnification) })
  {
    // Row spacing comes first in DICOM.
    const std::optional<double> row = DicomNumber(data, tag, 0);
    const std::optional<double> column = DicomNumber(data, tag, 1);
    if (row && column && *row > 0 && *column > 0 && scale > 0)
    {
      return std::array{ scale * *row, scale * *column };
    }
    if (row)
    {
      const bool isSize = column && *row > 0 && *column > 0;
      found += (found.empty() ? "" : ", ") + NumberText(*row) +
        (column ? " x " + NumberText(*column) : " alone") + " as " + name +
        (isSize ? "without magnification" : "");
    }
  }
  found.erase(found.find_last_not_of(' ') + 1);
  why = "expected Imager Pixel Spacing (0018,1164), Nominal Scanned Pixel Spacing (0018,2010) of a "
        "film, or Pixel Spacing with Estimated Radiographic Magnification Factor, found " +
    (found.empty() ? "none" : found) + ": the size of a pixel is not known";
  return std::nullopt;
}

bool IsForProcessingClass(const std::string& sopClass)
{
  return sopClass == UID_DigitalMammographyXRayImageStorageForProcessing ||
    sopClass == UID_BreastProjectionXRayImageStorageForProcessing;
}

bool IsBreastProjection(const std::string& sopClass)
{
  return sopClass == UID_BreastProjectionXRayImageStorageForProcessing ||
    sopClass == UID_BreastProjectionXRayImageStorageForPresentation;
}

Mammogram::Intent MammogramIntent(DcmItem& data)
{
  const std::string intent = DicomText(data, DCM_PresentationIntentType);
  const bool processing = intent.empty() ? IsForProcessingClass(DicomText(data, DCM_SOPClassUID))
                                         : intent == "FOR PROCESSING";
  return processing ? Mammogram::Intent::ForProcessing : Mammogram::Intent::ForPresentation;
}
}
