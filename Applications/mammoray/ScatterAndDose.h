// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterAndDose_h
#define mammoray_ScatterAndDose_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Scatter/MonteCarlo.h"

#include <memory>
#include <string>

namespace mammoray
{
/// The materials of a surface in voxels. Throws InputError where it is not closed, and where this
/// build has no Meshing module.
std::shared_ptr<const VoxelScene> MakeVoxelScene(double voxelMm, const SurfaceMesh& surface,
  const MaterialTable& materials, const ProgressCallback& progress);

/// Lines for people: the mean dose of each material by the air kerma, and in mGy where it is known
/// how many photons meet a pixel.
std::string DescribeDose(const Dose& dose, const MaterialTable& materials, double photonsPerPixel);
}

#endif
