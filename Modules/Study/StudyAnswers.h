// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_StudyAnswers_h
#define mammoray_StudyAnswers_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammorayStudyModule.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct BreastInUnit;
struct ResultFile;

/// A mammogram of a virtual study and where it shows the points.
struct TrueView
{
  /// "CC" or "MLO".
  std::string View;
  /// Relative to the study's folder.
  std::string File;
  BreastPose Pose;
  MammographyUnit Unit;
  /// The thickness in the mammogram's header, mm.
  double HeaderThicknessMm = 0;
  double PaddleForceN = 0;
  /// For each point its position in the gantry frame, mm; its shadow on the receptor, mm (y < 0: it
  /// falls behind the receptor's edge); and continuous column and row of the image.
  std::vector<Vector3> Gantry;
  std::vector<std::array<double, 2>> Receptor;
  std::vector<std::array<double, 2>> Pixels;
};

/// The truth of a virtual study (`truth.json`).
struct StudyTruth
{
  /// The patient's own side, 'L' or 'R'.
  char Laterality = 'L';
  std::uint32_t Seed = 0;
  /// The maker whose headers the MRI has: "siemens", "ge" or "philips".
  std::string Scanner = "siemens";
  /// Names of the materials, and the factors on the table's Young's moduli.
  std::vector<std::string> Materials;
  std::vector<double> StiffnessFactors;
  std::vector<double> YoungsModuliKPa;
  /// Mean distance by which gravity moved the points, mm.
  double MeanHangMm = 0;
  /// Stiffness of the chest wall against gliding, kPa / mm.
  double GlideStiffness = 0;
  /// Points of the breast's interior: in the MRI and in the stress-free shape, DICOM LPS, mm.
  std::vector<Vector3> MriPoints;
  std::vector<Vector3> RestPoints;
  std::vector<TrueView> Views;

  /// Null if the study has no such view.
  MAMMORAYSTUDY_EXPORT const TrueView* FindView(const std::string& view) const;
};

/// Reads a truth.json. Throws InputError, one line with the file, on anything else.
MAMMORAYSTUDY_EXPORT StudyTruth ReadStudyTruth(const std::string& path);

/// Writes a file that ReadStudyTruth reads. Throws InputError where it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteStudyTruth(const StudyTruth& truth, const std::string& path);

/// Position at which a method, any method, finds a point of a virtual study's MRI in a mammogram.
struct StudyAnswer
{
  /// "CC" or "MLO".
  std::string View;
  /// Index in StudyTruth::MriPoints.
  std::size_t Point = 0;
  /// Continuous column and row of the mammogram's file; pixel centres at whole numbers.
  std::array<double, 2> Pixel{ 0, 0 };
  /// Position in the gantry frame, mm. Absent if the method does not find the depth.
  std::optional<Vector3> Gantry;
};

/**
 * Reads answers from a CSV file with the header view,point,column,row or
 * view,point,column,row,x,y,z. Throws InputError that names file and line on anything else, on a
 * view other than CC and MLO, and on a point that is answered twice in a view.
 */
MAMMORAYSTUDY_EXPORT std::vector<StudyAnswer> ReadStudyAnswers(const std::string& path);

/// The errors of a method in one view of a study.
struct AnswerScore
{
  std::string View;
  /// Points whose shadow is in the mammogram, and points behind the receptor's edge, which nobody
  /// can look for in it.
  PointErrors Imaged;
  PointErrors Behind;
  /// Number of points that the mammogram shows and that have no answer.
  std::size_t Missing = 0;
};

/**
 * Errors of answers in each view that has any, in the truth's order: on the receptor, mm (pixels
 * times their size), and in the gantry frame. Throws InputError on views and points that the truth
 * does not have, and without any answer.
 */
MAMMORAYSTUDY_EXPORT std::vector<AnswerScore> ScoreAnswers(const StudyTruth& truth,
  const std::vector<StudyAnswer>& answers);

/**
 * Errors of a registration of the study, with its breast (ReadBreastInUnit). Both frames are those
 * of the unit, so that the errors contain the deformation's and the pose's share. Throws InputError
 * if the study does not have the result's view.
 */
MAMMORAYSTUDY_EXPORT AnswerScore ScoreResult(const StudyTruth& truth, const ResultFile& result,
  const BreastInUnit& breast);
}

#endif
