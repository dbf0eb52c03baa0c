// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ProjectOptions_h
#define mammoray_ProjectOptions_h

#include "DicomOptions.h"
#include "OptionList.h"
#include "ScatterOptions.h"
#include "SeriesOptions.h"
#include "SpectrumOptions.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/IO/SurfaceSceneIO.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/OpenField.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// What 'mammoray project' is asked for.
struct ProjectArguments
{
  std::string Mesh;
  /// In place of it, MATERIAL=FILE each.
  std::vector<std::string> Surfaces;
  /// Or a file that says what stands where (ApplyScene).
  std::string Scene;
  /// Those of --surface or of the scene; empty of a mesh.
  std::vector<SurfaceSample> SurfaceSamples;
  /// Whether an option was given, "--source".
  std::function<bool(const std::string&)> IsGiven;
  std::string Materials;
  std::vector<std::string> Attenuations;
  bool AcceptUnusual = false;
  SpectrumArguments XRays;
  DualEnergyArguments DualEnergy;
  ResponseArguments Response;
  std::string Orientation = "LPS";
  MammographyUnit Unit;
  BreastPose Pose;
  /// Where given, in place of what unit and pose say.
  std::optional<Vector3> Anchor;
  std::optional<Vector3> Source;
  std::optional<Vector3> BeamDirection;
  std::optional<Vector3> DetectorOrigin;
  std::optional<Vector3> ColumnDirection;
  std::optional<Vector3> RowDirection;
  int Columns = 720;
  int Rows = 1080;
  double PixelSpacingMm = 0.1;
  int Samples = 1;
  std::optional<std::array<double, 2>> FocalSpot;
  ExposureOptions Exposure;
  OpenFieldOptions Field;
  /// Target angle, degrees, and depth, micrometres.
  std::optional<std::array<double, 2>> Heel;
  /// None: rays are straight.
  std::string RefractionLaw;
  /// Where given, instead of from the middle of the mesh.
  std::optional<double> BendDistanceMm;
  std::string Deflection;
  ScatterArguments Scatter;
  SeriesArguments Series;
  ProjectorOptions Projector;
  std::vector<std::string> OverlapPriority;
  std::optional<char> Laterality;
  std::string View;
  /// "plain" or "realistic".
  std::string UnitKind = "plain";
  bool Display = false;
  bool ForProcessing = false;
  DicomPatient Patient;
  std::string Output;
  std::string PathLengths;
  bool Overwrite = false;
};

void DeclareProject(const OptionList& add, ProjectArguments& arguments);

/// Fills in what --unit realistic says of what is not asked for otherwise.
void ApplyUnit(ProjectArguments& arguments);
}

#endif
