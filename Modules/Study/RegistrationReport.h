// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationReport_h
#define mammoray_RegistrationReport_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/LayeredPicture.h"
#include "mammoray/Study/ResultFile.h"
#include "mammorayStudyModule.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
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

/// What a report was asked to find: a point of the MRI, or a lesion, whose centre stands for it.
struct AskedPlace
{
  /// "Lesion 2"; of pictures: "2".
  std::string Name;
  std::string ShortName;
  /// Volume frame, mm.
  Vector3 Point{ 0, 0, 0 };
  /// Of a lesion; 0: a point.
  double VolumeMm3 = 0;
  /// Slices through it.
  LayeredPicture Slices;
};

/// Where a mammogram shows such a place.
struct PlaceInMammogram
{
  /// Why it was not found, a sentence; empty: it was.
  std::string Problem;
  std::string Material;
  /// Gantry x and y on the receptor, mm.
  std::array<double, 2> ReceptorMm{ 0, 0 };
  /// Continuous position; pixel centres at whole numbers, from 0.
  double Column = 0;
  double Row = 0;
  bool InImage = true;
  /// Half the axes of the ellipse around it that holds the place with a probability of 95 % by the
  /// covariance of the parameters, mm, and the ellipse in gantry x and y; nothing where there is
  /// none.
  std::optional<std::array<double, 2>> HalfAxesMm;
  std::vector<std::array<double, 2>> Ellipse;
  /// Outlines of a lesion's shadow, gantry x and y.
  std::vector<std::vector<std::array<double, 2>>> Outlines;
};

/// What a report tells of one mammogram. The referenced objects must live until it is written.
struct RegistrationReport
{
  std::string Title = "Breast MRI and mammogram, registered";
  const Mammogram* RealMammogram = nullptr;
  const RegistrationTarget* Target = nullptr;
  const ViewResult* Result = nullptr;
  /// Share of the breast's picture that was not compared, [0, 1].
  double ShareExcluded = 0;
  std::vector<ResultInput> Inputs;
  /// Names and versions of what took part.
  std::vector<std::pair<std::string, std::string>> Versions;
  /// What the user should know, the target's warnings included, a sentence each.
  std::vector<std::string> Warnings;
  /// When the pictures were made and, if wanted, of whom: a name and a text each.
  std::vector<std::pair<std::string, std::string>> Examination;
  /// What was asked for, with which the page begins, and where this mammogram shows each of them.
  std::vector<AskedPlace> Asked;
  std::vector<PlaceInMammogram> Places;
  /// The breast between the plates (DrawBreast); none: left out.
  LayeredPicture BetweenPlates;
  /// Told at the end of its page.
  std::vector<ReportSection> Sections;
};

/**
 * Writes into a folder, which is made where it is missing: report.html (self-contained,
 * with a Content-Security-Policy that lets it load nothing, and no scripts but its own),
 * convergence.svg, and real.png, synthetic.png, overlay.png and difference.png. Pictures have
 * square pixels and are shown as mammograms are hung (chest wall at the left for the left breast,
 * lateral side or head up), both mammograms z-scored inside both outlines and in one grey window.
 *
 * Throws InputError when the parts do not fit together or the folder cannot be written. Nothing is
 * written before everything is composed; files of the same names are replaced.
 */
MAMMORAYSTUDY_EXPORT void WriteRegistrationReport(const RegistrationReport& report,
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
MAMMORAYSTUDY_EXPORT void WriteJointReport(const JointReport& report, const std::string& folder);
}

#endif
