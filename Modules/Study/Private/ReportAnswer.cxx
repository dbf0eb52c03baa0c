// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportParts.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
/// "31 mm behind the breast's foremost point and 12 mm to L of it; "; empty without an outline.
std::string FromForemost(const ReceptorPoint& place, const AnsweredMammogram& mammogram)
{
  const auto& outline = mammogram.Report->Registered->Registration.Synthetic.Outline;
  const auto foremost = std::max_element(outline.begin(), outline.end(),
    [](const ReceptorPoint& a, const ReceptorPoint& b) { return a[1] < b[1]; });
  if (foremost == outline.end())
  {
    return "";
  }
  const double up = mammogram.Pictures->Up * (place[0] - (*foremost)[0]);
  return NumberText((*foremost)[1] - place[1], 0) + " mm behind the breast’s foremost point, " +
    NumberText(std::abs(up), 0) + " mm to " + mammogram.Pictures->Letters[up > 0 ? 2 : 3] +
    " of it; ";
}

std::string PlaceHtml(const PlaceInMammogram& place, const AnsweredMammogram& mammogram)
{
  std::string html = "<p><b>" + Escape(mammogram.Title) + ":</b> ";
  if (!place.Problem.empty())
  {
    return html + "not found: " + Escape(place.Problem) + "</p>\n";
  }
  const ImagedPoint& imaged = place.Imaged;
  const auto axis = [](double sigmaMm) { return NumberText(Deviations95 * sigmaMm, 1); };
  html += FromForemost(imaged.ReceptorMm, mammogram) + "pixel column " +
    NumberText(imaged.Column, 0) + ", row " + NumberText(imaged.Row, 0) +
    (imaged.InImage                ? std::string()
        : imaged.ReceptorMm[1] < 0 ? ", " + NumberText(-imaged.ReceptorMm[1], 0) +
          " mm behind the receptor’s edge, where no mammogram shows it"
                                   : std::string(", which lies beside the picture")) +
    "; <b>" +
    (imaged.Uncertainty ? "within " + axis(imaged.Uncertainty->MajorMm) + " × " +
          axis(imaged.Uncertainty->MinorMm) + " mm"
                        : "within what is not known") +
    "</b>";
  const Assessment& trust = mammogram.Report->Registered->Registration.Trust;
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
    worst = std::max(worst, mammogram.Report->Registered->Registration.Trust.Level);
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
    material = found.Imaged.Material.empty() ? material : found.Imaged.Material;
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
  html += "<p class=\"hint\">The ellipse holds the place with a probability of 95 %, by what the "
          "pictures "
          "leave open of pose and compression and by the model’s own error.</p>\n"
          "<div class=\"answer-pictures\">\n<div class=\"answer-mammograms\">\n";
  for (const AnsweredMammogram& mammogram : mammograms)
  {
    html += FigureHtml(mammogram.Pictures->Answer, "Answer, " + mammogram.Title,
      Escape(mammogram.Title), "The target mammogram with what was asked for.");
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
