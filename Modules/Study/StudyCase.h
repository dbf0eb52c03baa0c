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

/// TargetOptions::ChestWallMarginMm of a study: depth of breast tissue behind the plates' edges.
inline constexpr double StudyChestWallMarginMm = 10.0;

/// RegistrationCase::RollSigmaDeg of a study. The patient stands upright before a unit whose angle
/// the header gives, but a few degrees off how she lay, and a picture alone hardly shows the roll.
inline constexpr double StudyRollSigmaDeg = 5.0;

/// Tissue in a study's MRI, DICOM LPS.
struct StudyTissue
{
  /// Material indices with the materials' names, of the side that is registered.
  LabelVolume Labels;
  /// The MRI on the same grid, fat is 1, after bias correction if it was segmented. Without fat
  /// suppression if possible.
  IntensityVolume Mri;
  /// What is registered: the breast and the chest wall behind it, without the body beside them
  /// (KeepBreast). Material indices.
  LabelVolume Breast;
  /// What was cut off behind the breast (CutTissue).
  LabelVolume Cut;
  /// Volume of the breast's fat, gland and skin, and the fraction of gland in it, [0, 1].
  double BreastCm3 = 0;
  double GlandFraction = 0;
  /// Distance of the skin in front of the chest wall, mm.
  double DepthMm = 0;
  /// Notes of the segmentation, a sentence each.
  std::vector<std::string> Warnings;
  /// Why the borders of the breast are doubtful (BreastQuality::Doubt); no match of its mammograms
  /// is called good then. Empty if they are not.
  std::string Doubt;
};

/**
 * Turns a clinic's export into a case: reads its headers, chooses (Intake.h), and sets the case's
 * mammograms and side, the patient's position if the case does not say it, the table StudyMaterials
 * if there is none, a chest wall along which the breast slides, StudyChestWallMarginMm and
 * StudyRollSigmaDeg. `laterality`: 'L', 'R', or nothing for the side of all mammograms. Series are
 * described by their numbers unless the case names its inputs. The MRI is segmented when the case
 * runs. Throws InputError, one line, if nothing can be registered; Interrupted.
 */
MAMMORAYSTUDY_EXPORT void TakeStudy(const std::string& folder, std::optional<char> laterality,
  RegistrationCase& input, const ProgressCallback& progress = {});

/// The same of a study that was read before; its series and mammograms may have been corrected.
MAMMORAYSTUDY_EXPORT void TakeStudy(Study study, std::optional<char> laterality,
  RegistrationCase& input);

/**
 * Reads the MRI of a choice and segments it (SegmentBreast), without and with fat suppression
 * together if there are both. Undetermined counts as the former beside the latter if fat is bright
 * in it, else a warning says so. `table`: that of the labels; `acceptUnusual`: as in
 * SegmentationOptions. Throws as these, and InputError in a build without Segmentation.
 */
MAMMORAYSTUDY_EXPORT StudyTissue SegmentStudy(const StudyChoice& choice, const MaterialTable& table,
  const ProgressCallback& progress = {}, bool acceptUnusual = false);

/**
 * Takes the tissue of a study from labels (ReadMaterials), made of its MRI and corrected, instead
 * of a segmentation. Their grid may be another one and cover a part of the MRI only; of two breasts
 * the registered one is kept.
 *
 * Throws InputError, one line, unless the labels' frame is that of the MRI, DICOM LPS: where it is
 * another one, their tissue lies outside the MRI, on the other side of it, or the MRI is not
 * brighter behind their skin than before it. LabelSource::AcceptUnusual takes labels all the same.
 */
MAMMORAYSTUDY_EXPORT StudyTissue LabelStudy(const StudyChoice& choice, const LabelSource& labels,
  const MaterialTable& table, const ProgressCallback& progress = {});

/// The report's section on a study: what was taken and what was left out, and why; the tissue with
/// a picture (DrawLabelSlices), and the name of the `labels` that it is of, if it was not
/// segmented; the warnings of both.
MAMMORAYSTUDY_EXPORT ReportSection StudySection(const StudyChoice& choice,
  const StudyTissue& tissue, const std::string& labels = "");
}

#endif
