// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ProjectOptions_h
#define mammoray_ProjectOptions_h

#include "DicomOptions.h"
#include "SceneOptions.h"
#include "SeriesOptions.h"
#include "mammoray/Foundation/MammographyGeometry.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A second exposure at higher energy, and how the two are recombined.
struct DualEnergyArguments
{
  /// KEY=VALUE each: quantities of its beam.
  std::vector<std::string> High;
  std::vector<std::string> Cancel;
  double ThicknessMm = 50;

  bool IsAsked() const { return !this->High.empty(); }
};

/// The options of 'mammoray project'.
struct ProjectArguments
{
  SceneArguments Given;
  /// Made of them by CompleteScene.
  SceneDescription Scene;
  DualEnergyArguments DualEnergy;
  std::string Orientation = "LPS";
  MammographyUnit Unit;
  BreastPose Pose;
  /// Replaces the point that the pose refers to.
  std::optional<Vector3> Anchor;
  std::string Deflection;
  SeriesArguments Series;
  std::optional<char> Laterality;
  std::string View;
  bool Display = false;
  bool ForProcessing = false;
  DicomPatient Patient;
  std::string Output;
  std::string PathLengths;
  /// Where kernels that are made for the scene are written.
  std::string MakeKernels;
  /// Whether the scene is printed in place of a picture.
  bool PrintScene = false;

  /// Whether source and detector stand where the mammography unit has them.
  bool IsPlacedByUnit() const { return !this->Scene.HasSource() && !this->Scene.HasDetector(); }
};

void DeclareProject(const OptionList& add, ProjectArguments& arguments);

/// Brings the scene's file and the options into arguments.Scene. Throws InputError.
void CompleteScene(ProjectArguments& arguments);

/// The spectrum of higher energy; `low` has the anode. Throws InputError.
Spectrum ToHighSpectrum(const DualEnergyArguments& arguments, const SceneDescription& low);
}

#endif
