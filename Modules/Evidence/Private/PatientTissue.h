// SPDX-License-Identifier: Apache-2.0
// A phantom becomes a part of a patient: placed at its side of the chest, moved as a simulation
// says, and joined to a body.
#ifndef mammoray_Private_PatientTissue_h
#define mammoray_Private_PatientTissue_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayEvidenceModule.h"

#include <functional>
#include <vector>

namespace mammoray
{
/// What an MRI tells apart.
enum class Tissue : std::uint16_t
{
  Air,
  Fat,
  Gland,
  Skin,
  Muscle,
  Bone,
  Lung
};
inline constexpr std::size_t TissueCount = 7;

/// The front of the chest, DICOM LPS: y = FrontMm + x^2 / (2 RadiusMm). A rib cage is about 150 mm
/// deep and 300 mm wide, flatter in front.
struct ChestCurve
{
  double FrontMm = 0;
  double RadiusMm = 500;

  double At(double x) const { return this->FrontMm + x * x / (2 * this->RadiusMm); }
};

/// Distance of the phantom's middle from the patient's, mm: so that two of them lie beside each
/// other.
MAMMORAYEVIDENCE_EXPORT double OffMidlineMm(const LabelVolume& materials,
  const AnatomicalAxes& axes);

/**
 * The phantom in DICOM LPS, on a grid along its axes, its posterior face on the curve, `offMm` to
 * the patient's left or right of the middle (side 'L' or 'R'). A phantom whose chest wall (held
 * tissue) comes forwards on the lateral side is one of the other breast and is mirrored.
 */
MAMMORAYEVIDENCE_EXPORT LabelVolume PlaceOnChest(const LabelVolume& materials,
  const MaterialTable& table, const AnatomicalAxes& axes, char side, double offMm,
  const ChestCurve& curve);

/**
 * A patient's breast that a segmentation cut off at a coronal plane gets something to hang on to,
 * as a phantom has it: held tissue (the first held material), 12 mm deep, behind what ends at the
 * hindmost plane, or in place of it where the volume ends. `materials`: indices, 0 = air, DICOM
 * LPS.
 */
MAMMORAYEVIDENCE_EXPORT void HoldCutTissue(LabelVolume& materials, const std::vector<bool>& held);

/**
 * What was cut out of a body goes on beside it: `reachMm` farther to the sides, head and feet on a
 * chest wall as thick as the phantom's (`wallMm`), tissue falls off from the edge of the phantom to
 * subcutaneous fat of 8 mm, without skin (AddSkin gives it). Skin of the phantom that this buries
 * becomes fat. `placed` as PlaceOnChest gives it. The same volume where the table has no fat or
 * nothing held.
 */
MAMMORAYEVIDENCE_EXPORT LabelVolume SurroundByChest(const LabelVolume& placed,
  const MaterialTable& table, const ChestCurve& curve, double wallMm, double reachMm);

/// Takes points, 3 x pointCount, mm, to their new places.
using PointMotion = std::function<std::vector<double>(const std::vector<double>&)>;

/**
 * A label volume moved: on `grid`, each voxel with the label at the place that came to lie there, 0
 * where none did. The motion is taken at the corners of cubes of 4 mm around the tissue and is
 * linear in the six tetrahedra of each. Throws Interrupted.
 */
MAMMORAYEVIDENCE_EXPORT LabelVolume MoveLabels(const LabelVolume& labels, const PointMotion& motion,
  const VolumeGrid& grid, const ProgressCallback& progress = {});

/// The tissue of each material.
MAMMORAYEVIDENCE_EXPORT std::vector<Tissue> TissuesOf(const MaterialTable& table);

/**
 * The patient: tissues on the grid of `breast` (materials, DICOM LPS, symmetric about x = 0 where
 * `both`), with the breast mirrored to the other side if `both`, and skin, fat, chest wall
 * (`wallMm` thick in front of the curve, and pectoral muscle behind it), ribs and lung.
 */
MAMMORAYEVIDENCE_EXPORT LabelVolume JoinBody(const LabelVolume& breast,
  const std::vector<Tissue>& tissues, const ChestCurve& curve, double wallMm, bool both);

/// Height of what is not held along a direction, mm, between the middles of its voxels.
double HeightMm(const LabelVolume& materials, const std::vector<bool>& held, const Vector3& axis);

/// Mean thickness of the held tissue where there is any, along the posterior direction, mm.
double WallThicknessMm(const LabelVolume& placed, const std::vector<bool>& held);
}

#endif
