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
  /// Columns of Weights that are added up at once.
  static constexpr std::size_t Lanes = 4;
  /// A voxel whose row of Weights is balanced, and a point in it.
  struct Sample
  {
    std::size_t Voxel;
    Vector3 Point;
  };
  /// Points spread over the voxels near interfaces by three irrational steps; those in voxels with
  /// a row.
  std::vector<Sample> Samples(const std::vector<char>& near) const;
  void Balance(const std::vector<std::int32_t>& place, const std::vector<char>& near);
  /// The material with the largest weight between eight voxels, pairs along i that begin at the
  /// corners.
  int Blend(const std::size_t (&corners)[4], const float (&fraction)[3]) const;

  const LabelVolume& Volume;
  /// The materials that occur, ascending.
  std::vector<int> Materials;
  /// Row of Weights for voxels that touch one of another material; -1 elsewhere.
  std::vector<std::int32_t> Row;
  /// Materials.size() weights per row, and Lanes more at the end.
  std::vector<float> Weights;
};
}

#endif
