// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Report/RegistrationReport.h"

#include "Private/PlotPicture.h"
#include "Private/ReportPictures.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/IO/Sha256.h"

#include "vtkBase64Utilities.h"
#include "vtkVersion.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <sstream>

namespace mammoray
{
namespace
{
using Lines = std::vector<std::pair<std::string, std::string>>;

/// A number for people: `digits` after the point, a dash for none.
std::string Format(double value, int digits)
{
  if (!std::isfinite(value))
  {
    return "–";
  }
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.setf(std::ios::fixed);
  stream.precision(digits);
  stream << value;
  const std::string text = stream.str();
  // No negative zero; a true minus sign otherwise.
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return text[0] != '-' ? text : (zero ? "" : "−") + text.substr(1);
}

std::string Escape(const std::string& text)
{
  std::string escaped;
  for (const char c : text)
  {
    escaped += c == '&' ? "&amp;"
      : c == '<'        ? "&lt;"
      : c == '>'        ? "&gt;"
      : c == '"'        ? "&quot;"
                        : std::string(1, c);
  }
  return escaped;
}

std::string Base64(const std::string& bytes)
{
  std::vector<unsigned char> encoded(bytes.size() / 3 * 4 + 8);
  const unsigned long length =
    vtkBase64Utilities::Encode(reinterpret_cast<const unsigned char*>(bytes.data()),
      static_cast<unsigned long>(bytes.size()), encoded.data());
  return { encoded.begin(), encoded.begin() + static_cast<std::ptrdiff_t>(length) };
}

/// From which iteration on which pixels were compared: costs at different sizes cannot be compared.
std::string ResolutionNote(const RegistrationResult& result)
{
  std::string note;
  double previous = 0;
  for (const RegistrationIteration& iteration : result.Iterations)
  {
    if (iteration.PixelSizeMm != previous)
    {
      note += (note.empty() ? "Compared in pixels of " : "; ") + Format(iteration.PixelSizeMm, 1) +
        " mm from iteration " + std::to_string(iteration.Number);
      previous = iteration.PixelSizeMm;
    }
  }
  return note.empty() ? note : note + ". Costs of different pixels are different quantities.";
}

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

std::string UnitText(const std::string& unit)
{
  return unit == "deg" ? "°" : unit;
}

/// At a bound up to a thousandth of the way between them.
bool AtBound(const RegistrationParameter& parameter, double value)
{
  const double tolerance = 1e-3 * (parameter.Upper - parameter.Lower);
  return !parameter.Fixed && parameter.Upper > parameter.Lower &&
    (value - parameter.Lower < tolerance || parameter.Upper - value < tolerance);
}

void Validate(const RegistrationReport& report)
{
  if (!report.RealMammogram || !report.Target || !report.Result)
  {
    throw InputError("report: expected a mammogram, a target and a result, found one missing");
  }
  const RegistrationTarget& target = *report.Target;
  const std::size_t count =
    static_cast<std::size_t>(target.Columns) * static_cast<std::size_t>(target.Rows);
  if (count == 0 || target.LogAttenuation.size() != count || target.BreastMask.size() != count ||
    target.SignedDistanceMm.size() != count || report.Synthetic.size() != count)
  {
    throw InputError("report: expected " + std::to_string(target.Columns) + " x " +
      std::to_string(target.Rows) + " pixels in target and synthetic image, found " +
      std::to_string(report.Synthetic.size()) + " synthetic ones");
  }
  const RegistrationResult& result = *report.Result;
  if (result.Values.size() != result.Parameters.size() ||
    result.StandardDeviations.size() != result.Parameters.size())
  {
    throw InputError("report: expected a value and a deviation for each of " +
      std::to_string(result.Parameters.size()) + " parameters, found " +
      std::to_string(result.Values.size()) + " and " +
      std::to_string(result.StandardDeviations.size()));
  }
}

std::string ShortNumber(double value)
{
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.precision(6);
  stream << value;
  return stream.str();
}

/// Costs over iterations; the ordinate is logarithmic where the costs span more than a factor
/// of 20.
std::string ConvergencePlot(const std::vector<RegistrationIteration>& iterations)
{
  constexpr double Width = 960;
  constexpr double Height = 320;
  constexpr double Left = 74;
  constexpr double Right = 150;
  constexpr double Top = 18;
  constexpr double Bottom = 52;
  struct Curve
  {
    const char* Name;
    const char* Color;
    double RegistrationIteration::*Value;
  };
  const Curve curves[] = { { "Total", "#1f2937", &RegistrationIteration::Cost },
    { "Outline", "#d97706", &RegistrationIteration::OutlineCost },
    { "Intensity", "#0284c7", &RegistrationIteration::IntensityCost } };

  std::ostringstream svg;
  svg.imbue(std::locale::classic());
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << Width << ' ' << Height
      << "\" width=\"" << Width << "\" height=\"" << Height
      << "\" font-family=\"system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif\" "
         "font-size=\"12\" role=\"img\" aria-label=\"Cost by iteration\">\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
  double largest = 0;
  double smallest = std::numeric_limits<double>::infinity();
  int last = 1;
  for (const RegistrationIteration& iteration : iterations)
  {
    last = std::max(last, iteration.Number);
    for (const Curve& curve : curves)
    {
      const double value = iteration.*curve.Value;
      largest = std::isfinite(value) ? std::max(largest, value) : largest;
      smallest = value > 0 ? std::min(smallest, value) : smallest;
    }
  }
  if (!(largest > 0))
  {
    svg << "<text x=\"" << Width / 2 << "\" y=\"" << Height / 2
        << "\" text-anchor=\"middle\" fill=\"#6b7280\">No iterations to show</text>\n</svg>\n";
    return svg.str();
  }
  const bool logarithmic = largest / smallest > 20;
  const double low = logarithmic ? std::floor(std::log10(smallest)) : 0;
  const double step = TickStep(largest, 5);
  const double high =
    logarithmic ? std::ceil(std::log10(largest) + 1e-9) : step * std::ceil(largest / step);
  const auto atX = [last](double number) { return Left + (Width - Left - Right) * number / last; };
  const auto atY = [=](double value)
  {
    const double scaled = logarithmic ? std::log10(std::max(value, std::pow(10.0, low))) : value;
    return Height - Bottom - (Height - Top - Bottom) * (scaled - low) / (high - low);
  };
  svg << "<g stroke=\"#e5e7eb\">\n";
  std::ostringstream labels;
  labels.imbue(std::locale::classic());
  for (double tick = low; tick <= high + 1e-9 * high; tick += logarithmic ? 1 : step)
  {
    const double value = logarithmic ? std::pow(10.0, tick) : tick;
    const double y = atY(value);
    svg << "<line x1=\"" << Left << "\" x2=\"" << Width - Right << "\" y1=\"" << y << "\" y2=\""
        << y << "\"/>\n";
    labels << "<text x=\"" << Left - 8 << "\" y=\"" << y + 4 << "\" text-anchor=\"end\">"
           << ShortNumber(value) << "</text>\n";
  }
  svg << "</g>\n<g fill=\"#4b5563\">\n" << labels.str();
  const int every = std::max(1, static_cast<int>(TickStep(last, 10)));
  for (int number = 0; number <= last; number += every)
  {
    svg << "<text x=\"" << atX(number) << "\" y=\"" << Height - Bottom + 18
        << "\" text-anchor=\"middle\">" << number << "</text>\n";
  }
  svg << "<text x=\"" << 0.5 * (Left + Width - Right) << "\" y=\"" << Height - 12
      << "\" text-anchor=\"middle\">Iteration</text>\n"
      << "<text transform=\"translate(18 " << 0.5 * (Top + Height - Bottom)
      << ") rotate(-90)\" text-anchor=\"middle\">Cost (half the sum of squared residuals)</text>\n"
      << "</g>\n<line x1=\"" << Left << "\" x2=\"" << Width - Right << "\" y1=\"" << Height - Bottom
      << "\" y2=\"" << Height - Bottom << "\" stroke=\"#6b7280\"/>\n";
  double legend = Top + 10;
  for (const Curve& curve : curves)
  {
    svg << "<g stroke=\"" << curve.Color << "\" fill=\"" << curve.Color
        << "\">\n<polyline fill=\"none\" "
           "stroke-width=\"2\" points=\"";
    std::ostringstream dots;
    dots.imbue(std::locale::classic());
    for (const RegistrationIteration& iteration : iterations)
    {
      const double value = iteration.*curve.Value;
      if (std::isfinite(value))
      {
        svg << atX(iteration.Number) << ',' << atY(value) << ' ';
        dots << "<circle cx=\"" << atX(iteration.Number) << "\" cy=\"" << atY(value)
             << "\" r=\"3\"/>\n";
      }
    }
    const double x = Width - Right + 20;
    svg << "\"/>\n"
        << dots.str() << "<line x1=\"" << x << "\" x2=\"" << x + 22 << "\" y1=\"" << legend
        << "\" y2=\"" << legend << "\" stroke-width=\"2\"/>\n"
        << "<text x=\"" << x + 30 << "\" y=\"" << legend + 4 << "\" stroke=\"none\">" << curve.Name
        << "</text>\n</g>\n";
    legend += 22;
  }
  svg << "</svg>\n";
  return svg.str();
}

const char* NameOf(Trust trust)
{
  return trust == Trust::Good ? "good" : trust == Trust::Doubtful ? "doubtful" : "none";
}

Lines VersionsOf(const RegistrationReport& report)
{
  Lines versions{ { "MammoRay", MAMMORAY_VERSION }, { "VTK", vtkVersion::GetVTKVersion() } };
  versions.insert(versions.end(), report.Versions.begin(), report.Versions.end());
  return versions;
}

struct InputFile
{
  std::string Role;
  std::string Name;
  std::string Checksum;
};

std::vector<InputFile> HashInputs(const RegistrationReport& report)
{
  std::vector<InputFile> files;
  for (const auto& [role, path] : report.Inputs)
  {
    // A folder may be named with a slash at its end.
    const std::filesystem::path file(path);
    const std::string name = (file.has_filename() ? file : file.parent_path()).filename().string();
    files.push_back({ role, name, Sha256OfFile(path) });
  }
  return files;
}

/// Of the breast's picture, what is not compared, [0, 1].
double ShareExcluded(const RegistrationTarget& target)
{
  std::size_t breast = 0;
  std::size_t excluded = 0;
  for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
  {
    breast += target.BreastMask[pixel] != 0 ? 1 : 0;
    excluded += target.BreastMask[pixel] != 0 && IsExcluded(target, pixel) ? 1 : 0;
  }
  return static_cast<double>(excluded) / static_cast<double>(std::max<std::size_t>(breast, 1));
}

/// Numbers that are not finite become null.
std::string ResultJson(const RegistrationReport& report, const Assessment& assessment,
  const std::vector<InputFile>& inputs)
{
  using Json = nlohmann::ordered_json;
  const RegistrationResult& result = *report.Result;
  const Mammogram& mammogram = *report.RealMammogram;
  const auto optional = [](const std::optional<double>& value)
  { return value ? Json(*value) : Json(nullptr); };
  Json json;
  json["format"] = ResultFormat;
  json["formatVersion"] = 1;
  json["trust"] = { { "level", NameOf(assessment.Level) }, { "reasons", assessment.Reasons } };
  json["pose"] = { { "thicknessMm", result.Pose.ThicknessMm }, { "rollDeg", result.Pose.RollDeg },
    { "pitchDeg", result.Pose.PitchDeg }, { "yawDeg", result.Pose.YawDeg },
    { "tiltDeg", result.Pose.TiltDeg }, { "lateralMm", result.Pose.LateralMm },
    { "anteriorMm", result.Pose.AnteriorMm }, { "verticalMm", result.Pose.VerticalMm } };
  json["parameters"] = Json::array();
  for (std::size_t i = 0; i < result.Parameters.size(); ++i)
  {
    const RegistrationParameter& parameter = result.Parameters[i];
    json["parameters"].push_back({ { "name", parameter.Name }, { "unit", parameter.Unit },
      { "value", result.Values[i] }, { "standardDeviation", result.StandardDeviations[i] },
      { "start", parameter.Start }, { "lower", parameter.Lower }, { "upper", parameter.Upper },
      { "fixed", parameter.Fixed }, { "atBound", AtBound(parameter, result.Values[i]) } });
  }
  json["covariance"] = result.Covariance.empty() ? Json(nullptr) : Json(result.Covariance);
  json["consideredCovariance"] =
    result.ConsideredCovariance.empty() ? Json(nullptr) : Json(result.ConsideredCovariance);
  const RegistrationTarget& target = *report.Target;
  json["grid"] = { { "columns", target.Columns }, { "rows", target.Rows },
    { "originMm", target.Origin }, { "columnStepMm", target.ColumnStep },
    { "rowStepMm", target.RowStep } };
  json["placement"] = { { "originMm", report.Placed.Origin }, { "x", report.Placed.X },
    { "y", report.Placed.Y }, { "z", report.Placed.Z } };
  json["unit"] = { { "sourceToDetectorMm", report.Unit.SourceToDetectorMm },
    { "supportHeightMm", report.Unit.SupportHeightMm },
    { "supportEdgeMm", report.Unit.SupportEdgeMm }, { "paddleEdgeMm", report.Unit.PaddleEdgeMm },
    { "edgeRadiusMm", report.Unit.EdgeRadiusMm } };
  json["correlation"] = result.After.Correlation;
  json["meanOutlineDistanceMm"] = result.After.MeanOutlineDistanceMm;
  json["largestOutlineDistanceMm"] = result.After.LargestOutlineDistanceMm;
  json["converged"] = result.Converged;
  json["stopReason"] = result.StopReason;
  json["evaluations"] = result.Evaluations;
  json["seconds"] = result.Seconds;
  json["timings"] = Json::array();
  for (const auto& [stage, seconds] : report.Timings)
  {
    json["timings"].push_back({ { "stage", stage }, { "seconds", seconds } });
  }
  json["iterations"] = Json::array();
  for (const RegistrationIteration& iteration : result.Iterations)
  {
    json["iterations"].push_back(
      { { "number", iteration.Number }, { "pixelSizeMm", iteration.PixelSizeMm },
        { "cost", iteration.Cost }, { "outlineCost", iteration.OutlineCost },
        { "intensityCost", iteration.IntensityCost }, { "priorCost", iteration.PriorCost },
        { "parameters", iteration.Parameters }, { "seconds", iteration.Seconds } });
  }
  json["compression"] = { { "paddleForceN", result.State.PaddleForceN },
    { "volumeRatio", result.State.VolumeRatio }, { "smallestJ", result.State.SmallestJ },
    { "largestJ", result.State.LargestJ },
    { "largestPenetrationMm", result.State.LargestPenetrationMm },
    { "relativeResidual", result.State.RelativeResidual } };
  json["mammogram"] = { { "view", mammogram.View },
    { "laterality", std::string(1, mammogram.Laterality) }, { "columns", mammogram.Columns },
    { "rows", mammogram.Rows }, { "columnSpacingMm", mammogram.ColumnSpacingMm },
    { "rowSpacingMm", mammogram.RowSpacingMm },
    { "bodyPartThicknessMm", optional(mammogram.BodyPartThicknessMm) },
    { "sourceToDetectorMm", optional(mammogram.SourceToDetectorMm) },
    { "peakKilovoltage", optional(mammogram.PeakKilovoltage) } };
  json["shareExcluded"] = ShareExcluded(target);
  json["warnings"] = report.Warnings;
  json["inputs"] = Json::array();
  for (const InputFile& input : inputs)
  {
    json["inputs"].push_back(
      { { "role", input.Role }, { "file", input.Name }, { "sha256", input.Checksum } });
  }
  for (const auto& [name, version] : VersionsOf(report))
  {
    json["versions"][name] = version;
  }
  // A file name or DICOM text need not be UTF-8: replace what is not.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

constexpr const char* Style = R"css(
:root { color-scheme: light; --ink: #1f2937; --quiet: #6b7280; --line: #e5e7eb; --paper: #fff; }
* { box-sizing: border-box; }
body { margin: 0; background: #f3f4f6; color: var(--ink);
  font: 15px/1.55 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 32px 24px 48px; }
header p { color: var(--quiet); margin: 4px 0 0; }
h1 { font-size: 26px; line-height: 1.25; margin: 0; letter-spacing: -.01em; }
h1.view { margin: 34px 0 0; }
h2 { font-size: 17px; margin: 0 0 12px; }
section { background: var(--paper); border: 1px solid var(--line); border-radius: 10px;
  padding: 20px 22px; margin-top: 18px; }
.verdict { border-left: 6px solid; }
.verdict h2 { margin-bottom: 6px; }
.verdict ul, .notes ul { margin: 6px 0 0; padding-left: 20px; }
.good { border-left-color: #059669; } .doubtful { border-left-color: #d97706; background: #fffbeb; }
.none { border-left-color: #dc2626; background: #fef2f2; }
.figures { display: grid; grid-template-columns: repeat(4, 1fr); gap: 12px; margin-top: 18px; }
.figure { background: var(--paper); border: 1px solid var(--line); border-radius: 10px; padding: 14px 16px; }
.figure b { display: block; font-size: 24px; font-weight: 600; line-height: 1.2;
  font-variant-numeric: tabular-nums; }
.figure b small { font-size: 14px; font-weight: 400; color: var(--quiet); }
.figure span { color: var(--quiet); font-size: 13px; }
.pictures { display: grid; grid-template-columns: repeat(4, 1fr); gap: 16px; }
.pictures.wide { grid-template-columns: repeat(2, 1fr); }
figure { margin: 0; }
figure img { display: block; width: 100%; height: auto; border-radius: 6px; border: 1px solid var(--line); }
figcaption { font-size: 13px; color: var(--quiet); margin-top: 6px; }
figcaption b { color: var(--ink); display: block; font-size: 14px; }
.key { display: inline-block; width: 12px; height: 12px; border-radius: 3px; vertical-align: -1px;
  margin: 0 3px 0 2px; border: 1px solid #0002; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: 7px 12px 7px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
tr:last-child td { border-bottom: 0; }
th { font-weight: 600; font-size: 13px; color: var(--quiet); }
td.value { text-align: right; padding-right: 0; }
td.number, th.number { text-align: right; white-space: nowrap; }
.columns { display: grid; grid-template-columns: 1fr 1fr; gap: 18px; }
.columns section { min-width: 0; }
.stage { position: relative; max-width: 560px; margin-top: 12px; --blend: 50%; }
.stage img { display: block; width: 100%; border-radius: 6px; }
.stage img + img { position: absolute; inset: 0; opacity: var(--blend); }
.stage.checkerboard img + img { opacity: 1; -webkit-mask: repeating-conic-gradient(#000 0 25%, #0000 0 50%)
  0 0 / 90px 90px; mask: repeating-conic-gradient(#000 0 25%, #0000 0 50%) 0 0 / 90px 90px; }
.stage.flicker img + img { opacity: 1; animation: flicker 1.2s step-end infinite; }
@keyframes flicker { 50% { opacity: 0; } }
.controls label { margin-right: 18px; }
.controls input[type=range] { width: 240px; vertical-align: middle; }
code { font: 12px ui-monospace, Menlo, Consolas, monospace; color: var(--quiet); overflow-wrap: anywhere; }
.flag { background: #fef3c7; border-radius: 4px; padding: 1px 6px; font-size: 12px; }
section > svg { width: 100%; height: auto; display: block; }
footer { color: var(--quiet); font-size: 13px; margin-top: 22px; }
@media (max-width: 820px) { .pictures, .figures { grid-template-columns: 1fr 1fr; }
  .columns { grid-template-columns: 1fr; } }
@media print { body { background: #fff; } section, .figure { break-inside: avoid; } main { padding: 0; } }
)css";

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

std::string VerdictHtml(const Assessment& assessment)
{
  static const char* const Titles[] = { "The two mammograms match",
    "The match should be checked by eye", "The match is not to be trusted" };
  static const char* const Texts[] = {
    "Outline and picture of the synthetic mammogram agree with the real one.",
    "Places found by this registration may be off by more than usual:",
    "Do not use this result to find places in one picture from the other:"
  };
  const int level = static_cast<int>(assessment.Level);
  return std::string("<section class=\"verdict ") + NameOf(assessment.Level) + "\">\n<h2>" +
    Titles[level] + "</h2>\n" + Texts[level] +
    (assessment.Reasons.empty() ? "\n" : "\n" + Sentences(assessment.Reasons)) + "</section>\n";
}

std::string FiguresHtml(const RegistrationResult& result)
{
  const auto figure = [](const std::string& value, const std::string& unit, const std::string& name)
  {
    return "<div class=\"figure\"><b>" + value + " <small>" + unit + "</small></b><span>" + name +
      "</span></div>\n";
  };
  return "<div class=\"figures\">\n" +
    figure(Format(result.After.Correlation, 3), "", "correlation inside the breast (1 is best)") +
    figure(Format(result.After.MeanOutlineDistanceMm, 2), "mm", "mean distance of the outlines") +
    figure(Format(result.After.LargestOutlineDistanceMm, 2), "mm",
      "largest distance of the outlines") +
    figure(Format(result.Pose.ThicknessMm, 1), "mm", "compressed thickness") + "</div>\n";
}

std::string PicturesHtml(const ReportPictures& pictures)
{
  const auto picture = [](const std::string& png, const std::string& name, const std::string& text)
  {
    return "<figure><img alt=\"" + name + "\" src=\"data:image/png;base64," + Base64(png) +
      "\">\n<figcaption><b>" + name + "</b>" + text + "</figcaption></figure>\n";
  };
  const auto key = [](const char* color)
  { return std::string("<span class=\"key\" style=\"background:") + color + "\"></span>"; };
  return std::string("<section>\n<h2>Pictures</h2>\n<div class=\"pictures") +
    (pictures.Wide ? " wide" : "") + "\">\n" +
    picture(pictures.Real, "Real mammogram",
      "Log attenuation; the breast's outline " + key("#ff8c1a") + "as found in it. " +
        key("#9e6bab") + "Left out of the comparison.") +
    picture(pictures.Synthetic, "Synthetic mammogram",
      "The MRI's breast, compressed; its outline " + key("#1aa6ff") + "in the same grey window.") +
    picture(pictures.Overlay, "Overlay",
      key("#ff8c1a") + "real and " + key("#1aa6ff") + "synthetic; grey where they agree.") +
    picture(pictures.Difference, "Difference",
      "Synthetic minus real in standard deviations, grey where left out: " + key("#b2182b") +
        "synthetic absorbs more, " + key("#2166ac") + "less. Full " + key("#ff8c1a") + "or " +
        key("#1aa6ff") + ": breast in the real or the synthetic one only.") +
    "</div>\n<p style=\"color:var(--quiet);font-size:13px;margin:12px 0 0\">Letters are patient "
    "directions: A anterior, P posterior, L left, R right, H head, F feet.</p>\n</section>\n";
}

/// Both pictures in one place; the script takes them from the figures above, so that each is in the
/// file once.
constexpr const char* Comparison = R"html(<section hidden>
<h2>Compare</h2>
<form class="controls">
<label><input type="radio" name="mode" value="blend" checked> blend, real
<input type="range" min="0" max="100" value="50" aria-label="share of the synthetic mammogram"> synthetic</label>
<label><input type="radio" name="mode" value="checkerboard"> checkerboard</label>
<label><input type="radio" name="mode" value="flicker"> flicker</label>
</form>
<div class="stage"><img alt="Real mammogram"><img alt="Synthetic mammogram"></div>
<script>
{
const section = document.currentScript.parentElement;
const pictures = section.previousElementSibling;
const stage = section.querySelector(".stage");
const range = section.querySelector("[type=range]");
const blend = () => stage.style.setProperty("--blend", range.value + "%");
stage.querySelectorAll("img").forEach(image => {
  image.src = pictures.querySelector(`img[alt="${image.alt}"]`).src; });
section.querySelectorAll("[name=mode]").forEach(button => {
  button.onchange = () => { stage.className = "stage " + button.value; }; });
range.oninput = () => { section.querySelector("[value=blend]").click(); blend(); };
section.hidden = false;
}
</script>
</section>
)html";

/// NaN where it is not known, or the parameter is taken for exact.
double ConsideredDeviation(const RegistrationResult& result, std::size_t parameter)
{
  const std::size_t count = result.Parameters.size();
  const double variance =
    result.ConsideredCovariance.empty() ? 0 : result.ConsideredCovariance[parameter * (count + 1)];
  return variance > 0 ? std::sqrt(variance) : std::numeric_limits<double>::quiet_NaN();
}

std::string ParametersHtml(const RegistrationResult& result)
{
  std::string html = "<section>\n<h2>What was found</h2>\n<table>\n<tr><th>Parameter</th>"
                     "<th class=\"number\">Result</th><th class=\"number\">± (1 SD)</th>"
                     "<th class=\"number\">± with what is held</th>"
                     "<th class=\"number\">Start</th><th class=\"number\">Allowed</th>"
                     "<th>Unit</th><th></th></tr>\n";
  for (std::size_t i = 0; i < result.Parameters.size(); ++i)
  {
    const RegistrationParameter& parameter = result.Parameters[i];
    const auto cell = [](const std::string& text)
    { return "<td class=\"number\">" + text + "</td>"; };
    html += "<tr><td>" + Escape(ParameterTitle(parameter.Name)) + "</td>" +
      cell("<b>" + Format(result.Values[i], 2) + "</b>") +
      cell(Format(result.StandardDeviations[i], 2)) +
      cell(Format(ConsideredDeviation(result, i), 2)) + cell(Format(parameter.Start, 2)) +
      cell(
        parameter.Fixed ? "–" : Format(parameter.Lower, 1) + " … " + Format(parameter.Upper, 1)) +
      "<td>" + Escape(UnitText(parameter.Unit)) + "</td><td>" +
      (parameter.Fixed                           ? "<span class=\"flag\">held fixed</span>"
          : AtBound(parameter, result.Values[i]) ? "<span class=\"flag\">at its bound</span>"
                                                 : "") +
      "</td></tr>\n";
  }
  return html +
    "</table>\n<p style=\"color:var(--quiet);font-size:13px;margin:10px 0 0\">± is the standard "
    "deviation by the covariance at the solution: it tells how sharply the pictures determine a "
    "parameter, not how well the model holds. The second one also counts what is not known of the "
    "parameters that were held fixed: their allowance, and how far the others would have followed. "
    "A positive rotation turns the X-ray source from "
    "above "
    "towards the patient's left.</p>\n</section>\n";
}

Lines MammogramLines(const Mammogram& mammogram, const RegistrationTarget& target)
{
  const auto optional = [](const std::optional<double>& value, int digits, const char* unit)
  { return value ? Format(*value, digits) + " " + unit : std::string("not stated"); };
  const auto text = [](const std::string& value)
  { return value.empty() ? std::string("not stated") : value; };
  return { { "View", text(mammogram.View) },
    { "Breast",
      mammogram.Laterality == 'L'     ? "left"
        : mammogram.Laterality == 'R' ? "right"
                                      : "not stated" },
    { "Kind",
      mammogram.PresentationIntent == Mammogram::Intent::ForProcessing ? "For Processing"
                                                                       : "For Presentation" },
    { "Pixels", std::to_string(mammogram.Columns) + " × " + std::to_string(mammogram.Rows) },
    { "Pixel spacing at the receptor",
      Format(mammogram.ColumnSpacingMm, 3) + " × " + Format(mammogram.RowSpacingMm, 3) + " mm" },
    { "Thickness by the header", optional(mammogram.BodyPartThicknessMm, 1, "mm") },
    { "Source to detector", optional(mammogram.SourceToDetectorMm, 0, "mm") },
    { "Tube voltage", optional(mammogram.PeakKilovoltage, 1, "kVp") },
    { "Anode / filter", text(mammogram.AnodeMaterial) + " / " + text(mammogram.FilterMaterial) },
    { "Left out of the comparison",
      Format(100 * ShareExcluded(target), 1) + " % of the breast's picture" } };
}

Lines SearchLines(const RegistrationResult& result)
{
  const CompressionState& state = result.State;
  return { { "Stopped because", result.StopReason },
    { "Converged", result.Converged ? "yes" : "no" },
    { "Iterations", std::to_string(result.Iterations.size()) },
    { "Compressions computed", std::to_string(result.Evaluations) },
    { "Time", Format(result.Seconds, 1) + " s" },
    { "Force on the paddle", Format(state.PaddleForceN, 1) + " N" },
    { "Volume kept", Format(100 * state.VolumeRatio, 2) + " %" },
    { "Smallest and largest local volume change",
      Format(state.SmallestJ, 3) + " … " + Format(state.LargestJ, 3) },
    { "Deepest penetration of a plate", Format(state.LargestPenetrationMm, 3) + " mm" } };
}

std::string BreastText(const Mammogram& mammogram)
{
  return mammogram.Laterality == 'L' ? "Left breast"
    : mammogram.Laterality == 'R'    ? "Right breast"
                                     : "Breast of unstated side";
}

/// A whole page around what it tells.
std::string PageHtml(const std::string& title, const std::string& subtitle, const std::string& body)
{
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<title>" +
    Escape(title) + "</title>\n<style>" + Style + "</style>\n</head>\n<body>\n<main>\n" +
    "<header>\n<h1>" + Escape(title) + "</h1>\n<p>" + Escape(subtitle) +
    " · MammoRay " MAMMORAY_VERSION "</p>\n</header>\n" + body +
    "<footer>Research software, not a medical device: no finding or its absence "
    "may be concluded from this report. The limits by which the match is judged are rules of thumb "
    "and have not been validated on patients.</footer>\n</main>\n</body>\n</html>\n";
}

/// All that the report of one mammogram tells, drawn and worded.
struct Composed
{
  Assessment Judged;
  std::vector<InputFile> Inputs;
  ReportPictures Pictures;
  std::string Plot;
  std::string Html;
};

std::string ViewHtml(const RegistrationReport& report, const Composed& parts)
{
  const RegistrationResult& result = *report.Result;
  std::string html = VerdictHtml(parts.Judged) + FiguresHtml(result) +
    PicturesHtml(parts.Pictures) + Comparison + ParametersHtml(result);
  html += "<section>\n<h2>Course of the search</h2>\n" + parts.Plot + "<p class=\"hint\">" +
    ResolutionNote(result) + "</p></section>\n";
  html += "<div class=\"columns\">\n<section>\n<h2>Search and compression</h2>\n" +
    Rows(SearchLines(result)) + "</section>\n<section>\n<h2>Mammogram</h2>\n" +
    Rows(MammogramLines(*report.RealMammogram, *report.Target)) + "</section>\n</div>\n";
  if (!report.Warnings.empty())
  {
    html += "<section class=\"notes\">\n<h2>What had to be assumed</h2>\n" +
      Sentences(report.Warnings) + "</section>\n";
  }
  html += "<section>\n<h2>Where it comes from</h2>\n<table>\n";
  for (const InputFile& input : parts.Inputs)
  {
    html += "<tr><td>" + Escape(input.Role) + "</td><td>" + Escape(input.Name) +
      "<br><code>SHA-256 " + input.Checksum + "</code></td></tr>\n";
  }
  for (const auto& [name, version] : VersionsOf(report))
  {
    html += "<tr><td>" + Escape(name) + "</td><td>" + Escape(version) + "</td></tr>\n";
  }
  return html + "</table>\n</section>\n";
}

Composed Compose(const RegistrationReport& report)
{
  Validate(report);
  Composed parts;
  parts.Judged = Assess(*report.Result);
  parts.Inputs = HashInputs(report);
  parts.Pictures = DrawPictures(report);
  parts.Plot = ConvergencePlot(report.Result->Iterations);
  parts.Html = ViewHtml(report, parts);
  return parts;
}

double DeviationOf(const JointReport& report, std::size_t unknown)
{
  return report.Covariance.empty()
    ? std::numeric_limits<double>::quiet_NaN()
    : std::sqrt(report.Covariance[unknown * (report.Unknowns.size() + 1)]);
}

std::string SharedHtml(const JointReport& report)
{
  std::string html = "<section>\n<h2>What the mammograms share</h2>\n";
  std::string rows;
  for (std::size_t index = 0; index < report.Unknowns.size(); ++index)
  {
    const JointUnknown& unknown = report.Unknowns[index];
    if (unknown.Shared)
    {
      const RegistrationResult& result = *report.Views.front().Result;
      rows += "<tr><td>" + Escape(ParameterTitle(result.Parameters[unknown.Parameter].Name)) +
        "</td><td class=\"value\"><b>" + Format(result.Values[unknown.Parameter], 2) + "</b> ± " +
        Format(DeviationOf(report, index), 2) + "</td></tr>\n";
    }
  }
  return html +
    (rows.empty() ? "No parameter that was free: each mammogram was registered by itself.\n"
                  : "<table>\n" + rows + "</table>\n") +
    "</section>\n";
}

std::string JointJson(const JointReport& report, const std::vector<Composed>& parts)
{
  using Json = nlohmann::ordered_json;
  const RegistrationResult& first = *report.Views.front().Result;
  Json json;
  json["format"] = JointResultFormat;
  json["formatVersion"] = 1;
  json["views"] = Json::array();
  for (std::size_t view = 0; view < report.Views.size(); ++view)
  {
    const RegistrationReport& told = report.Views[view];
    json["views"].push_back(
      { { "folder", report.Folders[view] }, { "view", told.RealMammogram->View },
        { "laterality", std::string(1, told.RealMammogram->Laterality) },
        { "trust", NameOf(parts[view].Judged.Level) },
        { "correlation", told.Result->After.Correlation },
        { "meanOutlineDistanceMm", told.Result->After.MeanOutlineDistanceMm } });
  }
  json["unknowns"] = Json::array();
  for (std::size_t index = 0; index < report.Unknowns.size(); ++index)
  {
    const JointUnknown& unknown = report.Unknowns[index];
    const RegistrationResult& result = *report.Views[unknown.Mammogram].Result;
    json["unknowns"].push_back({ { "name", result.Parameters[unknown.Parameter].Name },
      { "unit", result.Parameters[unknown.Parameter].Unit },
      { "folder", unknown.Shared ? Json(nullptr) : Json(report.Folders[unknown.Mammogram]) },
      { "value", result.Values[unknown.Parameter] },
      { "standardDeviation", DeviationOf(report, index) } });
  }
  json["covariance"] = report.Covariance.empty() ? Json(nullptr) : Json(report.Covariance);
  json["converged"] = first.Converged;
  json["stopReason"] = first.StopReason;
  json["seconds"] = first.Seconds;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void WriteFile(const std::filesystem::path& path, const std::string& content)
{
  // Aside first, so that a file of this name is always a whole one.
  const std::filesystem::path aside = path.string() + ".part";
  std::ofstream file(aside, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.close();
  std::error_code code;
  if (file)
  {
    std::filesystem::rename(aside, path, code);
  }
  if (!file || code)
  {
    std::error_code ignored;
    std::filesystem::remove(aside, ignored);
    throw InputError(path.string() + ": expected a file that can be written");
  }
}

std::string TitleOf(const Mammogram& mammogram, std::size_t number)
{
  return mammogram.View.empty() ? "Mammogram " + std::to_string(number + 1)
                                : mammogram.View + " view";
}

void WriteView(const RegistrationReport& report, const Composed& parts, const std::string& folder)
{
  const Mammogram& mammogram = *report.RealMammogram;
  const std::string subtitle =
    BreastText(mammogram) + (mammogram.View.empty() ? "" : ", " + mammogram.View + " view");
  const std::pair<const char*, std::string> files[] = { { "real.png", parts.Pictures.Real },
    { "synthetic.png", parts.Pictures.Synthetic }, { "overlay.png", parts.Pictures.Overlay },
    { "difference.png", parts.Pictures.Difference }, { "convergence.svg", parts.Plot },
    { "result.json", ResultJson(report, parts.Judged, parts.Inputs) },
    { "report.html", PageHtml(report.Title, subtitle, parts.Html) } };

  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (!std::filesystem::is_directory(folder))
  {
    throw InputError(folder + ": expected a folder that can be made");
  }
  for (const auto& [name, content] : files)
  {
    WriteFile(std::filesystem::path(folder) / name, content);
  }
}
}

Assessment Assess(const RegistrationResult& result)
{
  Assessment assessment;
  const auto add = [&](Trust level, const std::string& reason)
  {
    assessment.Level = std::max(assessment.Level, level);
    assessment.Reasons.push_back(reason);
  };
  if (!std::isfinite(result.After.Correlation) ||
    !std::isfinite(result.After.MeanOutlineDistanceMm) ||
    !std::isfinite(result.After.LargestOutlineDistanceMm))
  {
    add(Trust::None, "The agreement of the pictures could not be computed.");
  }
  if (result.After.Correlation < 0.7)
  {
    add(result.After.Correlation < 0.5 ? Trust::None : Trust::Doubtful,
      "The pictures look little alike inside the breast: their correlation is " +
        Format(result.After.Correlation, 2) + ", 0.7 or more is wanted.");
  }
  if (result.After.MeanOutlineDistanceMm > 1.5)
  {
    add(result.After.MeanOutlineDistanceMm > 3 ? Trust::None : Trust::Doubtful,
      "The outlines of the breast lie " + Format(result.After.MeanOutlineDistanceMm, 1) +
        " mm apart on average, 1.5 mm or less is wanted.");
  }
  if (result.After.LargestOutlineDistanceMm > 5)
  {
    add(result.After.LargestOutlineDistanceMm > 10 ? Trust::None : Trust::Doubtful,
      "At one place the outlines lie " + Format(result.After.LargestOutlineDistanceMm, 1) +
        " mm apart, 5 mm or less is wanted.");
  }
  if (!result.Converged)
  {
    add(Trust::Doubtful,
      "The search ended before it had settled" +
        (result.StopReason.empty() ? std::string(".") : ": " + result.StopReason + "."));
  }
  for (std::size_t i = 0; i < std::min(result.Parameters.size(), result.Values.size()); ++i)
  {
    if (AtBound(result.Parameters[i], result.Values[i]))
    {
      add(Trust::Doubtful,
        ParameterTitle(result.Parameters[i].Name) +
          " ended at the limit of what was allowed: the best value may lie beyond it.");
    }
  }
  return assessment;
}

void WriteRegistrationReport(const RegistrationReport& report, const std::string& folder)
{
  WriteView(report, Compose(report), folder);
}

void WriteJointReport(const JointReport& report, const std::string& folder)
{
  if (report.Views.empty() || report.Views.size() != report.Folders.size())
  {
    throw InputError("report: expected a folder for each of " +
      std::to_string(report.Views.size()) + " views, found " +
      std::to_string(report.Folders.size()));
  }
  std::vector<Composed> parts;
  std::string html = SharedHtml(report);
  std::string views;
  for (std::size_t view = 0; view < report.Views.size(); ++view)
  {
    parts.push_back(Compose(report.Views[view]));
    html += "<h1 class=\"view\">" + Escape(TitleOf(*report.Views[view].RealMammogram, view)) +
      "</h1>\n" + parts.back().Html;
    views += (view == 0 ? "" : ", ") + TitleOf(*report.Views[view].RealMammogram, view);
  }
  const RegistrationReport& first = report.Views.front();
  for (std::size_t view = 0; view < report.Views.size(); ++view)
  {
    WriteView(report.Views[view], parts[view], folder + "/" + report.Folders[view]);
  }
  WriteFile(std::filesystem::path(folder) / "result.json", JointJson(report, parts));
  WriteFile(std::filesystem::path(folder) / "report.html",
    PageHtml(first.Title, BreastText(*first.RealMammogram) + ", " + views, html));
}
}
