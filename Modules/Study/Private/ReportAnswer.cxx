// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportAnswer.h"

#include "Private/ReportText.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
/// The foremost point of the breast's outline, gantry x and y; nothing without an outline.
std::optional<std::array<double, 2>> ForemostOf(const RegistrationReport& report)
{
  std::optional<std::array<double, 2>> foremost;
  for (const auto& point : report.Result->Synthetic.Outline)
  {
    if (!foremost || point[1] > (*foremost)[1])
    {
      foremost = point;
    }
  }
  return foremost;
}

/// "31 mm behind the breast's foremost point and 12 mm to L of it".
std::string FromForemost(const PlaceInMammogram& place, const AnsweredMammogram& mammogram)
{
  const auto foremost = ForemostOf(*mammogram.Report);
  if (!foremost)
  {
    return "";
  }
  const double behind = (*foremost)[1] - place.ReceptorMm[1];
  const double up = mammogram.Pictures->Up * (place.ReceptorMm[0] - (*foremost)[0]);
  const std::string& letters = mammogram.Pictures->Letters[up > 0 ? 2 : 3];
  return NumberText(behind, 0) + " mm behind the breast’s foremost point, " +
    NumberText(std::abs(up), 0) + " mm to " + letters + " of it";
}

std::string WithinText(const PlaceInMammogram& place)
{
  return place.HalfAxesMm ? "within " + NumberText((*place.HalfAxesMm)[0], 1) + " × " +
      NumberText((*place.HalfAxesMm)[1], 1) + " mm"
                          : "within what is not known";
}

std::string PlaceHtml(const PlaceInMammogram& place, const AnsweredMammogram& mammogram)
{
  std::string html = "<p><b>" + Escape(mammogram.Title) + ":</b> ";
  if (!place.Problem.empty())
  {
    return html + "not found: " + Escape(place.Problem) + "</p>\n";
  }
  const std::string from = FromForemost(place, mammogram);
  html += from + (from.empty() ? "" : "; ") + "pixel column " + NumberText(place.Column, 0) +
    ", row " + NumberText(place.Row, 0) + (place.InImage ? "" : ", which lies beside the picture") +
    "; <b>" + WithinText(place) + "</b>";
  const Assessment& trust = mammogram.Report->Result->Trust;
  if (trust.Level != Trust::Good)
  {
    html += ". <b class=\"warning\">" + Escape(VerdictOf(trust.Level)) + ".</b>";
  }
  return html + "</p>\n";
}

Trust WorstOf(const std::vector<AnsweredMammogram>& mammograms)
{
  Trust worst = Trust::Good;
  for (const AnsweredMammogram& mammogram : mammograms)
  {
    worst = std::max(worst, mammogram.Report->Result->Trust.Level);
  }
  return worst;
}

std::string AskedHtml(const std::vector<AskedPlace>& asked, std::size_t index,
  const std::vector<AnsweredMammogram>& mammograms)
{
  const AskedPlace& place = asked[index];
  std::string material;
  std::string html;
  for (const AnsweredMammogram& mammogram : mammograms)
  {
    const PlaceInMammogram& found = mammogram.Report->Places[index];
    material = found.Material.empty() ? material : found.Material;
    html += PlaceHtml(found, mammogram);
  }
  const std::string what =
    (place.VolumeMm3 > 0 ? NumberText(place.VolumeMm3, 0) + " mm³ around " : std::string()) + "(" +
    NumberText(place.Point[0], 1) + ", " + NumberText(place.Point[1], 1) + ", " +
    NumberText(place.Point[2], 1) + ") mm" + (material.empty() ? "" : ", in " + material);
  return "<h2>" + Escape(place.Name) + " <small>" + Escape(what) + "</small></h2>\n" + html;
}
}

std::string AnswerHtml(const std::vector<AskedPlace>& asked,
  const std::vector<AnsweredMammogram>& mammograms)
{
  if (asked.empty())
  {
    return "";
  }
  std::string html =
    std::string("<section class=\"answer verdict ") + NameOf(WorstOf(mammograms)) + "\">\n";
  for (std::size_t index = 0; index < asked.size(); ++index)
  {
    html += AskedHtml(asked, index, mammograms);
  }
  html +=
    "<p class=\"hint\">The ellipse holds the place with 95 %, by what the pictures leave open "
    "of pose and compression; what the model itself is off by is not in it.</p>\n"
    "<div class=\"answer-pictures\">\n<div class=\"answer-mammograms\">\n";
  for (const AnsweredMammogram& mammogram : mammograms)
  {
    html += FigureHtml(mammogram.Pictures->Answer, "Answer, " + mammogram.Title,
      Escape(mammogram.Title), "The real mammogram with what was asked for.");
  }
  html += "</div>\n<div class=\"answer-slices\">\n";
  for (const AskedPlace& place : asked)
  {
    if (!place.Slices.Png.empty())
    {
      html += FigureHtml(place.Slices, place.Name + " in the volume",
        Escape(place.Name) + " in the volume", "Slices through it, patient directions as letters.");
    }
  }
  html += "</div>\n</div>\n";
  return html + "</section>\n";
}
}
