// SPDX-License-Identifier: Apache-2.0
// What is validated: the project's own data, and `publicData`, a folder of public data (see
// Data/README.md) with breastphantom-scattered-1001, breastphantom-hetero-2002, digibreast,
// monai-mammograms, victre-pipeline-phantom-1 and MRI of patients.
#ifndef mammoray_Validation_ValidationCases_h
#define mammoray_Validation_ValidationCases_h

#include "PatientRuns.h"
#include "ValidationRuns.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Three phantoms of different build; finer ones are resampled to voxels of `spacingMm`.
std::vector<Phantom> ValidationPhantoms(const std::string& publicData, double spacingMm);

/**
 * Mammograms of compressions by other programs, with landmarks: the FDA's phantom 1 (CC, FEBio;
 * Data/victre-phantom-1), with its compressed labels if the public data has them; and phantom
 * scattered-1001 (MLO, CalculiX; Data/scattered-1001-mlo), whose gland is twice as stiff as in the
 * table, once with its true stiffness and once with the table's. Throws InputError if the project's
 * data is damaged.
 */
std::vector<LandmarkCase> ValidationLandmarks(const std::string& publicData);

/// Virtual studies 1 to `count` of several anatomies in turn: the phantoms and, if the public data
/// has them, the breasts of three patients' MRI. The number is the study's seed; sides alternate.
std::vector<PlannedStudy> ValidationStudies(const std::vector<Phantom>& phantoms,
  const std::string& publicData, int count);

/// Patients whose MRI the public data has: the fat-suppressed series of uta11's, named as their
/// folders, and duke-153. `drawn` has their drawn slices, NAME.json.
std::vector<Patient> ValidationPatients(const std::string& publicData, const std::string& drawn);

/// Six real mammograms, one of them in both forms of storage, each with each of the phantoms: their
/// own volumes are not known, so that no match may be trusted.
std::vector<MammogramCase> ValidationMammograms(const std::vector<Phantom>& phantoms,
  const std::string& publicData);
}

#endif
