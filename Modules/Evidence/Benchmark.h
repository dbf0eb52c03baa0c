// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Benchmark_h
#define mammoray_Benchmark_h

#include "mammoray/Evidence/StudyAnswers.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayEvidenceModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// What a way to answer that comes with a benchmark is worth on one of its studies.
struct BaselineScore
{
  std::string Study;
  /// "rigid" or "affine": OutlineMotion.
  std::string Baseline;
  std::vector<AnswerScore> Views;
};

/**
 * Makes virtual studies and writes them, what is asked and what is true, so that any method can be
 * run and scored (ScoreAnswers) without this project's results. `folder` gets
 *
 * - PROTOCOL.md: what is given, asked and measured; SHA256SUMS of all other files;
 * - studies.csv: name, anatomy, side, sequences and views of each study;
 * - STUDY/export: the clinic's files (DICOM); STUDY/mri-*.nii.gz: the T1-weighted MRI before
 *   contrast among them, NIfTI; STUDY/cc.dcm and mlo.dcm: its mammograms; STUDY/labels.nii.gz: its
 *   breast as `segment` finds it, not the truth; STUDY/points.csv: the points that are asked for
 *   (point,x,y,z; DICOM LPS, mm);
 * - truth/STUDY.json (ReadVirtualStudyTruth), and truth/STUDY.csv, the answers that have no error;
 * - baselines/STUDY-rigid.csv and -affine.csv: answers by MoveByOutline; scores.csv: their errors.
 *
 * The folder appears when all is there. Throws InputError where a study cannot be made or the
 * folder is not empty; ConvergenceError, DeviceError, Interrupted.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<BaselineScore> ExportBenchmark(
  const std::vector<EvidenceStudy>& studies, const std::string& folder,
  const ProgressCallback& progress = {});
}

#endif
