// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelField_h
#define mammoray_LabelField_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * Material at any point of a voxel volume, with smooth interfaces: the indicator of every material
 * is blurred by a Gaussian, interpolated linearly between voxel centres, and the largest wins (of
 * equals the lowest index). At the voxel centres the voxel's own material wins always, so thin
 * layers and small parts are not blurred away.
 *
 * Points are in the *grid frame*: (i Spacing[0], j Spacing[1], k Spacing[2]) for continuous index
 * (i, j, k). Outside the volume is air; give it a margin of air, so that all tissue is closed
 * within.
 */
class MAMMORAYMESHING_EXPORT LabelField
{
public:
  LabelField(const LabelVolume& volume, double smoothingVoxels);
  int MaterialAt(double x, double y, double z) const;

private:
  void Balance(const std::vector<std::int32_t>& place);
  /// The material with the largest weight between eight voxels.
  int Blend(const std::int32_t (&rows)[8], const float (&fraction)[3]) const;

  const LabelVolume& Volume;
  /// The materials that occur, ascending.
  std::vector<int> Materials;
  /// Row of Weights for voxels near an interface; -1 - (place in Materials) elsewhere.
  std::vector<std::int32_t> Row;
  /// Materials.size() weights per row; the last rows are those of voxels of one material only.
  std::vector<float> Weights;
  std::int32_t FirstUnitRow = 0;
};
}

#endif
