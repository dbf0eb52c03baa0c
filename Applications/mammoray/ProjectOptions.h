// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ProjectOptions_h
#define mammoray_ProjectOptions_h

#include "DicomOptions.h"
#include "OptionList.h"
#include "ScatterOptions.h"
#include "SceneOptions.h"
#include "SeriesOptions.h"
#include "SpectrumOptions.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/IO/SceneIO.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// The options of 'mammoray project'.
struct ProjectArguments
{
  /// Options are declared on its members. CompleteScene adds the others and the scene's file.
  SceneDescription Scene;
  std::string SceneFile;
  /// MATERIAL=FILE each.
  std::vector<std::string> Surfaces;
  IsGivenFunction IsGiven;
  std::vector<std::string> Attenuations;
  DualEnergyArguments DualEnergy;
  std::string Orientation = "LPS";
  MammographyUnit Unit;
  BreastPose Pose;
  /// These replace the places that unit and pose give.
  std::optional<Vector3> Anchor;
  std::optional<Vector3> Source;
  std::optional<Vector3> BeamDirection;
  std::optional<Vector3> DetectorOrigin;
  std::optional<Vector3> ColumnDirection;
  std::optional<Vector3> RowDirection;
  double PixelSpacingMm = 0.1;
  std::optional<std::array<double, 2>> FocalSpot;
  /// Target angle, degrees, and depth, micrometres.
  std::optional<std::array<double, 2>> Heel;
  /// Empty: rays are straight.
  std::string RefractionLaw;
  std::string Deflection;
  ScatterArguments Scatter;
  SeriesArguments Series;
  std::optional<char> Laterality;
  std::string View;
  /// "plain" or "realistic".
  std::string UnitKind = "plain";
  bool Display = false;
  bool ForProcessing = false;
  DicomPatient Patient;
  std::string Output;
  std::string PathLengths;

  /// Whether source and detector stand where the mammography unit has them.
  bool IsPlacedByUnit() const;
};

void DeclareProject(const OptionList& add, ProjectArguments& arguments);

/// Brings the options, the scene's file and --unit realistic into arguments.Scene. Throws
/// InputError.
void CompleteScene(ProjectArguments& arguments);
}

#endif
