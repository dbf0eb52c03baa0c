// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammographyGeometry_h
#define mammoray_MammographyGeometry_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <optional>
#include <string>

namespace mammoray
{
/**
 * Anatomical directions of a volume frame: unit vectors towards the patient's left, front and head.
 *
 * The *gantry frame* has its origin where the chest-wall edge of the image receptor meets its
 * midline; +x runs along that edge (patient left in CC), +y from chest wall to nipple, +z from
 * receptor to source. (left, anterior, superior) is a left-handed triple. Meshes therefore stay in
 * the volume frame, and the mammography unit is placed around them.
 */
struct MAMMORAYFOUNDATION_EXPORT AnatomicalAxes
{
  Vector3 Left{ 1, 0, 0 };
  Vector3 Anterior{ 0, -1, 0 };
  Vector3 Superior{ 0, 0, 1 };

  /// Converts three letters of L/R, A/P, S/I for the directions of +x, +y and +z: "LPS" (DICOM, the
  /// default), "RAS", or "ALS" for the FDA phantoms. Throws InputError on anything else.
  static AnatomicalAxes FromCode(const std::string& code);

  bool operator==(const AnatomicalAxes&) const = default;
};

/// Dimensions of the mammography unit, from the DICOM header or its construction; mm.
struct MammographyUnit
{
  /// Distance from focal spot to image receptor plane; positive.
  double SourceToDetectorMm = 650.0;
  /// x and y of the focal spot in the gantry frame. It lies above the middle of the chest-wall
  /// edge, except for projections of a tomosynthesis.
  std::array<double, 2> FocalSpotMm{ 0, 0 };
  /// Height of the breast support's upper face above the image receptor plane; not negative.
  double SupportHeightMm = 2.0;
  /// y of the plates' chest-wall edges in the gantry frame.
  double SupportEdgeMm = 0.0;
  double PaddleEdgeMm = 0.0;
  /// Radius of the plates' chest-wall edges.
  double EdgeRadiusMm = 3.0;

  /// Position of the focal spot in the gantry frame.
  Vector3 FocalSpot() const
  {
    return { this->FocalSpotMm[0], this->FocalSpotMm[1], this->SourceToDetectorMm };
  }
};

/// Returns the unit with its focal spot at another position of the gantry frame, mm.
inline MammographyUnit WithFocalSpot(MammographyUnit unit, const Vector3& spot)
{
  unit.FocalSpotMm = { spot[0], spot[1] };
  unit.SourceToDetectorMm = spot[2];
  return unit;
}

/// Indices of the parameters of BreastPose in vectors of values (see PoseParameters.h).
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

/// The position of the breast in the unit: where the unit stands relative to the breast, how far it
/// is closed, and how stiff the breast's gland is. The default is a CC view with the plates centred
/// on the breast and the receptor's edge at the chest wall.
struct BreastPose
{
  /// Distance between the faces of support and paddle, mm; positive.
  double ThicknessMm = 50.0;
  /// Rotation of the unit about the anterior axis through the anchor, degrees. 0 is CC; a positive
  /// angle turns the source from above the patient towards the patient's left.
  double RollDeg = 0.0;
  /// Rotation of the rolled unit about its lateral axis (gantry x) through the anchor, degrees. A
  /// positive angle turns the source to the front.
  double PitchDeg = 0.0;
  /// Rotation of the rolled and pitched unit about its vertical axis (gantry z) through the anchor,
  /// degrees. A positive angle turns its anterior direction towards the patient's left (in CC).
  double YawDeg = 0.0;
  /// Shift of the receptor along gantry +x relative to the anchor, mm.
  double LateralMm = 0.0;
  /// Shift of the receptor along gantry +y (away from the chest wall) relative to the anchor, mm.
  double AnteriorMm = 0.0;
  /// Shift of the plates' mid-plane along gantry +z relative to the anchor, mm.
  double VerticalMm = 0.0;
  /// Rotation of the paddle about its chest-wall edge, degrees; a positive tilt opens it towards
  /// the nipple.
  double TiltDeg = 0.0;
  /// Factor on Young's modulus of gland; positive. It does not move the unit.
  double Stiffness = 1.0;
};

/// Rigid transform from the gantry frame to the volume frame: volumePoint = Origin + x * X + y * Y
/// + z * Z for a gantry point (x, y, z); X, Y, Z are orthonormal.
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
  /// Inverse transform of a point.
  Vector3 ToGantry(const Vector3& volumePoint) const
  {
    const Vector3 offset = volumePoint - this->Origin;
    return { Dot(offset, this->X), Dot(offset, this->Y), Dot(offset, this->Z) };
  }
};

