// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LabelField_h
#define mammoray_LabelField_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayMeshingModule.h"

namespace mammoray
{
/**
 * The material at any point of a voxel volume, with smooth interfaces. The indicator of every
 * material is blurred by a Gaussian and interpolated linearly between voxel centres; the largest
 * value wins, and the lowest index wins a tie. At voxel centres the voxel's own material always
 * wins, so that thin layers and small parts are not blurred away.
 *
 * Points are in the *grid frame*: (i Spacing[0], j Spacing[1], k Spacing[2]) for the continuous
 * index (i, j, k). Outside the volume is air. The volume needs a margin of air, so that all tissue
 * is closed within it.
 */
class MAMMORAYMESHING_EXPORT LabelField
{
public:
  LabelField(const LabelVolume& volume, double smoothingVoxels);
  int MaterialAt(double x, double y, double z) const;

private:
  /// Number of columns of Weights that are summed together.
  static constexpr std::size_t Lanes = 4;
  /// A voxel whose row of Weights is balanced, and a point in it.
  struct Sample
  {
    std::size_t Voxel;
    Vector3 Point;
  };
  /// Quasi-random points (three irrational steps) in those voxels near interfaces that have a row.
  std::vector<Sample> Samples(const std::vector<char>& near) const;
  void Balance(const std::vector<std::int32_t>& place, const std::vector<char>& near);
  /// The material with the largest weight between eight voxels, given as four pairs along i that
  /// begin at the corners.
  int Blend(const std::size_t (&corners)[4], const float (&fraction)[3]) const;

  const LabelVolume& Volume;
  /// Materials that occur, ascending.
  std::vector<int> Materials;
  /// Row of Weights of voxels that touch another material; -1 elsewhere.
  std::vector<std::int32_t> Row;
  /// Materials.size() weights per row, and Lanes more at the end.
  std::vector<float> Weights;
};
}

#endif
