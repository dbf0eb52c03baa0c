// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_StudyAnswers_h
#define mammoray_StudyAnswers_h

#include "mammoray/Evidence/StudyEvidence.h"
#include "mammorayEvidenceModule.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// Where a method, any method, says that a point of a virtual study's MRI lies in a mammogram.
struct StudyAnswer
{
  /// "CC" or "MLO".
  std::string View;
  /// Its place in VirtualStudyTruth::MriPoints.
  std::size_t Point = 0;
  /// Continuous column and row of the mammogram's file; pixel centres at whole numbers.
  std::array<double, 2> Pixel{ 0, 0 };
  /// In the gantry frame, mm, from a method that tells depth, too.
  std::optional<Vector3> Gantry;
};

/**
 * Reads answers from a CSV file with the header view,point,column,row or
 * view,point,column,row,x,y,z. Throws InputError that names file and line on anything else, on a
 * view but CC and MLO, and on a point that is answered twice in a view.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<StudyAnswer> ReadStudyAnswers(const std::string& path);

/// Writes what ReadStudyAnswers reads; with x, y and z where all answers have them. Throws
/// InputError where it cannot be written.
MAMMORAYEVIDENCE_EXPORT void WriteStudyAnswers(const std::vector<StudyAnswer>& answers,
  const std::string& path);

/// What a method's answers to a study's view are worth.
struct AnswerScore
{
  std::string View;
  /// Of the answered points whose shadow is in the mammogram, and of those behind the receptor's
  /// edge. InSpaceMm is empty where an answer has no Gantry.
  PointErrors Imaged;
  PointErrors Behind;
  /// Points that the mammogram shows and nobody answered.
  std::size_t Missing = 0;
};

/**
 * Errors of answers, of each view that has any, in the truth's order: on the receptor, mm (pixels
 * times their size), and in the gantry frame. Throws InputError on views and points the truth does
 * not have, and without any answer.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<AnswerScore> ScoreAnswers(const VirtualStudyTruth& truth,
  const std::vector<StudyAnswer>& answers);

/// A score of a result of 'mammoray register --study' (MeasureStudy) in the same form.
MAMMORAYEVIDENCE_EXPORT AnswerScore ScoreOf(const StudyViewErrors& errors);
}

#endif
