// SPDX-License-Identifier: Apache-2.0
// What is validated, and the runs that ValidationFile keeps. Each function runs what the file does
// not hold yet and adds each run as soon as it is done. Runs follow in the order of their numbers,
// so that an interrupted validation holds some of everything. They throw InputError, DeviceError,
// and Interrupted when stopped.
#ifndef mammoray_Validation_ValidationRuns_h
#define mammoray_Validation_ValidationRuns_h

#include "StudyRuns.h"
#include "TwinExperiment.h"
#include "ValidationFile.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/RegistrationCase.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A label volume of a breast to experiment with.
struct Phantom
{
  std::string Name;
  LabelSource Labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
};

/// A registration whose truth is known at landmarks.
struct LandmarkCase
{
  std::string Name;
  RegistrationCase Case;
  /// CSV file (ReadLandmarks).
  std::string Landmarks;
  LandmarkTruth Truth;
  /// The compressed breast in the frame of the truth, with the labels of Case; without a path the
  /// overlap of gland is not measured. Its origin, if the one in its header is wrong.
  LabelSource CompressedLabels;
  std::optional<Vector3> CompressedOrigin;
};

/// A real mammogram and the phantom it is registered to because its own volume is unknown: a wrong
/// pair.
struct MammogramCase
{
  std::string Name;
  RegistrationCase Case;
};

/// The phantoms of twin experiments, and what they have in common.
struct TwinPlan
{
  std::vector<mammoray::Phantom> Phantoms;
  std::string Materials = "victre";
  std::string Orientation = "ALS";
  std::vector<TwinKind> Kinds{ RightTwins.begin(), RightTwins.end() };
  /// Truths of each kind and phantom.
  int Count = 20;
  TwinOptions Options;
};

/// The settings that two twin validations must share to be one file: phantoms by their checksums,
/// and what is asked of the twins but for kinds and counts. Throws InputError if a phantom cannot
/// be read.
nlohmann::json SettingsOf(const TwinPlan& plan);

/// Registers twins and wrong pairs.
void RunTwins(const TwinPlan& plan, ValidationFile& file, const ProgressCallback& progress = {});

/// Compares searches on plain twins; annealing may solve as many equilibria as the search before
/// it.
void CompareSearches(const TwinPlan& plan, ValidationFile& file,
  const ProgressCallback& progress = {});

/// Errors at the imaged landmarks of the identity, the best rigid motion and the registration, and
/// the overlap of gland (Dice).
void RunLandmarks(const std::vector<LandmarkCase>& cases, ValidationFile& file,
  const ProgressCallback& progress = {});

void RunMammograms(const std::vector<MammogramCase>& cases, ValidationFile& file,
  const ProgressCallback& progress = {});

/// `keepIn`: see RunStudy.
void RunStudies(const std::vector<PlannedStudy>& studies, const std::string& keepIn,
  ValidationFile& file, const ProgressCallback& progress = {});
}

#endif
