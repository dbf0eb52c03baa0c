// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CutTissue_h
#define mammoray_CutTissue_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayStudyModule.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mammoray
{
/// Where a grid ends: before the first or after the last voxel of an axis.
struct GridSide
{
  std::size_t Axis = 0;
  bool AtEnd = false;
};

/// The names of all: "i-", "i+", "j-", "j+", "k-", "k+".
MAMMORAYSTUDY_EXPORT const std::vector<std::string>& GridSides();
/// Throws InputError on another name.
MAMMORAYSTUDY_EXPORT GridSide FindGridSide(const std::string& name);

/**
 * What of a body was cut off when tissue was taken out of it: the tissue of `whole` that `kept`
 * (the same grid) has not, and beyond the ends `sides` of where `whole` has tissue a layer of 20 mm
 * that goes on as its last voxels do. A thin material there (skin) has grown and was not cut: it
 * goes nowhere. Material indices, 0 elsewhere; on the axes of the volumes, in the same frame.
 * Throws InputError on other sides than GridSides, on grids of two sizes and where `whole` is
 * empty.
 */
MAMMORAYSTUDY_EXPORT LabelVolume CutTissue(const LabelVolume& whole, const LabelVolume& kept,
  const MaterialTable& table, const std::vector<std::string>& sides);

/// Whether a place lies in what was cut off (CutTissue), as simulations ask (BodyField).
MAMMORAYSTUDY_EXPORT BodyField InCutTissue(LabelVolume cut);
/// The same of a volume whose body goes on beyond some sides only; empty where it does at none.
MAMMORAYSTUDY_EXPORT BodyField InCutTissue(const LabelVolume& materials, const MaterialTable& table,
  const std::vector<std::string>& sides);
}

#endif
