// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/RegistrationReport.h"

#include "Private/ReportParts.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <filesystem>

namespace mammoray
{
namespace
{
/// The report of one mammogram, drawn and worded.
struct Composed
{
  ReportPictures Pictures;
  std::string Plot;
  /// The sections of its page.
  std::string Html;
};

Composed Compose(const RegistrationReport& report)
{
  Composed parts;
  parts.Pictures = DrawPictures(report);
  parts.Plot = ConvergencePlot(report.Registered->Registration.Iterations);
  parts.Html = MammogramHtml(report, parts.Pictures, parts.Plot);
  return parts;
}

std::string BreastText(const Mammogram& mammogram)
{
  return mammogram.Laterality == 'L' ? "Left breast"
    : mammogram.Laterality == 'R'    ? "Right breast"
                                     : "Breast of unstated side";
}

std::string TitleOf(const Mammogram& mammogram, std::size_t number)
{
  return mammogram.View.empty() ? "Mammogram " + std::to_string(number + 1)
                                : mammogram.View + " view";
}

void WriteParts(const RegistrationReport& report, const Composed& parts, const std::string& folder)
{
  const Mammogram& mammogram = report.Registered->Mammogram;
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
  std::vector<Composed> parts;
  parts.reserve(report.Mammograms.size());
  std::vector<AnsweredMammogram> answered;
  std::string html;
  std::string titles;
  for (const RegistrationReport& each : report.Mammograms)
  {
    const std::string title = TitleOf(each.Registered->Mammogram, parts.size());
    parts.push_back(Compose(each));
    answered.push_back({ title, &each, &parts.back().Pictures });
    html += "<h1 class=\"view\">" + Escape(title) + "</h1>\n" + parts.back().Html;
    titles += ", " + title;
  }
  for (std::size_t number = 0; number < parts.size(); ++number)
  {
    WriteParts(report.Mammograms[number], parts[number],
      folder + "/" + report.File->Mammograms[number].Folder);
  }
  const RegistrationReport& first = report.Mammograms.front();
  html = AnswerHtml(first.Asked, answered) + html + SharedHtml(*report.File) +
    SectionsHtml(report.Sections);
  WriteAtomicFile((std::filesystem::path(folder) / "report.html").string(),
    PageHtml(first.Title, BreastText(first.Registered->Mammogram) + titles, first.Examination,
      html));
}
}
