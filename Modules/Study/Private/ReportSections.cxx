// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportParts.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/PoseParameters.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
/// A unit as people write it.
std::string UnitText(const std::string& unit)
{
  return unit == "deg" ? "°" : unit;
}

/// What a parameter of the search is called in a sentence.
std::string ParameterTitle(const std::string& name)
{
  for (const PoseParameter& parameter : PoseParameters)
  {
    if (name == parameter.Name)
    {
      return parameter.Title;
    }
  }
  return name;
}

using Lines = std::vector<std::pair<std::string, std::string>>;

/// Tells from which iteration on which pixels were compared how: costs of different ones cannot be.
std::string ResolutionNote(const ViewResult& result)
{
  std::string note;
  const RegistrationIteration* previous = nullptr;
  for (const RegistrationIteration& iteration : result.Iterations)
  {
    if (!previous || iteration.PixelSizeMm != previous->PixelSizeMm ||
      iteration.Comparison != previous->Comparison)
    {
      note += (note.empty() ? "Compared in pixels of " : "; ") +
        NumberText(iteration.PixelSizeMm, 1) + " mm (" + iteration.Comparison +
        ") from iteration " + std::to_string(iteration.Number);
    }
    previous = &iteration;
  }
  return note.empty() ? note : note + ". Costs of different ones are different quantities.";
}

std::string Rows(const Lines& lines)
{
  std::string html = "<table>\n";
  for (const auto& [name, value] : lines)
  {
    html +=
      "<tr><td>" + Escape(name) + "</td><td class=\"value\">" + Escape(value) + "</td></tr>\n";
  }
  return html + "</table>\n";
}

std::string Sentences(const std::vector<std::string>& sentences)
{
  std::string html = "<ul>\n";
  for (const std::string& sentence : sentences)
  {
    html += "<li>" + Escape(sentence) + "</li>\n";
  }
  return html + "</ul>\n";
}

std::string ExpectedHtml(const std::optional<ExpectedError>& expected)
{
  return expected ? "<p>If both are of one breast, half of its tissue lies within " +
      NumberText(expected->MedianMm, 1) + " mm of where this result places it, 95 % within " +
      NumberText(expected->Most95Mm, 1) + " mm, as in virtual studies with known truth.</p>\n"
                  : std::string();
}

std::string VerdictHtml(const ViewResult& result)
{
  const Assessment& assessment = result.Trust;
  static const char* const Texts[] = {
    "Outline and picture of the synthetic mammogram agree with the target.",
    "Places found by this registration may be off by more than usual:",
    "Do not use this result to find places in one picture from the other:"
  };
  const int level = static_cast<int>(assessment.Level);
  return std::string("<section class=\"verdict ") + NameOf(assessment.Level) + "\">\n<h2>" +
    VerdictOf(assessment.Level) + "</h2>\n" + Texts[level] + "\n" +
    (assessment.Reasons.empty() ? std::string() : Sentences(assessment.Reasons)) +
    ExpectedHtml(result.Expected) + "</section>\n";
}

/// What the header says of a parameter; nothing where it is silent.
std::optional<double> HeaderValue(const Mammogram& mammogram, const std::string& parameter)
{
  return parameter == PoseParameters[ThicknessParameter].Name ? mammogram.BodyPartThicknessMm
    : parameter == PoseParameters[RollParameter].Name         ? NominalRollDeg(mammogram)
                                                              : std::nullopt;
}

