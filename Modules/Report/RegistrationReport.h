// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationReport_h
#define mammoray_RegistrationReport_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayReportModule.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// What a report tells of. The referenced objects must live until it is written.
struct RegistrationReport
{
  std::string Title = "Breast MRI and mammogram, registered";
  const Mammogram* RealMammogram = nullptr;
  const RegistrationTarget* Target = nullptr;
  const RegistrationResult* Result = nullptr;
  /// Where the search put the unit, and the unit.
  VolumeFromGantry Placed;
  MammographyUnit Unit;
  /// Stage of the work -> wall time, s.
  std::vector<std::pair<std::string, double>> Timings;
  /// Log attenuation of the synthetic mammogram on the target's grid; 0 beside the breast.
  std::vector<float> Synthetic;
  /// Outline of the synthetic breast: lines of gantry x, y in the receptor plane, mm. Closed lines
  /// repeat their first point.
  std::vector<std::vector<std::array<double, 2>>> SyntheticOutline;
  /// What each input file was used for, and its path. The report holds the file's name without
  /// folder and its SHA-256.
  std::vector<std::pair<std::string, std::string>> Inputs;
  /// Names and versions of what took part beside MammoRay and VTK, such as the Vulkan device.
  std::vector<std::pair<std::string, std::string>> Versions;
  /// What the user should know, the target's warnings included, a sentence each.
  std::vector<std::string> Warnings;
};

/// How far a result may be relied on.
enum class Trust
{
  Good,
  Doubtful,
  None
};

struct Assessment
{
  Trust Level = Trust::Good;
  /// Why not better, a sentence each in plain words.
  std::vector<std::string> Reasons;
};

/**
 * Judges a result by its figures: correlation below 0.7 (0.5: none), mean outline distance
 * above 1.5 mm (3 mm: none), largest above 5 mm (10 mm: none), a search that did not converge, a
 * parameter at its bound, figures that are not numbers (none). The limits are rules of thumb, not
 * clinical validation.
 */
MAMMORAYREPORT_EXPORT Assessment Assess(const RegistrationResult& result);

/**
 * Writes into a folder, which is made where it is missing: report.html (self-contained),
 * result.json, convergence.svg, and real.png, synthetic.png, overlay.png and difference.png.
 * Pictures have square pixels and are shown as mammograms are hung (chest wall at the left for the
 * left breast, lateral side or head up), both mammograms z-scored inside both outlines and in one
 * grey window.
 *
 * Throws InputError when the parts do not fit together, an input cannot be read or the folder
 * cannot be written. Nothing is written before everything is composed; files of the same names are
 * replaced.
 */
MAMMORAYREPORT_EXPORT void WriteRegistrationReport(const RegistrationReport& report,
  const std::string& folder);

/// What a report on several mammograms of one breast tells, registered together.
struct JointReport
{
  std::vector<RegistrationReport> Views;
  /// For each view the name of its folder within that of this report.
  std::vector<std::string> Folders;
  /// As in JointRegistrationResult.
  std::vector<JointUnknown> Unknowns;
  std::vector<double> Covariance;
};

/**
 * Writes into a folder, which is made where it is missing: for each view a folder with all that
 * WriteRegistrationReport writes; report.html with the reports of all views and what they share;
 * result.json with the folders, what was free and its covariance. Throws as that.
 */
MAMMORAYREPORT_EXPORT void WriteJointReport(const JointReport& report, const std::string& folder);

/// The "format" of result.json, by which the two kinds of results are told apart.
inline constexpr const char* ResultFormat = "mammoray-registration-result";
inline constexpr const char* JointResultFormat = "mammoray-joint-registration-result";
}

#endif
