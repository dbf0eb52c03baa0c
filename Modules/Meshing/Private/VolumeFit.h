// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VolumeFit_h
#define mammoray_VolumeFit_h

#include "Private/EditableMesh.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayMeshingModule.h"

#include <map>

namespace mammoray
{
/**
 * Moves the interfaces so that every material gets its target volume (mm^3, by material; air takes
 * the rest). The interface of materials a and b moves along its normal by o_a - o_b, with one
 * offset o per material, found by Newton steps on the volumes (their gradient with respect to a
 * point is a third of the area normals around it). No point moves by more than `shiftMm` in total,
 * or so far that a cell around it gets a dihedral angle below `leastDeg` that it did not have.
 */
MAMMORAYMESHING_EXPORT void FitVolumes(EditableMesh& mesh,
  const std::map<std::int32_t, double>& volumesMm3, double shiftMm, double leastDeg,
  const ProgressCallback& progress);
}

#endif
