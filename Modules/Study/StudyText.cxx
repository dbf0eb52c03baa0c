// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/Intake.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace mammoray
{
namespace
{
using Json = nlohmann::ordered_json;

const char* FatColumn(FatSuppression fat)
{
  return fat == FatSuppression::Absent ? "no" : fat == FatSuppression::Present ? "yes" : "unknown";
}

const char* ContrastColumn(ContrastPhase phase)
{
  return phase == ContrastPhase::Before ? "before"
    : phase == ContrastPhase::After     ? "after"
                                        : "unknown";
}

const char* IntentColumn(Mammogram::Intent intent)
{
  return intent == Mammogram::Intent::ForProcessing ? "processing" : "presentation";
}

std::string Shortened(const std::string& text, std::size_t most)
{
  if (text.size() <= most)
  {
    return text;
  }
  std::size_t end = most - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) // within a letter
  {
    --end;
  }
  return text.substr(0, end) + "...";
}

std::string SpacingOf(const StudySeries& series)
{
  char text[64] = "-";
  if (series.Grid)
  {
    const Vector3& spacing = series.Grid->Spacing;
    std::snprintf(text, sizeof text, "%.2f x %.2f x %.2f", spacing[0], spacing[1], spacing[2]);
  }
  return text;
}

std::string OrDash(const std::string& text)
{
  return text.empty() ? "-" : text;
}

/// `number`: of the volume, from 1.
std::string LineOf(const StudySeries& series, std::size_t number)
{
  std::string name = series.Description.empty() ? "(no description)" : series.Description;
  name += series.Phases > 1
    ? " [" + std::to_string(series.Phase) + "/" + std::to_string(series.Phases) + "]"
    : "";
  char line[512];
  std::snprintf(line, sizeof line, "  %3zu %-34s %4zu  %-19s %-8s %-4s %-38s %-7s %-7s  ", number,
    Shortened(name, 34).c_str(), series.Slices.size(), SpacingOf(series).c_str(),
    OrDash(series.Plane).c_str(), OrDash(series.Header.PatientPosition).c_str(),
    Shortened(series.Sequence, 38).c_str(), FatColumn(series.Fat), ContrastColumn(series.Contrast));
  return line + series.Reason + '\n';
}

std::string LineOf(const StudyMammogram& image)
{
  const DicomHeader& header = image.Header;
  char thickness[24] = "-";
  if (header.BodyPartThicknessMm)
  {
    std::snprintf(thickness, sizeof thickness, "%.0f mm", *header.BodyPartThicknessMm);
  }
  char line[512];
  std::snprintf(line, sizeof line, "  %-2c %-5s %-13s %5d x %-5d %-7s %-8s ", header.Laterality,
    OrDash(Shortened(header.View, 5)).c_str(), IntentColumn(header.PresentationIntent),
    header.Columns, header.Rows, thickness, OrDash(header.AcquisitionDate).c_str());
  return line + image.Reason + '\n';
}

Json NumberOrNone(const std::optional<double>& number)
{
  return number ? Json(*number) : Json();
}

Json JsonOf(const StudySeries& series)
{
  Json json{ { "description", series.Description },
    { "series_uid", series.Header.SeriesInstanceUid }, { "date", series.Date },
    { "slices", series.Slices.size() }, { "plane", series.Plane },
    { "patient_position", series.Header.PatientPosition }, { "sequence", series.Sequence },
    { "fat_suppression", FatColumn(series.Fat) }, { "fat_suppression_from", series.FatEvidence },
    { "contrast", ContrastColumn(series.Contrast) }, { "contrast_from", series.ContrastEvidence },
    { "phase", series.Phase }, { "phases", series.Phases },
    { "side", std::string(1, series.Side) } };
  if (series.Grid)
  {
    json["size"] = series.Grid->Size;
    json["spacing_mm"] = series.Grid->Spacing;
    json["origin_mm"] = series.Grid->Origin;
  }
  json["reason"] = series.Reason;
  json["files"] = series.Files;
  if (!series.Slices.empty() && series.Slices.front().Frame > 0)
  {
    for (const DicomSlice& slice : series.Slices)
    {
      json["frames"].push_back(slice.Frame);
    }
  }
  return json;
}

Json JsonOf(const StudyMammogram& image)
{
  const DicomHeader& header = image.Header;
  return { { "file", header.Path }, { "view", header.View },
    { "laterality", std::string(1, header.Laterality) },
    { "intent", IntentColumn(header.PresentationIntent) }, { "synthetic", image.Synthetic },
    { "columns", header.Columns }, { "rows", header.Rows }, { "date", header.AcquisitionDate },
    { "thickness_mm", NumberOrNone(header.BodyPartThicknessMm) },
    { "angle_deg", NumberOrNone(header.PositionerPrimaryAngleDeg) }, { "reason", image.Reason } };
}
}

