// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PoseParameters_h
#define mammoray_PoseParameters_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammorayFoundationModule.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace mammoray
{
/// Description of a parameter of BreastPose. Commands, JSON, filters, reports, the app and the
/// registration take names, units, defaults, bounds and priors from PoseParameters. The value is in
/// BreastPose; its effect on the unit is in PlaceUnit and UnitVelocities.
struct MAMMORAYFOUNDATION_EXPORT PoseParameter
{
  /// Index in PoseParameters and in vectors of values.
  PoseParameterIndex Index;
  /// "lateral": the name in commands, files and arrays.
  const char* Name;
  /// Unit: "mm", "deg" or "" for a factor.
  const char* Unit;
  /// Title for headings.
  const char* Title;
  /// Help text: the meaning and the direction of positive values, without the unit.
  const char* Help;
  double BreastPose::*Value;
  /// Start of a registration that has no other information.
  double Start;
  /// Bounds of a registration on either side of its start: Reach + RelativeReach * start.
  double Reach;
  double RelativeReach;
  /// Absolute bounds that replace these if they are finite. A start beyond them is its own bound.
  double Least;
  double Most;
  /// Scale of the parameter in its unit, which makes the unknowns of a registration comparable;
  /// positive.
  double Scale;
  /// Standard deviation of the prior around the start; 0 for no prior.
  double PriorSigma;
  /// True if a registration estimates the parameter by default.
  bool Free;
  /// True if a mammogram's header or view provides the start.
  bool InHeader;

  double Lower(double start) const;
  double Upper(double start) const;
};

/// All parameters, in the order of PoseParameterIndex.
inline constexpr double NoBound = std::numeric_limits<double>::infinity();
inline constexpr std::array<PoseParameter, ParameterCount> PoseParameters{ {
  // The header states the position of the paddle, which bends and is calibrated to a few
  // millimetres.
  { ThicknessParameter, "thickness", "mm", "Compressed thickness", "distance of the plates' faces",
    &BreastPose::ThicknessMm, 50, 0, 0.5, NoBound, NoBound, 5, 5, true, true },
  { RollParameter, "roll", "deg", "Rotation about the chest–nipple axis",
    "rotation of the unit about the anterior axis; 0 is CC, positive turns the source towards the "
    "patient's left",
    &BreastPose::RollDeg, 0, 30, 0, NoBound, NoBound, 5, 0, true, true },
  // A patient stands neither as she lay nor quite straight, and paddles bend. When pitch, yaw and
  // tilt were fixed at 0, the breast was deformed instead. One picture hardly determines them, so
  // they have priors.
  { PitchParameter, "pitch", "deg", "Rotation about the chest wall's edge",
    "rotation of the rolled unit about its lateral axis; positive turns the source to the front",
    &BreastPose::PitchDeg, 0, 20, 0, NoBound, NoBound, 5, 5, true, false },
  { YawParameter, "yaw", "deg", "Rotation about the beam",
    "rotation of the unit about its vertical axis; positive turns it to the patient's left (CC)",
    &BreastPose::YawDeg, 0, 20, 0, NoBound, NoBound, 5, 5, true, false },
  { LateralParameter, "lateral", "mm", "Shift along the chest wall",
    "shift of the receptor along its chest-wall edge; positive towards the patient's left (CC)",
    &BreastPose::LateralMm, 0, 100, 0, NoBound, NoBound, 5, 0, true, false },
  // The plates press as far into the muscle as it is thick; the ribs do not give way.
  { AnteriorParameter, "anterior", "mm", "Shift away from the chest wall",
    "distance of the receptor's edge from the chest wall", &BreastPose::AnteriorMm, 5, 50, 0, -20,
    NoBound, 5, 0, true, false },
  // A picture hardly shows how high the support was raised, and the middle of a segmented breast is
  // uncertain by some millimetres.
  { VerticalParameter, "vertical", "mm", "Shift along the beam",
    "height of the plates' middle over the breast's middle; positive towards the source",
    &BreastPose::VerticalMm, 0, 30, 0, NoBound, NoBound, 5, 5, true, false },
  { TiltParameter, "tilt", "deg", "Tilt of the paddle",
    "turn of the paddle about its chest-wall edge; positive opens it towards the nipple",
    &BreastPose::TiltDeg, 0, 10, 0, NoBound, NoBound, 2, 2, true, false },
  // Published ratios of gland to fat have this spread. One picture hardly determines the ratio.
  { StiffnessParameter, "stiffness", "", "Stiffness of gland, times the table's",
    "factor on the stiffness of gland", &BreastPose::Stiffness, 1, 0, 0, 0.25, 4, 0.5, 1, false,
    false },
} };

/// The parameter with this name. Throws InputError with similar names if there is none.
MAMMORAYFOUNDATION_EXPORT const PoseParameter& FindPoseParameter(const std::string& name);

/// The names in order, joined by `separator`, for messages and help.
MAMMORAYFOUNDATION_EXPORT std::string PoseParameterNames(const std::string& separator = ", ");

/// The names of the parameters that a registration estimates by default.
MAMMORAYFOUNDATION_EXPORT std::vector<std::string> FreePoseParameterNames();

/// The pose at which a registration begins without other information: each parameter at its Start.
/// It differs from BreastPose(), whose receptor touches the chest wall.
MAMMORAYFOUNDATION_EXPORT BreastPose DefaultStart();

///@{
/// Converts a pose to ParameterCount values in the order of PoseParameters, and back.
MAMMORAYFOUNDATION_EXPORT std::vector<double> ValuesOf(const BreastPose& pose);
MAMMORAYFOUNDATION_EXPORT BreastPose PoseOf(const std::vector<double>& values);
///@}
}

#endif