std::string FiguresHtml(const RegistrationReport& report)
{
  const ViewResult& result = report.Registered->Registration;
  const auto figure = [](const std::string& value, const std::string& unit, const std::string& name)
  {
    return "<div class=\"figure\"><b>" + value + " <small>" + unit + "</small></b><span>" + name +
      "</span></div>\n";
  };
  const auto header = [&](int parameter, int digits)
  {
    const PoseParameter& known = PoseParameters[parameter];
    const auto value = HeaderValue(report.Registered->Mammogram, known.Name);
    return value ? "; the header says " + NumberText(*value, digits) +
        (std::string(known.Unit) == "deg" ? "" : " ") + UnitText(known.Unit)
                 : std::string("; the header does not say it");
  };
  return "<div class=\"figures\">\n" +
    figure(NumberText(result.After.TissueCorrelation, 2), "",
      "correlation of the tissue (of one breast " + NumberText(GoodTissueCorrelation, 2) +
        " or more), " + NumberText(result.After.Correlation, 3) + " of all of the picture") +
    figure(NumberText(result.After.MeanOutlineDistanceMm, 2), "mm",
      "mean distance of the outlines, " + NumberText(result.After.LargestOutlineDistanceMm, 2) +
        " mm the largest") +
    figure(NumberText(result.Pose.ThicknessMm, 1), "mm",
      "compressed thickness" + header(ThicknessParameter, 1)) +
    figure(NumberText(result.Pose.RollDeg, 1), "°",
      "angle of the unit" + header(RollParameter, 0)) +
    "</div>\n";
}

std::string PicturesHtml(const ReportPictures& pictures)
{
  const auto key = [](const char* name)
  { return std::string("<span class=\"key ") + name + "\"></span>"; };
  return std::string("<section>\n<h2>Pictures</h2>\n<div class=\"pictures") +
    (pictures.Wide ? " wide" : "") + "\">\n" +
    FigureHtml(pictures.Real, "Target mammogram", "Target mammogram",
      "Log attenuation; the breast's outline " + key("real") + "as found in it. " +
        key("excluded") + "Left out of the comparison.") +
    FigureHtml(pictures.Synthetic, "Synthetic mammogram", "Synthetic mammogram",
      "The MRI's breast, compressed; its outline " + key("synthetic") +
        "in the same grey window.") +
    FigureHtml(pictures.Overlay, "Overlay", "Overlay",
      key("real") + "target and " + key("synthetic") + "synthetic; grey where they agree.") +
    FigureHtml(pictures.Difference, "Difference", "Difference",
      "Synthetic minus target in standard deviations, grey where left out: " + key("more") +
        "synthetic absorbs more, " + key("less") + "less. Full " + key("real") + "or " +
        key("synthetic") + ": breast in the target or the synthetic mammogram only.") +
    "</div>\n<p class=\"hint\">Letters are patient directions: A anterior, P posterior, L left, R "
    "right, H head, F feet.</p>\n</section>\n";
}

std::string BetweenPlatesHtml(const LayeredPicture& picture)
{
  return picture.Png.empty() ? std::string()
                             : "<section class=\"scene\">\n<h2>Between the plates</h2>\n" +
      FigureHtml(picture, "The breast between the plates", "As the mechanics squeeze it",
        "What was found of thickness, angle and place; the skin and the plates are looked "
        "through.") +
      "</section>\n";
}

/// Both pictures in one place; the page's script takes them from the figures before it, so that
/// each is in the file once, and shows the section.
constexpr const char* Comparison = R"html(<section class="compare" hidden>
<h2>Compare</h2>
<form class="controls">
<label><input type="radio" name="mode" value="blend" checked> blend, target
<input type="range" min="0" max="100" value="50" aria-label="share of the synthetic mammogram"> synthetic</label>
<label><input type="radio" name="mode" value="checkerboard"> checkerboard</label>
<label><input type="radio" name="mode" value="flicker"> flicker</label>
</form>
<div class="stage"><img alt="Target mammogram"><img alt="Synthetic mammogram"></div>
</section>
)html";

/// NaN where it is not known, or the parameter is taken for exact.
double ConsideredDeviation(const ViewResult& result, std::size_t parameter)
{
  const std::size_t count = result.Parameters.size();
  const double variance =
    result.ConsideredCovariance.empty() ? 0 : result.ConsideredCovariance[parameter * (count + 1)];
  return variance > 0 ? std::sqrt(variance) : std::numeric_limits<double>::quiet_NaN();
}

