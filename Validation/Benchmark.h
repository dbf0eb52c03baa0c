// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_Benchmark_h
#define mammoray_Validation_Benchmark_h

#include "StudyRuns.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Study/StudyAnswers.h"

#include <string>
#include <vector>

namespace mammoray
{
/// The errors of a baseline that comes with a benchmark on one of its studies.
struct BaselineScore
{
  std::string Study;
  /// "rigid" or "affine": OutlineMotion.
  std::string Baseline;
  std::vector<AnswerScore> Views;
};

/**
 * Writes virtual studies with questions and true answers, so that any method can be run and scored
 * (ScoreAnswers) without a registration of this project. `folder` gets
 *
 * - PROTOCOL.md: what is given, asked and measured; SHA256SUMS of all other files;
 * - studies.csv: name, anatomy, side, sequences and views of each study;
 * - STUDY/export: the clinic's files (DICOM); STUDY/mri-*.nii.gz: the T1-weighted MRI before
 *   contrast among them, NIfTI; STUDY/cc.dcm and mlo.dcm: its mammograms; STUDY/labels.nii.gz: the
 *   segmentation of its breast by `segment`, not the truth; STUDY/points.csv: the points to find
 *   (point,x,y,z; DICOM LPS, mm);
 * - truth/STUDY.json (ReadStudyTruth), and truth/STUDY.csv, the answers without error;
 * - baselines/STUDY-rigid.csv and -affine.csv: answers by MoveByOutline; scores.csv: their errors.
 *
 * The folder appears when it is complete. Throws InputError if a study cannot be made or the folder
 * is not empty; ConvergenceError, DeviceError, Interrupted.
 */
std::vector<BaselineScore> ExportBenchmark(const std::vector<PlannedStudy>& studies,
  const std::string& folder, const ProgressCallback& progress = {});
}

#endif
