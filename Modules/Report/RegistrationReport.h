// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationReport_h
#define mammoray_RegistrationReport_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayReportModule.h"

#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// A file that a result was made from.
struct ReportInput
{
  /// What it was used for.
  std::string Role;
  /// Its name without folder, and its SHA-256.
  std::string File;
  std::string Sha256;
};

/// Something that a report tells besides: rows of a name and a text, a picture, sentences.
struct ReportSection
{
  std::string Title;
  std::vector<std::pair<std::string, std::string>> Rows;
  /// Bytes of a PNG file; empty: none.
  std::string Picture;
  std::string Caption;
  std::vector<std::string> Notes;
};

/// What a report tells of one mammogram. The referenced objects must live until it is written.
struct RegistrationReport
{
  std::string Title = "Breast MRI and mammogram, registered";
  const Mammogram* RealMammogram = nullptr;
  const RegistrationTarget* Target = nullptr;
  const RegistrationResult* Result = nullptr;
  /// Log attenuation of the synthetic mammogram on the target's grid; 0 beside the breast.
  std::vector<float> Synthetic;
  /// Outline of the synthetic breast: lines of gantry x, y in the receptor plane, mm. Closed lines
  /// repeat their first point.
  std::vector<std::vector<std::array<double, 2>>> SyntheticOutline;
  /// Share of the breast's picture that was not compared, [0, 1].
  double ShareExcluded = 0;
  std::vector<ReportInput> Inputs;
  /// Names and versions of what took part.
  std::vector<std::pair<std::string, std::string>> Versions;
  /// What the user should know, the target's warnings included, a sentence each.
  std::vector<std::string> Warnings;
  /// Told at the end of its page.
  std::vector<ReportSection> Sections;
};

/**
 * Writes into a folder, which is made where it is missing: report.html (self-contained),
 * convergence.svg, and real.png, synthetic.png, overlay.png and difference.png. Pictures have
 * square pixels and are shown as mammograms are hung (chest wall at the left for the left breast,
 * lateral side or head up), both mammograms z-scored inside both outlines and in one grey window.
 *
 * Throws InputError when the parts do not fit together or the folder cannot be written. Nothing is
 * written before everything is composed; files of the same names are replaced.
 */
MAMMORAYREPORT_EXPORT void WriteRegistrationReport(const RegistrationReport& report,
  const std::string& folder);

/// A free parameter that has one value for all mammograms.
struct SharedParameter
{
  std::string Name;
  double Value = 0;
  /// NaN where it is not known.
  double StandardDeviation = std::numeric_limits<double>::quiet_NaN();
};

/// What a report on several mammograms of one breast tells, registered together.
struct JointReport
{
  std::vector<RegistrationReport> Mammograms;
  /// Names of their folders within that of this report, one for each.
  std::vector<std::string> Folders;
  std::vector<SharedParameter> Shared;
  /// Told at the end of the page of all.
  std::vector<ReportSection> Sections;
};

/**
 * Writes into a folder, which is made where it is missing: for each mammogram a folder with all
 * that WriteRegistrationReport writes; report.html with the reports of all and what they share.
 * Throws as that.
 */
MAMMORAYREPORT_EXPORT void WriteJointReport(const JointReport& report, const std::string& folder);
}

#endif
