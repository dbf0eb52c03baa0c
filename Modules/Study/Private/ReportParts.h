// SPDX-License-Identifier: Apache-2.0
// The parts that a report is composed of: pictures, the plot, sections of HTML, the page.
#ifndef mammoray_ReportParts_h
#define mammoray_ReportParts_h

#include "mammoray/Study/RegistrationReport.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// The pictures of one mammogram.
struct ReportPictures
{
  /// Outlines lie over them as lines.
  LayeredPicture Real;
  LayeredPicture Synthetic;
  LayeredPicture Overlay;
  LayeredPicture Difference;
  /// The real one with what was asked for; no picture if nothing was.
  LayeredPicture Answer;
  /// Bytes of PNG files with the outlines in them, for the folder, in the order above.
  std::array<std::string, 4> Files;
  /// Whether they are about as wide as high or wider, so that two fit side by side, not four.
  bool Wide = false;
  /// Patient directions at the left, right, upper and lower side.
  std::array<std::string, 4> Letters;
  /// Whether gantry x grows upwards (+1) or downwards in them.
  double Up = 1;
};

ReportPictures DrawPictures(const RegistrationReport& report);

/// Costs over iterations as an SVG element; the ordinate is logarithmic if the costs span more than
/// a factor of 20.
MAMMORAYSTUDY_EXPORT std::string ConvergencePlot(
  const std::vector<RegistrationIteration>& iterations);

/// A mammogram as the answer describes it; the referenced objects must outlive it.
struct AnsweredMammogram
{
  /// "CC view".
  std::string Title;
  const RegistrationReport* Report = nullptr;
  const ReportPictures* Pictures = nullptr;
};

/// The head of a page: where each mammogram shows what was asked for, with how much trust. Empty if
/// nothing was asked for.
std::string AnswerHtml(const std::vector<AskedPlace>& asked,
  const std::vector<AnsweredMammogram>& mammograms);

/// All sections of one mammogram; `plot` is an SVG element.
std::string MammogramHtml(const RegistrationReport& report, const ReportPictures& pictures,
  const std::string& plot);

/// Further sections.
std::string SectionsHtml(const std::vector<ReportSection>& sections);

/// What mammograms that were registered together have in common.
std::string SharedHtml(const JointResultFile& joint);

/**
 * A whole HTML page around the sections of its body. Its Content-Security-Policy allows only its
 * own style and script and pictures that are in it. `examination`: names and texts for the head of
 * the page.
 */
std::string PageHtml(const std::string& title, const std::string& subtitle,
  const std::vector<std::pair<std::string, std::string>>& examination, const std::string& body);

/// A text with HTML's special characters as entities.
std::string Escape(const std::string& text);

/// A figure that contains its picture: `alt` as plain text, title and caption as HTML.
std::string FigureHtml(const LayeredPicture& picture, const std::string& alt,
  const std::string& title, const std::string& caption);
}

#endif
