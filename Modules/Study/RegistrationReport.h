// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationReport_h
#define mammoray_RegistrationReport_h

#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/Study/StudyPictures.h"
#include "mammorayStudyModule.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// A further section of a report: rows of a name and a text, a picture, sentences.
struct ReportSection
{
  std::string Title;
  std::vector<std::pair<std::string, std::string>> Rows;
  LayeredPicture Picture;
  std::string Caption;
  std::vector<std::string> Notes;
};

/// What a report was asked to find: a point of the MRI, or a lesion by its centre.
struct AskedPlace
{
  /// "Lesion 2", and "2" in pictures.
  std::string Name;
  std::string ShortName;
  /// Volume frame, mm.
  Vector3 Point{ 0, 0, 0 };
  /// Volume of a lesion; 0 for a point.
  double VolumeMm3 = 0;
  /// Slices through it.
  LayeredPicture Slices;
  /// Label of a lesion; 0 for a point.
  int Label = 0;
};

/// Where a mammogram shows such a place.
struct PlaceInMammogram
{
  /// Why it was not found, a sentence; empty if it was.
  std::string Problem;
  ImagedPoint Imaged;
  /// Outlines of a lesion's shadow, as in LesionShadow.
  std::vector<std::vector<std::array<double, 2>>> Outlines;
};

/// The report of one mammogram. The referenced objects must live until it is written.
struct RegistrationReport
{
  std::string Title = "Breast MRI and mammogram, registered";
  const RegisteredView* Registered = nullptr;
  const ResultFile* File = nullptr;
  /// When the pictures were made and, if wanted, of whom: a name and a text each.
  std::vector<std::pair<std::string, std::string>> Examination;
  /// What was asked for, which is the head of the page, and one place in this mammogram for each.
  std::vector<AskedPlace> Asked;
  std::vector<PlaceInMammogram> Places;
  /// The breast between the plates (DrawBreast); without a picture it is left out.
  LayeredPicture BetweenPlates;
  /// Sections at the end of its page.
  std::vector<ReportSection> Sections;
};

/**
 * Writes into a folder, which is created if it does not exist: report.html (self-contained, with a
 * Content-Security-Policy that lets it load nothing, and no scripts but its own), convergence.svg,
 * and real.png, synthetic.png, overlay.png and difference.png. Pictures have square pixels and are
 * shown as mammograms are hung (chest wall at the left for the left breast, lateral side or head
 * up), both mammograms z-scored inside both outlines and in one grey window.
 *
 * Throws InputError if the folder cannot be written. Nothing is written before everything is
 * composed; files of the same names are replaced.
 */
MAMMORAYSTUDY_EXPORT void WriteRegistrationReport(const RegistrationReport& report,
  const std::string& folder);

/// The report of several mammograms of one breast that were registered together.
struct JointReport
{
  std::vector<RegistrationReport> Mammograms;
  /// It names their folders within that of this report, and what they share.
  const JointResultFile* File = nullptr;
  /// Sections at the end of the joint page.
  std::vector<ReportSection> Sections;
};

/**
 * Writes into a folder: for each mammogram a folder as by WriteRegistrationReport, and report.html
 * with the reports of all and what they share. Throws as that.
 */
MAMMORAYSTUDY_EXPORT void WriteJointReport(const JointReport& report, const std::string& folder);
}

#endif
