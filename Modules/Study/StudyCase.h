// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_StudyCase_h
#define mammoray_StudyCase_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/RegistrationReport.h"
#include "mammorayStudyModule.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// The material table of the tissue that a study is segmented into.
inline constexpr const char* StudyMaterials = "segment";

/// TargetOptions::ChestWallMarginMm of a study: what is farther in front of the chest wall than the
/// plates' edges is breast.
inline constexpr double StudyChestWallMarginMm = 10.0;

/// RegistrationCase::RollSigmaDeg of a study: the patient stands upright before a unit whose angle
/// the header says, a few degrees off how she lay. A picture alone hardly tells the roll.
inline constexpr double StudyRollSigmaDeg = 5.0;

/// A study's MRI as tissue; DICOM LPS.
struct StudyTissue
{
  /// Of the side that is registered: labels of the table "segment".
  LabelVolume Labels;
  /// The MRI on the same grid after bias correction, fat is 1: that without fat suppression where
  /// there are both.
  IntensityVolume Mri;
  /// What is registered: the breast and the chest wall behind it without the body beside them
  /// (KeepBreast); material indices.
  LabelVolume Breast;
  /// What of the body was cut off behind it (CutTissue).
  LabelVolume Cut;
  /// Its fat, gland and skin, and gland's part in them, [0, 1].
  double BreastCm3 = 0;
  double GlandFraction = 0;
  /// How far the skin lies in front of the chest wall, mm.
  double DepthMm = 0;
  /// Of the segmentation, a sentence each.
  std::vector<std::string> Warnings;
};

/**
 * Makes a registration's case of a clinic's export: reads its headers, chooses (Intake.h), and
 * fills what the case leaves open: the mammograms and their side, the patient's position in the
 * MRI, the table StudyMaterials, a chest wall along which the breast slides, what of the mammograms
 * is not compared there, and how far the roll may be off (StudyRollSigmaDeg). `laterality`: 'L',
 * 'R' or what all mammograms are of. Series are told by their numbers, unless the case names its
 * inputs. The MRI is segmented when the case runs. Throws InputError,
 * one line, where there is nothing that can be registered; Interrupted.
 */
MAMMORAYSTUDY_EXPORT void TakeStudy(const std::string& folder, std::optional<char> laterality,
  RegistrationCase& input, const ProgressCallback& progress = {});

/**
 * Reads the MRI that was chosen and segments it (SegmentBreast), without and with fat suppression
 * together where there are both. `table`: of those labels; `acceptUnusual`: as in
 * SegmentationOptions. Throws as these, and InputError in a build without Segmentation.
 */
MAMMORAYSTUDY_EXPORT StudyTissue SegmentStudy(const StudyChoice& choice, const MaterialTable& table,
  const ProgressCallback& progress = {}, bool acceptUnusual = false);

/// What a report tells of a study: what was taken and what was left out, and why; the tissue that
/// was found, with a picture of it (SlicePicture); what is to be known of both.
MAMMORAYSTUDY_EXPORT ReportSection StudySection(const StudyChoice& choice,
  const StudyTissue& tissue);
}

#endif
