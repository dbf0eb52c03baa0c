// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammographyGeometry_h
#define mammoray_MammographyGeometry_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <string>

namespace mammoray
{
/**
 * Anatomical directions of a volume frame: unit vectors towards the patient's left, front and head.
 *
 * The *gantry frame* has its origin where the chest-wall edge of the image receptor meets its
 * midline; +x along that edge (patient left in CC), +y from chest wall to nipple, +z from receptor
 * to source. (left, anterior, superior) is a left-handed triple, so meshes are never stored in the
 * gantry frame: they stay in the volume frame and the mammography unit is placed around them.
 */
struct MAMMORAYFOUNDATION_EXPORT AnatomicalAxes
{
  Vector3 Left{ 1, 0, 0 };
  Vector3 Anterior{ 0, -1, 0 };
  Vector3 Superior{ 0, 0, 1 };

  /**
   * From the directions of +x, +y and +z as three letters of L/R, A/P, S/I: "LPS" (DICOM, the
   * default), "RAS", or "ALS" for the FDA phantoms. Throws InputError on anything else.
   */
  static AnatomicalAxes FromCode(const std::string& code);
};

/// The mammography unit: what the DICOM header says and what is fixed by its construction; mm.
struct MammographyUnit
{
  /// Focal spot to image receptor plane; positive.
  double SourceToDetectorMm = 650.0;
  /// x and y of the focal spot in the gantry frame: over the middle of the chest-wall edge, but for
  /// the projections of a tomosynthesis.
  std::array<double, 2> FocalSpotMm{ 0, 0 };
  /// Height of the breast support's upper face above the image receptor plane; not negative.
  double SupportHeightMm = 2.0;
  /// y of the plates' chest-wall edges in the gantry frame.
  double SupportEdgeMm = 0.0;
  double PaddleEdgeMm = 0.0;
  /// Radius of the plates' chest-wall edges.
  double EdgeRadiusMm = 3.0;

  /// The focal spot, gantry frame.
  Vector3 FocalSpot() const
  {
    return { this->FocalSpotMm[0], this->FocalSpotMm[1], this->SourceToDetectorMm };
  }
};

/// The same unit with its focal spot elsewhere, gantry frame, mm.
inline MammographyUnit WithFocalSpot(MammographyUnit unit, const Vector3& spot)
{
  unit.FocalSpotMm = { spot[0], spot[1] };
  unit.SourceToDetectorMm = spot[2];
  return unit;
}

/// The parameters of BreastPose, in the order in which their values are kept (see
/// PoseParameters.h).
enum PoseParameterIndex : int
{
  ThicknessParameter,
  RollParameter,
  PitchParameter,
  YawParameter,
  LateralParameter,
  AnteriorParameter,
  VerticalParameter,
  TiltParameter,
  StiffnessParameter,
  ParameterCount
};

/**
 * How a breast lies in the unit: where the unit stands relative to the breast, how far it is
 * closed, and how stiff the breast's gland is. With the default values, a CC view with the plates'
 * middle on the breast's middle and the receptor's edge at the chest wall.
 */
struct BreastPose
{
  /// Distance between the faces of support and paddle, mm; positive.
  double ThicknessMm = 50.0;
  /**
   * Rotation of the unit about the anterior axis through the anchor, degrees: 0 is CC, a positive
   * angle turns the source from above the patient towards the patient's left.
   */
  double RollDeg = 0.0;
  /// Rotation of the rolled unit about its lateral axis (gantry x) through the anchor, degrees:
  /// positive turns the source to the front.
  double PitchDeg = 0.0;
  /// Rotation of the rolled and pitched unit about its vertical axis (gantry z) through the anchor,
  /// degrees: positive turns its anterior direction towards the patient's left (CC).
  double YawDeg = 0.0;
  /// Shift of the receptor along gantry +x relative to the anchor, mm.
  double LateralMm = 0.0;
  /// Shift of the receptor along gantry +y (away from the chest wall) relative to the anchor, mm.
  double AnteriorMm = 0.0;
  /// Shift of the plates' mid-plane along gantry +z relative to the anchor, mm.
  double VerticalMm = 0.0;
  /// Turn of the paddle about its chest-wall edge, degrees; positive opens it towards the nipple.
  double TiltDeg = 0.0;
  /// Factor on Young's modulus of gland; positive. Moves nothing of the unit.
  double Stiffness = 1.0;
};

/// volumePoint = Origin + x * X + y * Y + z * Z for a gantry point (x, y, z); X, Y, Z orthonormal.
struct MAMMORAYFOUNDATION_EXPORT VolumeFromGantry
{
  Vector3 Origin{ 0, 0, 0 };
  Vector3 X{ 1, 0, 0 };
  Vector3 Y{ 0, 1, 0 };
  Vector3 Z{ 0, 0, 1 };

