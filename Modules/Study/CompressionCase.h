// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionCase_h
#define mammoray_CompressionCase_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Study/LabelSource.h"
#include "mammorayStudyModule.h"

#include "vtkSmartPointer.h"

#include <optional>
#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// Inputs of a compression, by files, and its options. The members have the defaults.
struct CompressionCase
{
  /// Linear tetrahedra with materials (.vtu), which define the frame.
  std::string Mesh;
  /// Material table: a path (.json) or the name of a shipped one.
  std::string Materials;
  /// Directions of the mesh's axes (AnatomicalAxes::FromCode).
  std::string Orientation = "LPS";
  /// Coarse mesh that carries the other along. Empty: the mesh itself if it is coarse enough, else
  /// one that is made with cells of this size, mm; 0 for a size by that of the breast.
  std::string SimulationMesh;
  double SimulationCellSizeMm = 0;
  /// Volume in which stiffness is sampled. Without a path it is sampled in the mesh.
  LabelSource Labels;
  MammographyUnit Unit;
  /// The thickness counts if no force is given.
  BreastPose Pose;
  /// Force of the paddle, N, positive, for which the thickness is found.
  std::optional<double> ForceN;
  /// Standard view ("CC", "MLO", ...) and side ('L', 'R'), whose roll is added to the pose's.
  /// Empty: none.
  std::string View;
  std::optional<char> Side;
  /// Elements, chest wall and friction. Pull and gravity are set by the following members.
  CompressionOptions Loading;
  /// Force that draws the breast forwards, spread over its volume, N.
  double PullN = 0;
  /// How the patient lay in the image, in which the breast bears its weight; it is compressed under
  /// that of the standing patient. Absent: the mesh is free of load, and no weight counts.
  std::optional<PatientPosition> ImagePosition;
  /// Steps of a time series from open plates to closed ones, at least 2. 0: none.
  int SeriesSteps = 0;
};

struct CompressionCaseResult
{
  MaterialTable Materials;
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  /// With the arrays of CompressionGrids and the unit's place (AddPlacement).
  vtkSmartPointer<vtkUnstructuredGrid> Compressed;
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> Series;
  CompressionState State;
  /// The thickness that was given or found, mm.
  double ThicknessMm = 0;
  VolumeFromGantry Placed;
  std::size_t SimulationCells = 0;
  std::size_t Unknowns = 0;
};

/// Reads, compresses, and moves the mesh. Throws InputError on unusable input, CompressionError if
/// there is no equilibrium between the plates, Interrupted.
MAMMORAYSTUDY_EXPORT CompressionCaseResult RunCompressionCase(const CompressionCase& input,
  const ProgressCallback& progress = {});

/// Draws the breast from the side before and after, with the plates, and after from the front
/// (.png). Throws InputError if it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteCompressionPicture(const CompressionCaseResult& result,
  const std::string& path);
}

#endif
