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
/**
 * What there is to know of a parameter of BreastPose. Commands, JSON, filters, reports, viewer and
 * registration take names, units, defaults, bounds and priors from PoseParameters; the value and
 * its effect on the unit are BreastPose, PlaceUnit and UnitVelocities.
 */
struct MAMMORAYFOUNDATION_EXPORT PoseParameter
{
  /// Place in PoseParameters and in vectors of values.
  PoseParameterIndex Index;
  /// "lateral": the option --lateral, the parameter of --free, the name in files and arrays.
  const char* Name;
  /// "mm", "deg" or "" (a factor).
  const char* Unit;
  /// For headings.
  const char* Title;
  /// For help: what is meant and where a positive value leads, without the unit.
  const char* Help;
  double BreastPose::*Value;
  /// Where a registration starts that is told nothing.
  double Start;
  /// Bounds of a registration, to both sides of its start: this, plus this part of the start.
  double Reach;
  double RelativeReach;
  /// In place of those, where they are finite; a start beyond them is its own bound.
  double Least;
  double Most;
  /// A registration's step, in the parameter's unit, makes its unknowns comparable. Positive.
  double Scale;
  /// Standard deviation of the prior around the start; 0: none.
  double PriorSigma;
  /// Whether a registration finds it unless told otherwise.
  bool Free;
  /// Whether a mammogram's header says where to start, or its view.
  bool InHeader;

  double Lower(double start) const;
  double Upper(double start) const;
  /// "--lateral"
  std::string Option() const { return std::string("--") + this->Name; }
  /// "LateralMm", "RollDeg", "Stiffness": the property of VTK filters.
  std::string Property() const;
  /// "12.30 mm", "-4.00 deg", "1.20": `digits` after the point.
  std::string Format(double value, int digits = 2) const;
};

/// All parameters, in the order of PoseParameterIndex.
inline constexpr double NoBound = std::numeric_limits<double>::infinity();
inline constexpr std::array<PoseParameter, ParameterCount> PoseParameters{ {
  // The header's thickness is the paddle's, which bends and is calibrated to some mm.
  { ThicknessParameter, "thickness", "mm", "Compressed thickness", "distance of the plates' faces",
    &BreastPose::ThicknessMm, 50, 0, 0.5, NoBound, NoBound, 5, 5, true, true },
  { RollParameter, "roll", "deg", "Rotation about the chest–nipple axis",
    "rotation of the unit about the anterior axis; 0 is CC, positive turns the source towards the "
    "patient's left",
    &BreastPose::RollDeg, 0, 30, 0, NoBound, NoBound, 5, 0, true, true },
  // A patient stands neither as she lay nor quite straight, and paddles bend: kept at 0, pitch, yaw
  // and tilt bent the breast instead. One picture hardly tells them, so that they have priors.
  { PitchParameter, "pitch", "deg", "Rotation about the chest wall's edge",
    "rotation of the rolled unit about its lateral axis; positive turns the source to the front",
    &BreastPose::PitchDeg, 0, 20, 0, NoBound, NoBound, 5, 5, true, false },
  { YawParameter, "yaw", "deg", "Rotation about the beam",
    "rotation of the unit about its vertical axis; positive turns it to the patient's left (CC)",
    &BreastPose::YawDeg, 0, 20, 0, NoBound, NoBound, 5, 5, true, false },
  { LateralParameter, "lateral", "mm", "Shift along the chest wall",
    "shift of the receptor along its chest-wall edge; positive towards the patient's left (CC)",
    &BreastPose::LateralMm, 0, 100, 0, NoBound, NoBound, 5, 0, true, false },
  // The plates cannot stand behind the front of the chest wall.
  { AnteriorParameter, "anterior", "mm", "Shift away from the chest wall",
    "distance of the receptor's edge from the chest wall", &BreastPose::AnteriorMm, 5, 50, 0, 0,
    NoBound, 5, 0, true, false },
  // Along the beam, and almost without effect on the picture.
  { VerticalParameter, "vertical", "mm", "Shift along the beam",
    "height of the plates' middle over the breast's middle; positive towards the source",
    &BreastPose::VerticalMm, 0, 30, 0, NoBound, NoBound, 5, 0, false, false },
  { TiltParameter, "tilt", "deg", "Tilt of the paddle",
    "turn of the paddle about its chest-wall edge; positive opens it towards the nipple",
    &BreastPose::TiltDeg, 0, 10, 0, NoBound, NoBound, 2, 2, true, false },
  // Published ratios of gland to fat span as much. One picture hardly tells it from the others.
  { StiffnessParameter, "stiffness", "", "Stiffness of gland, times the table's",
    "factor on the stiffness of gland", &BreastPose::Stiffness, 1, 0, 0, 0.25, 4, 0.5, 1, false,
    false },
} };

/// By its name. Throws InputError with the names that may have been meant.
MAMMORAYFOUNDATION_EXPORT const PoseParameter& FindPoseParameter(const std::string& name);

/// The names in their order, with `separator` between: for messages and help.
MAMMORAYFOUNDATION_EXPORT std::string PoseParameterNames(const std::string& separator = ", ");

/// The names of those that a registration finds unless told otherwise.
MAMMORAYFOUNDATION_EXPORT std::vector<std::string> FreePoseParameterNames();

///@{
/// A pose as ParameterCount values in the order of PoseParameters, and back.
MAMMORAYFOUNDATION_EXPORT std::vector<double> ValuesOf(const BreastPose& pose);
MAMMORAYFOUNDATION_EXPORT BreastPose PoseOf(const std::vector<double>& values);
///@}
}

#endif