std::string ParametersHtml(const RegistrationReport& report)
{
  const ViewResult& result = report.Registered->Registration;
  std::string html = "<section>\n<h2>What was found</h2>\n<table>\n<tr><th>Parameter</th>"
                     "<th class=\"number\">Found</th><th class=\"number\">± (1 SD)</th>"
                     "<th class=\"number\">By the header</th>"
                     "<th class=\"number wide\">± including fixed parameters</th>"
                     "<th class=\"number wide\">Start</th><th class=\"number wide\">Allowed</th>"
                     "<th>Unit</th><th></th></tr>\n";
  for (std::size_t i = 0; i < result.Parameters.size(); ++i)
  {
    const RegistrationParameter& parameter = result.Parameters[i];
    const auto cell = [](const std::string& text, const char* kind = "number")
    { return std::string("<td class=\"") + kind + "\">" + text + "</td>"; };
    const auto header = HeaderValue(report.Registered->Mammogram, parameter.Name);
    html += "<tr><td>" + Escape(ParameterTitle(parameter.Name)) + "</td>" +
      cell("<b>" + NumberText(result.Values[i], 2) + "</b>") +
      cell(NumberText(result.StandardDeviations[i], 2)) +
      cell(header ? NumberText(*header, 1) : "") +
      cell(NumberText(ConsideredDeviation(result, i), 2), "number wide") +
      cell(NumberText(parameter.Start, 2), "number wide") +
      cell(parameter.Fixed
          ? "–"
          : NumberText(parameter.Lower, 1) + " … " + NumberText(parameter.Upper, 1),
        "number wide") +
      "<td>" + Escape(UnitText(parameter.Unit)) + "</td><td>" +
      (parameter.Fixed                           ? "<span class=\"flag\">fixed</span>"
          : AtBound(parameter, result.Values[i]) ? "<span class=\"flag\">at its bound</span>"
                                                 : "") +
      "</td></tr>\n";
  }
  return html +
    "</table>\n<p class=\"hint\">± is the standard "
    "deviation by the covariance at the solution: it tells how sharply the pictures determine a "
    "parameter, not how well the model holds. The second one also counts what is not known of the "
    "parameters that were fixed: their allowance, and how far the others would have followed. "
    "A positive rotation turns the X-ray source from "
    "above "
    "towards the patient's left.</p>\n</section>\n";
}

Lines MammogramLines(const Mammogram& mammogram, double shareExcluded)
{
  const auto optional = [](const std::optional<double>& value, int digits, const char* unit)
  { return value ? NumberText(*value, digits) + " " + unit : std::string("not stated"); };
  const auto text = [](const std::string& value)
  { return value.empty() ? std::string("not stated") : value; };
  return { { "View", text(mammogram.View) },
    { "Kind",
      mammogram.PresentationIntent == Mammogram::Intent::ForProcessing ? "For Processing"
                                                                       : "For Presentation" },
    { "Pixels", std::to_string(mammogram.Columns) + " × " + std::to_string(mammogram.Rows) },
    { "Pixel spacing at the receptor",
      NumberText(mammogram.ColumnSpacingMm, 3) + " × " + NumberText(mammogram.RowSpacingMm, 3) +
        " mm" },
    { "Source to detector", optional(mammogram.SourceToDetectorMm, 0, "mm") },
    { "Tube voltage", optional(mammogram.PeakKilovoltage, 1, "kVp") },
    { "Anode / filter", text(mammogram.AnodeMaterial) + " / " + text(mammogram.FilterMaterial) },
    { "Left out of the comparison",
      NumberText(100 * shareExcluded, 1) + " % of the breast's picture" } };
}

Lines SearchLines(const ViewResult& result)
{
  const CompressionState& state = result.State;
  return { { result.Converged ? "Converged because" : "Stopped because", result.StopReason },
    { "Iterations", std::to_string(result.Iterations.size()) },
    { "Compressions computed", std::to_string(result.Evaluations) },
    { "Time", NumberText(result.Seconds, 1) + " s" },
    { "Force on the paddle", NumberText(state.PaddleForceN, 1) + " N" },
    { "Volume kept", NumberText(100 * state.VolumeRatio, 2) + " %" },
    { "Smallest and largest local volume change",
      NumberText(state.SmallestJ, 3) + " … " + NumberText(state.LargestJ, 3) },
    { "Deepest penetration of a plate", NumberText(state.LargestPenetrationMm, 3) + " mm" } };
}

