// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_StudyRuns_h
#define mammoray_Validation_StudyRuns_h

#include "VirtualStudy.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammoray/Study/LabelSource.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace mammoray
{
/// A virtual study to make and to register.
struct PlannedStudy
{
  /// Name of the anatomy.
  std::string Phantom;
  /// A folder with an MRI, whose breast on the study's side is segmented and taken as stress-free;
  /// empty: Labels.
  std::string Mri;
  LabelSource Labels;
  std::string Materials = "victre";
  std::string Orientation = "ALS";
  VirtualStudyOptions Options;
  /// Of the registration: how pictures are compared, and in which pixels.
  RegistrationOptions Registration;
};

/// Makes a virtual study (MakeVirtualStudy) in a folder that does not exist or is empty. A breast
/// of a patient's MRI is segmented first and stretched, as its coil had squeezed it.
StudyTruth MakePlannedStudy(const PlannedStudy& study, const std::string& folder,
  const ProgressCallback& progress = {});

/**
 * Makes a virtual study, registers it like 'mammoray register --study' with only the comparison
 * options given, and gives what ValidationFile keeps: the errors of each view (ScoreResult), the
 * share of coordinates within two standard deviations, similarity, expected error and trust; the
 * errors of points found in the MRI from both shadows, and from that in CC alone; of a study with
 * projections also the views of CC alone and of all projections. A refusal or a failed search is a
 * result, too ("failure").
 *
 * `keepIn`: a folder, made if missing, that keeps "<phantom>-<seed>" with "study" and, named after
 * the comparison, for example "result-global". An existing study is registered again as it is; a
 * result of that name must not exist. Empty: nothing is kept. Throws InputError if the study cannot
 * be made; DeviceError, Interrupted.
 */
nlohmann::json RunStudy(const PlannedStudy& study, const std::string& keepIn,
  const ProgressCallback& progress = {});
}

#endif