  Vector3 Point(const Vector3& gantry) const
  {
    return this->Origin + gantry[0] * this->X + gantry[1] * this->Y + gantry[2] * this->Z;
  }
  Vector3 Direction(const Vector3& gantry) const
  {
    return gantry[0] * this->X + gantry[1] * this->Y + gantry[2] * this->Z;
  }
  /// The inverse: a point of the volume frame in the gantry frame.
  Vector3 ToGantry(const Vector3& volumePoint) const
  {
    const Vector3 offset = volumePoint - this->Origin;
    return { Dot(offset, this->X), Dot(offset, this->Y), Dot(offset, this->Z) };
  }
};

/**
 * The point of the volume frame the pose refers to: the middle of the breast's bounding box across
 * and along the body, at the front of the held tissue (chest wall) behind it, or at the tissue's
 * posterior end where no material is held. The breast is what rises highest over the body, without
 * belly, armpit and flat tissue (Private/BreastColumns.h). `held[m]`: whether material m is held.
 */
MAMMORAYFOUNDATION_EXPORT Vector3 FindPoseAnchor(const LabelVolume& materials,
  const std::vector<bool>& held, const AnatomicalAxes& axes);

/// The same of a mesh, by the corners of its cells: as exact as the mesh follows the volume.
MAMMORAYFOUNDATION_EXPORT Vector3 FindPoseAnchor(const TetrahedralMesh& mesh,
  const std::vector<bool>& held, const AnatomicalAxes& axes);

/// The volume with air in place of all that is not the breast in the sense of FindPoseAnchor and
/// what lies behind it. Throws InputError on a volume of air.
MAMMORAYFOUNDATION_EXPORT LabelVolume KeepBreast(const LabelVolume& materials,
  const std::vector<bool>& held, const AnatomicalAxes& axes);

/// Places the unit: support face at z = SupportHeightMm, paddle face ThicknessMm above it.
MAMMORAYFOUNDATION_EXPORT VolumeFromGantry PlaceUnit(const AnatomicalAxes& axes,
  const Vector3& anchor, const MammographyUnit& unit, const BreastPose& pose);

/// How the unit moves with a parameter of the pose, per mm or degree of it; volume frame, mm and
/// radians.
struct UnitVelocity
{
  /// The whole unit shifts so, and turns so about the anchor.
  Vector3 Shift{ 0, 0, 0 };
  Vector3 Turn{ 0, 0, 0 };
  /// So the paddle shifts beside the rest of the unit, and turns about its chest-wall edge.
  Vector3 PaddleShift{ 0, 0, 0 };
  Vector3 PaddleTurn{ 0, 0, 0 };
};

/// The rates of what PlaceUnit and the paddle do with each parameter, in their order; none with the
/// stiffness.
MAMMORAYFOUNDATION_EXPORT std::array<UnitVelocity, ParameterCount> UnitVelocities(
  const AnatomicalAxes& axes, const Vector3& anchor, const MammographyUnit& unit,
  const BreastPose& pose);
}

#endif