std::string CourseHtml(const ViewResult& result, const std::string& plot)
{
  return "<section class=\"screen\">\n<h2>Course of the search</h2>\n" + plot +
    "<p class=\"hint\">" + ResolutionNote(result) + "</p></section>\n";
}

std::string SourcesHtml(const RegistrationReport& report)
{
  std::string html = "<section class=\"sources\">\n<h2>Where it comes from</h2>\n<table>\n";
  for (const ResultInput& input : report.File->Inputs)
  {
    html += "<tr><td>" + Escape(input.Role) + "</td><td>" + Escape(input.File) +
      "<br><code>SHA-256 " + input.Sha256 + "</code></td></tr>\n";
  }
  Lines versions = report.File->Versions;
  versions.emplace_back("Spectrum", report.File->Spectrum);
  for (const auto& [name, version] : versions)
  {
    html += "<tr><td>" + Escape(name) + "</td><td>" + Escape(version) + "</td></tr>\n";
  }
  return html + "</table>\n</section>\n";
}
}

std::string MammogramHtml(const RegistrationReport& report, const ReportPictures& pictures,
  const std::string& plot)
{
  const ViewResult& result = report.Registered->Registration;
  std::string html = VerdictHtml(result) + FiguresHtml(report) + PicturesHtml(pictures) +
    Comparison + "<div class=\"found\">\n" + BetweenPlatesHtml(report.BetweenPlates) +
    ParametersHtml(report) + "</div>\n" + CourseHtml(result, plot);
  html += "<div class=\"columns screen\">\n<section>\n<h2>Search and compression</h2>\n" +
    Rows(SearchLines(result)) + "</section>\n<section>\n<h2>Mammogram</h2>\n" +
    Rows(MammogramLines(report.Registered->Mammogram, report.File->ShareExcluded)) +
    "</section>\n</div>\n";
  if (!report.Registered->Warnings.empty())
  {
    html += "<section class=\"notes\">\n<h2>What had to be assumed</h2>\n" +
      Sentences(report.Registered->Warnings) + "</section>\n";
  }
  if (!report.File->Notes.empty())
  {
    html += "<section class=\"notes\">\n<h2>What was noted of the files</h2>\n" +
      Sentences(report.File->Notes) + "</section>\n";
  }
  return html + SectionsHtml(report.Sections) + SourcesHtml(report);
}

std::string SectionsHtml(const std::vector<ReportSection>& sections)
{
  std::string html;
  for (const ReportSection& section : sections)
  {
    html += "<section class=\"further\">\n<h2>" + Escape(section.Title) + "</h2>\n";
    html += section.Rows.empty() ? std::string() : Rows(section.Rows);
    if (!section.Picture.Png.empty())
    {
      html += FigureHtml(section.Picture, section.Title, "", Escape(section.Caption));
    }
    html += section.Notes.empty() ? std::string() : Sentences(section.Notes);
    html += "</section>\n";
  }
  return html;
}

std::string SharedHtml(const JointResultFile& joint)
{
  std::string rows;
  for (const JointResultFile::Unknown& unknown : joint.Unknowns)
  {
    if (!unknown.Folder)
    {
      rows += "<tr><td>" + Escape(ParameterTitle(unknown.Name)) + "</td><td class=\"value\"><b>" +
        NumberText(unknown.Value, 2) + "</b> ± " + NumberText(unknown.StandardDeviation, 2) +
        "</td></tr>\n";
    }
  }
  return "<section>\n<h2>What the mammograms share</h2>\n" +
    (rows.empty()
        ? std::string("No parameter that was free: each mammogram was registered by itself.\n")
        : "<table>\n" + rows + "</table>\n") +
    "</section>\n";
}
}