/// The frame of a pose, in volume coordinates: the axes of the unit before its rotations, and the
/// point about which it rotates.
struct PoseFrame
{
  AnatomicalAxes Axes;
  Vector3 Anchor{ 0, 0, 0 };
};

/**
 * The frame of a breast's poses. The patient is turned as before a mammography unit: her anterior
 * axis is brought by the shortest way square to the chest wall behind the breast's core, of which
 * the least-squares plane is taken. Then as much of the breast lies in front of the receptor's edge
 * in CC as in MLO. The anchor is, across and along the body, the middle of the core, and along the
 * anterior axis the front of the fixed tissue (chest wall) behind the breast. If no material is
 * fixed, it is the tissue's posterior end, and nothing is turned. The breast is the highest
 * elevation over the body, without belly, armpit and flat tissue, and its core is what rises above
 * a quarter of its height (Private/BreastColumns.h). `fixed[m]` is true if material m is fixed to
 * the body; `axes`: the patient's.
 */
MAMMORAYFOUNDATION_EXPORT PoseFrame FindPoseFrame(const LabelVolume& materials,
  const std::vector<bool>& fixed, const AnatomicalAxes& axes);

/// The frame by a mesh's corners of cells; as accurate as the mesh follows the volume.
MAMMORAYFOUNDATION_EXPORT PoseFrame FindPoseFrame(const TetrahedralMesh& mesh,
  const std::vector<bool>& fixed, const AnatomicalAxes& axes);

/// The frame by a surface, not turned: the anchor is the middle of its bounding box across and
/// along the body, at the front of the fixed tissue, or at the posterior end if no material is
/// fixed.
MAMMORAYFOUNDATION_EXPORT PoseFrame FindPoseFrame(const SurfaceMesh& surface,
  const std::vector<bool>& fixed, const AnatomicalAxes& axes);

/**
 * The lateral position, mm along axes.Left, between two breasts that the volume holds side by side
 * (Private/BreastColumns.h); nothing if it holds one. Throws InputError if it contains only air.
 */
MAMMORAYFOUNDATION_EXPORT std::optional<double> MidlineBetweenBreasts(const LabelVolume& materials,
  const std::vector<bool>& fixed, const AnatomicalAxes& axes);

/// Replaces by air all tissue except the breast (as in FindPoseFrame) and the tissue behind it.
/// Throws InputError if the volume contains only air.
MAMMORAYFOUNDATION_EXPORT LabelVolume KeepBreast(const LabelVolume& materials,
  const std::vector<bool>& fixed, const AnatomicalAxes& axes);

/// Computes the placement of the unit: the support's face is at z = SupportHeightMm, the paddle's
/// face ThicknessMm above it.
MAMMORAYFOUNDATION_EXPORT VolumeFromGantry PlaceUnit(const PoseFrame& frame,
  const MammographyUnit& unit, const BreastPose& pose);

/// The frame that the pose of a placed unit refers to: PlaceUnit backwards.
MAMMORAYFOUNDATION_EXPORT PoseFrame FrameOf(const VolumeFromGantry& placed,
  const MammographyUnit& unit, const BreastPose& pose);

/// Velocity of the unit with respect to a parameter of the pose, per mm or degree; volume frame, mm
/// and radians.
struct UnitVelocity
{
  /// Translation of the whole unit, and its rotation about the anchor.
  Vector3 Shift{ 0, 0, 0 };
  Vector3 Turn{ 0, 0, 0 };
  /// Translation of the paddle relative to the unit, and its rotation about its chest-wall edge.
  Vector3 PaddleShift{ 0, 0, 0 };
  Vector3 PaddleTurn{ 0, 0, 0 };
};

/// Velocities of the placement by PlaceUnit and of the paddle, for each parameter in order; zero
/// for the stiffness.
MAMMORAYFOUNDATION_EXPORT std::array<UnitVelocity, ParameterCount> UnitVelocities(
  const PoseFrame& frame, const MammographyUnit& unit, const BreastPose& pose);
}

#endif
