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
// digibreast and victre-pipeline-phantom-1.

/// Three phantoms of different build, finer ones resampled to voxels of `spacingMm`.
MAMMORAYEVIDENCE_EXPORT std::vector<EvidencePhantom> PhantomsOfEvidence(
  const std::string& publicData, double spacingMm);

/**
 * The FDA's phantom 1, the mammogram of its own compression, and landmarks in both
 * (Data/victre-phantom-1). With its compressed labels where the public data holds them. Throws
 * InputError where the project's data is damaged.
 */
MAMMORAYEVIDENCE_EXPORT EvidenceLandmarks LandmarksOfEvidence(const std::string& publicData);

/**
 * So many virtual studies, numbered from 1, of several anatomies in turn: the three phantoms of
 * PhantomsOfEvidence and, where the public data holds them, the breasts of three patients' MRI.
 * The number is the study's seed; sides alternate.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<EvidenceStudy> StudiesOfEvidence(
  const std::vector<EvidencePhantom>& phantoms, const std::string& publicData, int count);

/// A real mammogram in both forms of storage; its own volume is not known and another breast is
/// registered to it, so that no match may be trusted.
MAMMORAYEVIDENCE_EXPORT std::vector<EvidenceMammogram> MammogramsOfEvidence(
  const std::string& publicData);
}

#endif
