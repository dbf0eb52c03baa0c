// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SimulationShape_h
#define mammoray_SimulationShape_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammorayMeshingModule.h"

#include <vector>

namespace mammoray
{
/// The tissue of a volume without what is smaller than a cell.
struct SimulationShape
{
  /// What moves.
  static constexpr std::uint16_t Moving = 1;
  /// What is held, as deep as a cell.
  static constexpr std::uint16_t Held = 2;

  /// Cubic voxels on the volume's axes with a margin of air.
  LabelVolume Tissue;
  /// What the volume has of tissue that is not held in front of the border to the held tissue.
  double MovingMm3 = 0;
};

/**
 * The shape that cells with edges of `edgeMm` can follow.
 *
 * - Outline: tissue without holes, closed and opened with balls of a third of an edge (folds, flaps
 *   and corners cut by the field of view go; smaller balls where that takes more than a tenth of
 *   the tissue), the largest piece of it, its signed distance blurred over a quarter of an edge and
 *   its volume kept.
 * - Border to the held tissue: pockets into which no ball of one and a half edges fits (streaks and
 *   islands of fat between muscles) and layers thinner than half an edge are held with what they
 *   lie on, held tissue apart from its largest piece moves; the border is the surface as far from
 *   the one as from the other, blurred likewise: one sheet.
 * - Behind it held tissue is left as deep as an edge, since every point there stays where it is,
 *   and added where it is thinner.
 *
 * `held[m]`: whether material m does not move. Throws InputError where there is no tissue or none
 * that moves.
 */
MAMMORAYMESHING_EXPORT SimulationShape ShapeForCells(const LabelVolume& materials,
  const std::vector<bool>& held, double edgeMm);
}

#endif
