// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EvidenceCases_h
#define mammoray_EvidenceCases_h

#include "mammoray/Evidence/RegistrationEvidence.h"
#include "mammorayEvidenceModule.h"

#include <string>
#include <vector>

namespace mammoray
{
// What evidence is gathered on: the project's own data, and a folder of public data, `publicData`
// (see Data/README.md), which holds breastphantom-scattered-1001, breastphantom-hetero-2002,
// digibreast, monai-mammograms and victre-pipeline-phantom-1.

/// Three phantoms of different build, finer ones resampled to voxels of `spacingMm`.
MAMMORAYEVIDENCE_EXPORT std::vector<EvidencePhantom> PhantomsOfEvidence(
  const std::string& publicData, double spacingMm);

/**
 * Mammograms of compressions by others' programs, with landmarks: the FDA's phantom 1 (CC, FEBio;
 * Data/victre-phantom-1), with its compressed labels where the public data holds them; and phantom
 * scattered-1001 (MLO, CalculiX; Data/scattered-1001-mlo), whose gland is twice as stiff as the
 * table says, once with its true stiffness and once with the table's. Throws InputError where the
 * project's data is damaged.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<EvidenceLandmarks> LandmarksOfEvidence(
  const std::string& publicData);

/**
 * So many virtual studies, numbered from 1, of several anatomies in turn: the three phantoms of
 * PhantomsOfEvidence and, where the public data holds them, the breasts of three patients' MRI.
 * The number is the study's seed; sides alternate.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<EvidenceStudy> StudiesOfEvidence(
  const std::vector<EvidencePhantom>& phantoms, const std::string& publicData, int count);

/// Six real mammograms, one of them in both forms of storage; their own volumes are not known and
/// each of the phantoms is registered to each, so that no match may be trusted.
MAMMORAYEVIDENCE_EXPORT std::vector<EvidenceMammogram> MammogramsOfEvidence(
  const std::vector<EvidencePhantom>& phantoms, const std::string& publicData);
}

#endif
