// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/RegistrationReport.h"

#include "Private/ConvergencePlot.h"
#include "Private/ReportAnswer.h"
#include "Private/ReportPage.h"
#include "Private/ReportPictures.h"
#include "Private/ReportSections.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <filesystem>

namespace mammoray
{
namespace
{
void Validate(const RegistrationReport& report)
{
  if (!report.RealMammogram || !report.Target || !report.Result)
  {
    throw InputError("report: expected a mammogram, a target and a result, found one missing");
  }
  const RegistrationTarget& target = *report.Target;
  const std::vector<float>& synthetic = report.Result->Synthetic.LogAttenuation;
  const std::size_t count =
    static_cast<std::size_t>(target.Grid.Columns) * static_cast<std::size_t>(target.Grid.Rows);
  if (count == 0 || target.LogAttenuation.size() != count || target.BreastMask.size() != count ||
    target.SignedDistanceMm.size() != count || synthetic.size() != count)
  {
    throw InputError("report: expected " + std::to_string(target.Grid.Columns) + " x " +
      std::to_string(target.Grid.Rows) + " pixels in target and synthetic image, found " +
      std::to_string(synthetic.size()) + " synthetic ones");
  }
  if (report.Places.size() != report.Asked.size())
  {
    throw InputError("report: expected an answer to each of " +
      std::to_string(report.Asked.size()) + " places, found " +
      std::to_string(report.Places.size()));
  }
  const ViewResult& result = *report.Result;
  if (result.Values.size() != result.Parameters.size() ||
    result.StandardDeviations.size() != result.Parameters.size())
  {
    throw InputError("report: expected a value and a deviation for each of " +
      std::to_string(result.Parameters.size()) + " parameters, found " +
      std::to_string(result.Values.size()) + " and " +
      std::to_string(result.StandardDeviations.size()));
  }
}

/// All that the report of one mammogram tells, drawn and worded.
struct Composed
{
  ReportPictures Pictures;
  std::string Plot;
  /// The sections of its page.
  std::string Html;
};

Composed Compose(const RegistrationReport& report)
{
  Validate(report);
  Composed parts;
  parts.Pictures = DrawPictures(report);
  parts.Plot = ConvergencePlot(report.Result->Iterations);
  parts.Html = MammogramHtml(report, parts.Pictures, parts.Plot);
  return parts;
}

std::string TitleOf(const Mammogram& mammogram, std::size_t number)
{
  return mammogram.View.empty() ? "Mammogram " + std::to_string(number + 1)
                                : mammogram.View + " view";
}

void WriteParts(const RegistrationReport& report, const Composed& parts, const std::string& folder)
{
  const Mammogram& mammogram = *report.RealMammogram;
  const std::string subtitle =
    BreastText(mammogram) + (mammogram.View.empty() ? "" : ", " + mammogram.View + " view");
  const std::string html =
    AnswerHtml(report.Asked, { { TitleOf(mammogram, 0), &report, &parts.Pictures } }) + parts.Html;
  const auto& pictures = parts.Pictures.Files;
  const std::pair<const char*, std::string> files[] = { { "real.png", pictures[0] },
    { "synthetic.png", pictures[1] }, { "overlay.png", pictures[2] },
    { "difference.png", pictures[3] }, { "convergence.svg", parts.Plot },
    { "report.html", PageHtml(report.Title, subtitle, report.Examination, html) } };

  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (!std::filesystem::is_directory(folder))
  {
    throw InputError(folder + ": expected a folder that can be made");
  }
  for (const auto& [name, content] : files)
  {
    WriteAtomicFile((std::filesystem::path(folder) / name).string(), content);
  }
}
}

void WriteRegistrationReport(const RegistrationReport& report, const std::string& folder)
{
  WriteParts(report, Compose(report), folder);
}

void WriteJointReport(const JointReport& report, const std::string& folder)
{
  if (report.Mammograms.empty() || report.Mammograms.size() != report.Folders.size())
  {
    throw InputError("report: expected a folder for each of " +
      std::to_string(report.Mammograms.size()) + " mammograms, found " +
      std::to_string(report.Folders.size()));
  }
  std::vector<Composed> parts;
  parts.reserve(report.Mammograms.size());
  std::vector<AnsweredMammogram> answered;
  std::string html;
  std::string titles;
  for (std::size_t number = 0; number < report.Mammograms.size(); ++number)
  {
    const RegistrationReport& told = report.Mammograms[number];
    const std::string title = TitleOf(*told.RealMammogram, number);
    parts.push_back(Compose(told));
    answered.push_back({ title, &told, &parts.back().Pictures });
    html += MammogramHeading(title) + parts.back().Html;
    titles += (number == 0 ? "" : ", ") + title;
  }
  for (std::size_t number = 0; number < report.Mammograms.size(); ++number)
  {
    WriteParts(report.Mammograms[number], parts[number], folder + "/" + report.Folders[number]);
  }
  const RegistrationReport& first = report.Mammograms.front();
  html = AnswerHtml(first.Asked, answered) + html + SharedHtml(report.Shared) +
    SectionsHtml(report.Sections);
  WriteAtomicFile((std::filesystem::path(folder) / "report.html").string(),
    PageHtml(first.Title, BreastText(*first.RealMammogram) + ", " + titles, first.Examination,
      html));
}
}
