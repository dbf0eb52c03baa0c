// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SimulationShape_h
#define mammoray_SimulationShape_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayMeshingModule.h"

#include <vector>

namespace mammoray
{
/// The tissue of a volume without details smaller than a cell.
struct SimulationShape
{
  /// Label of moving tissue.
  static constexpr std::uint16_t Moving = 1;
  /// Label of fixed tissue, one cell deep.
  static constexpr std::uint16_t Fixed = 2;

  /// Labels on cubic voxels along the volume's axes, with a margin of air.
  LabelVolume Tissue;
  /// Volume of the tissue that is not fixed and lies in front of the border to the fixed tissue.
  double MovingMm3 = 0;
};

/**
 * Computes the shape that cells with edges of `edgeMm` can follow.
 *
 * - Outline: tissue without holes, closed and opened with balls of a third of an edge, which
 *   removes folds, flaps and corners cut by the field of view. Smaller balls are used if that
 *   removes more than a tenth of the tissue. The largest piece remains; its signed distance is
 *   blurred over a quarter of an edge and its volume is kept.
 * - Border to the fixed tissue: pockets into which no ball of one and a half edges fits (streaks
 *   and islands of fat between muscles) and layers thinner than half an edge become fixed together
 *   with the tissue they lie on. Fixed tissue apart from its largest piece moves. The border is the
 *   surface midway between the two, blurred likewise: one sheet.
 * - Fixed tissue is kept one edge deep behind the border, since every point there stays in place,
 *   and is added where it is thinner.
 *
 * `fixed[m]` is true if material m does not move. Throws InputError if there is no tissue or none
 * that moves.
 */
MAMMORAYMESHING_EXPORT SimulationShape ShapeForCells(const LabelVolume& materials,
  const std::vector<bool>& fixed, double edgeMm);
}

#endif
