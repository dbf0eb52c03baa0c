// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_StudyEvidence_h
#define mammoray_StudyEvidence_h

#include "mammoray/Evidence/VirtualStudy.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammoray/Study/LabelSource.h"
#include "mammorayEvidenceModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A virtual study to make and to register.
struct EvidenceStudy
{
  /// Of the anatomy.
  std::string Phantom;
  /// A folder with an MRI whose breast of the study's side is segmented for it, free of load for
  /// the study's purpose; empty: Labels.
  std::string Mri;
  LabelSource Labels;
  std::string Materials = "victre";
  std::string Orientation = "ALS";
  VirtualStudyOptions Options;
  /// Of the registration: how pictures are compared, in which pixels.
  RegistrationOptions Registration;
};

/// How far points of a virtual study's truth were found from where they are in one mammogram.
struct PointErrors
{
  /// Of each point: in the gantry frame, and of its shadow on the receptor, mm.
  std::vector<double> InSpaceMm;
  std::vector<double> OnReceptorMm;
  /// How far along gantry z, nearly the beam, which one picture shows least of.
  std::vector<double> AlongBeamMm;
};

struct StudyViewErrors
{
  std::string View;
  /// Of the points whose shadow is in the mammogram, and of those behind the receptor's edge, which
  /// nobody can look for in it.
  PointErrors Imaged;
  PointErrors Behind;
  /// Of the imaged points' coordinates in the gantry frame the share within two of their standard
  /// deviations of the truth.
  double CoordinatesWithin = 0;
  /// Of each of these coordinates what the model's own error (ModelErrorMm of Case) would have to
  /// be multiplied by for that: 0 where the parameters' covariance alone suffices.
  std::vector<double> ModelErrorNeeded;
  double MeanOutlineMm = 0;
  double Correlation = 0;
  double TissueCorrelation = 0;
  /// What the result says of its error (ExpectedError), mm; NaN where it says nothing.
  double ExpectedMedianMm = 0;
  double Expected95Mm = 0;
  /// "good", "doubtful" or "none": what the report says of it, and why it is not better.
  std::string Trust;
  std::vector<std::string> Reasons;
};

/// How far points that both mammograms show were found in the MRI from where they are, by the true
/// places of their shadows, mm: from CC alone, in the middle of the tissue behind it, and from both
/// (FindInTwoViews).
struct TwoViewErrors
{
  std::vector<double> OneViewMm;
  std::vector<double> BothViewsMm;
};

/// What came of a virtual study.
struct StudyRun
{
  std::string Phantom;
  std::uint32_t Seed = 0;
  char Laterality = 'L';
  std::vector<StudyViewErrors> Views;
  TwoViewErrors Together;
  /// Where the study has a tomosynthesis (VirtualStudyOptions::Projections): its CC registered
  /// alone, and all projections together; one each.
  std::vector<StudyViewErrors> CcAlone;
  std::vector<StudyViewErrors> Swept;
  double Seconds = 0;
  /// Empty, or why there is no result.
  std::string Failure;
};

/**
 * Errors of a result folder of 'mammoray register --study' on a virtual study, of each mammogram.
 * Both frames are those of the unit, so that errors hold the deformation's and the pose's share.
 * Throws InputError where the result is of other mammograms.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<StudyViewErrors> MeasureStudy(const VirtualStudyTruth& truth,
  const std::string& resultFolder);

/// Of its CC and MLO, at the points that both show; nothing where either is missing.
MAMMORAYEVIDENCE_EXPORT TwoViewErrors MeasureTwoViews(const VirtualStudyTruth& truth,
  const std::string& resultFolder);

/// Makes a virtual study in a folder that is not there or empty (MakeVirtualStudy); of a patient's
/// MRI the breast is segmented and freed of its coil first.
MAMMORAYEVIDENCE_EXPORT VirtualStudyTruth MakeEvidenceStudy(const EvidenceStudy& study,
  const std::string& folder, const ProgressCallback& progress = {});

/**
 * Makes a virtual study, registers it as 'mammoray register --study' does, told nothing but how to
 * compare, and measures. A refusal or a search that fails is an answer (StudyRun::Failure).
 * `keepIn`: a folder, made where it is not there, that keeps "<phantom>-<seed>" with "study" and,
 * named after the comparison, "result-global". A study that is there is registered again as it is;
 * a result of that name must not be there. Empty: nothing is kept. Throws InputError where the
 * study cannot be made; DeviceError, Interrupted.
 */
MAMMORAYEVIDENCE_EXPORT StudyRun RunStudy(const EvidenceStudy& study, const std::string& keepIn,
  const ProgressCallback& progress = {});
}

#endif