std::string StudyListing(const StudyChoice& choice)
{
  const Study& study = choice.Found;
  std::string text;
  char line[512];
  std::size_t slices = 0;
  for (const StudySeries& series : study.Series)
  {
    slices += series.Slices.size();
  }
  std::snprintf(line, sizeof line, "MRI: %zu volumes, %zu images\n", study.Series.size(), slices);
  text += line;
  if (!study.Series.empty())
  {
    std::snprintf(line, sizeof line, "  %3s %-34s %4s  %-19s %-8s %-4s %-38s %-7s %-7s\n", "",
      "description", "n", "spacing [mm]", "plane", "pos.", "sequence [ms]", "fat-sup", "contr.");
    text += line;
  }
  for (std::size_t index = 0; index < study.Series.size(); ++index)
  {
    text += LineOf(study.Series[index], index + 1);
  }
  text += "mammograms: " + std::to_string(study.Mammograms.size()) + '\n';
  for (const StudyMammogram& image : study.Mammograms)
  {
    text += LineOf(image);
  }
  std::snprintf(line, sizeof line,
    "beside them: %zu other DICOM objects, %zu copies, %zu directories, %zu damaged, %zu not "
    "DICOM\n",
    study.OtherObjects, study.Copies, study.Directories, study.Damaged.size(), study.NotDicom);
  return text + line;
}

std::string StudyJson(const StudyChoice& choice)
{
  const Study& study = choice.Found;
  Json json{ { "folder", study.Folder }, { "series", Json::array() },
    { "mammograms", Json::array() } };
  for (const StudySeries& series : study.Series)
  {
    json["series"].push_back(JsonOf(series));
  }
  for (const StudyMammogram& image : study.Mammograms)
  {
    json["mammograms"].push_back(JsonOf(image));
  }
  json["other_objects"] = study.OtherObjects;
  json["copies"] = study.Copies;
  json["directories"] = study.Directories;
  json["not_dicom"] = study.NotDicom;
  json["damaged"] = study.Damaged;
  const auto series = [](const std::optional<StudySeries>& taken)
  { return taken ? Json(taken->Header.SeriesInstanceUid) : Json(); };
  const auto file = [](const std::optional<StudyMammogram>& taken)
  { return taken ? Json(taken->Header.Path) : Json(); };
  json["taken"] = { { "plain", series(choice.Plain) },
    { "fat_suppressed", series(choice.FatSuppressed) },
    { "undetermined", series(choice.Undetermined) },
    { "position",
      !choice.Position                               ? Json()
        : *choice.Position == PatientPosition::Prone ? Json("prone")
                                                     : Json("supine") },
    { "side", std::string(1, choice.Laterality) }, { "cc", file(choice.Cc) },
    { "mlo", file(choice.Mlo) } };
  json["warnings"] = choice.Warnings;
  json["refusal"] = choice.Refusal;
  // Headers are in any character set: what is no UTF-8 is replaced.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}
}
