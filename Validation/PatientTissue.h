// SPDX-License-Identifier: Apache-2.0
// Turns a phantom into a part of a patient: places it at its side of the chest, moves it with a
// simulated deformation, and joins it to a body.
#ifndef mammoray_Validation_PatientTissue_h
#define mammoray_Validation_PatientTissue_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"

#include <functional>
#include <vector>

namespace mammoray
{
/// Tissues with different signals in MRI.
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

/// The front of the chest in DICOM LPS: y = FrontMm + x^2 / (2 RadiusMm). A rib cage is about 150
/// mm deep, 300 mm wide and flatter in front.
struct ChestCurve
{
  double FrontMm = 0;
  double RadiusMm = 500;

  double At(double x) const { return this->FrontMm + x * x / (2 * this->RadiusMm); }
};

/// Distance of the phantom's middle from the patient's midline, mm, at which two of them lie beside
/// each other.
double OffMidlineMm(const LabelVolume& materials, const AnatomicalAxes& axes);

/**
 * The phantom in DICOM LPS on a grid along its axes, its posterior face on the curve, `offMm` to
 * the patient's left or right of the midline (side 'L' or 'R'). A phantom whose chest wall (held
 * tissue) comes forwards on the lateral side belongs to the other side and is mirrored.
 */
LabelVolume PlaceOnChest(const LabelVolume& materials, const MaterialTable& table,
  const AnatomicalAxes& axes, char side, double offMm, const ChestCurve& curve);

/**
 * Gives a patient's breast that a segmentation cut off at a coronal plane something to hang on, as
 * phantoms have: held tissue (the first held material), 12 mm deep, behind the tissue that ends at
 * the hindmost plane, or in place of it where the volume ends. `materials`: indices, 0 = air, DICOM
 * LPS.
 */
void HoldCutTissue(LabelVolume& materials, const std::vector<bool>& held);

/**
 * A breast coil squeezes a large breast from both sides: 50 to 65 mm wide and 170 to 190 mm high in
 * uta11-b. What is squeezed across becomes longer along the body and to the front alike. A
 * stress-free breast is about as wide as high, so the tissue is stretched to the sides until the
 * standard deviations of what is not held are alike, at most by 1.8, and shrunk in the other two
 * directions at an unchanged volume. `breast`: indices, 0 = air, DICOM LPS.
 */
LabelVolume FreeOfCoil(LabelVolume breast, const std::vector<bool>& held);

/**
 * Takes the chest's own shape out of a patient's breast, which PlaceOnChest bends: tissue is moved
 * along the body's depth until the surface of second order through the front of the held tissue is
 * a coronal plane. What lies more than 20 mm behind that plane becomes air. `materials`: indices, 0
 * = air, DICOM LPS. Returns the same volume if too little is held to say.
 */
LabelVolume FlattenChest(const LabelVolume& materials, const std::vector<bool>& held);

/**
 * Continues a breast that was cut out of a body: for `reachMm` to the sides, head and feet there is
 * a chest wall, which falls from the phantom's front of it to a thickness of `wallMm`, and tissue
 * falls off from the phantom's edge to 8 mm of subcutaneous fat without skin (AddSkin adds it).
 * Skin of the phantom that becomes covered turns into fat. `placed`: see PlaceOnChest. Returns the
 * same volume if the table has no fat or nothing held.
 */
LabelVolume SurroundByChest(const LabelVolume& placed, const MaterialTable& table,
  const ChestCurve& curve, double wallMm, double reachMm);

/// Maps points, 3 x pointCount, mm, to their new positions.
using PointMotion = std::function<std::vector<double>(const std::vector<double>&)>;

/**
 * The moved label volume on `grid`: each voxel has the label of the point that moved there, or 0.
 * The motion is evaluated at the corners of cubes of 4 mm around the tissue and is linear in the
 * six tetrahedra of each. Throws Interrupted.
 */
LabelVolume MoveLabels(const LabelVolume& labels, const PointMotion& motion, const VolumeGrid& grid,
  const ProgressCallback& progress = {});

/// The tissue of each material.
std::vector<Tissue> TissuesOf(const MaterialTable& table);

/**
 * The patient: tissues on the grid of `breast` (material indices, DICOM LPS, symmetric about x = 0
 * if `both`), with a mirrored breast on the other side if `both`, and skin, fat, chest wall
 * (`wallMm` thick in front of the curve, and pectoral muscle behind it), ribs and lung.
 */
LabelVolume JoinBody(const LabelVolume& breast, const std::vector<Tissue>& tissues,
  const ChestCurve& curve, double wallMm, bool both);

/// Extent of the tissue that is not held along a direction, between the centres of its voxels, mm.
double HeightMm(const LabelVolume& materials, const std::vector<bool>& held, const Vector3& axis);

/// Mean thickness along the posterior direction of the held tissue, over the columns that have any,
/// mm.
double WallThicknessMm(const LabelVolume& placed, const std::vector<bool>& held);

/// Edge of a cube with the volume of all tissue, mm.
double CubeEdgeMm(const LabelVolume& materials);

/// Meshes the anatomy that is X-rayed: upper bound of the cells, mm; components that are smaller
/// than `smallestMm3` become part of their surroundings. Throws as MeshMaterials.
TetrahedralMesh MeshAnatomy(const LabelVolume& materials, const MaterialTable& table,
  double cellSizeMm, double smallestMm3, const ProgressCallback& progress);
}

#endif
