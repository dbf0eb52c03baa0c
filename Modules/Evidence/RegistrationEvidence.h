// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationEvidence_h
#define mammoray_RegistrationEvidence_h

#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/Evidence/StudyEvidence.h"
#include "mammoray/Evidence/TwinExperiment.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammorayEvidenceModule.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A label volume of a breast to experiment with.
struct EvidencePhantom
{
  std::string Name;
  LabelSource Labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
};

/// A real mammogram and the phantom it is registered to for want of its own volume: a wrong pair.
struct EvidenceMammogram
{
  std::string Name;
  RegistrationCase Case;
};

/// A registration whose truth is known at landmarks.
struct EvidenceLandmarks
{
  /// Whose compression it is, and what the model is told of it.
  std::string Name;
  RegistrationCase Case;
  std::string Landmarks;
  LandmarkTruth Truth;
  /// The compressed breast in the frame of the truth, of the same labels as Case; without a path no
  /// overlap is measured. Its origin if its header gives another.
  LabelSource CompressedLabels;
  std::optional<Vector3> CompressedOrigin;
};

struct EvidenceOptions
{
  std::vector<EvidencePhantom> Phantoms;
  /// Of all phantoms.
  std::string Materials = "victre";
  std::string Orientation = "ALS";
  std::vector<TwinKind> Kinds{ RightTwins.begin(), RightTwins.end() };
  /// Truths of each kind and phantom, and truths of each phantom with which searches are compared.
  int Twins = 20;
  int SearchTwins = 2;
  TwinOptions Twin;
  std::vector<EvidenceLandmarks> Landmarks;
  std::vector<EvidenceMammogram> Mammograms;
  std::vector<EvidenceStudy> Studies;
  /// RunStudy's keepIn.
  std::string KeepStudiesIn;
};

struct LandmarkEvidence
{
  /// EvidenceLandmarks::Name.
  std::string Name;
  /// At the imaged landmarks, of the identity, the best rigid motion and the registration.
  std::vector<LandmarkSummary> Rows;
  /// Dice's coefficient of gland in the picture, counted in cubes of 0.8 mm: registered, and at
  /// rest; NaN where not measured.
  double GlandDice = 0;
  double GlandDiceAtRest = 0;
  /// "good", "doubtful" or "none", and the error in 3D in the middle that the report tells one to
  /// expect, mm; NaN where it tells none.
  std::string Trust;
  double ExpectedMedianMm = 0;
  /// Why Trust is no better, one sentence each.
  std::vector<std::string> Reasons;
  int Iterations = 0;
  int Equilibria = 0;
  double Seconds = 0;
};

struct MammogramEvidence
{
  std::string Name;
  double MeanOutlineMm = 0;
  double LargestOutlineMm = 0;
  double Correlation = 0;
  /// Similarity::TissueCorrelation.
  double TissueCorrelation = 0;
  /// "good", "doubtful" or "none": what the report says of it.
  std::string Trust;
  /// Why Trust is no better, one sentence each.
  std::vector<std::string> Reasons;
  double Seconds = 0;
  /// Empty, or why there is no result.
  std::string Failure;
};

struct MAMMORAYEVIDENCE_EXPORT RegistrationEvidence
{
  std::vector<TwinRun> Twins;
  std::vector<LandmarkEvidence> Landmarks;
  std::vector<MammogramEvidence> Mammograms;
  std::vector<StudyRun> Studies;

  /// The run of this phantom, kind, search and number; null where there is none yet.
  const TwinRun* Find(const std::string& phantom, const std::string& kind,
    const std::string& search, int number) const;
};

/**
 * Runs what `evidence` does not hold yet and calls `keep` after each run. Runs are in the order of
 * their numbers, so that an interrupted one holds something of everything. Throws InputError,
 * DeviceError, and Interrupted when stopped.
 */
MAMMORAYEVIDENCE_EXPORT void GatherEvidence(const EvidenceOptions& options,
  RegistrationEvidence& evidence, const std::function<void()>& keep,
  const ProgressCallback& progress = {});

}

#endif
