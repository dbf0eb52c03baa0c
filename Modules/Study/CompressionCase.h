// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionCase_h
#define mammoray_CompressionCase_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/PlacedPlates.h"
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
/// What is compressed and how, by files; the members carry the defaults.
struct CompressionCase
{
  /// Linear tetrahedra with materials (.vtu), in whose frame all is.
  std::string Mesh;
  /// Material table: a path (.json) or the name of a shipped one.
  std::string Materials;
  /// Directions of the mesh's axes (AnatomicalAxes::FromCode).
  std::string Orientation = "LPS";
  /// Coarse mesh that carries the other along; empty: the mesh itself where it is coarse enough,
  /// else one that is made with cells of this size, mm; 0: by the size of the breast.
  std::string SimulationMesh;
  double SimulationCellSizeMm = 0;
  /// Where stiffness is sampled; without a path in the mesh.
  LabelSource Labels;
  MammographyUnit Unit;
  /// The thickness counts where no force is given.
  BreastPose Pose;
  /// Force of the paddle whose thickness is found, N, positive.
  std::optional<double> ForceN;
  /// Standard view ("CC", "MLO", ...) and side ('L', 'R'), whose roll is added; empty: none.
  std::string View;
  std::optional<char> Side;
  /// Elements, chest wall and friction; weight and pull are filled in from the following.
  CompressionOptions Loading;
  /// Force that draws the breast forwards, spread over its volume, N.
  double PullN = 0;
  /// How the patient lay in the image, of whose weight the breast is unloaded; none: the mesh is
  /// free of load.
  std::optional<PatientPosition> ImagePosition;
  /// The standing patient's weight counts even where the image was free of load.
  bool Gravity = false;
  /// Steps of a time series from open plates to closed ones, at least 2; 0: none.
  int SeriesSteps = 0;
};

struct CompressionCaseResult
{
  MaterialTable Materials;
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  /// With the arrays of CompressionGrids, and where the unit stands (AddPlacement).
  vtkSmartPointer<vtkUnstructuredGrid> Compressed;
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> Series;
  CompressionState State;
  /// Asked for or found, mm.
  double ThicknessMm = 0;
  VolumeFromGantry Placed;
  std::size_t SimulationCells = 0;
  std::size_t Unknowns = 0;
};

/// Reads, compresses, and moves the mesh. Throws InputError on unusable input, CompressionError
/// where the plates asked for have no equilibrium, Interrupted.
MAMMORAYSTUDY_EXPORT CompressionCaseResult RunCompressionCase(const CompressionCase& input,
  const ProgressCallback& progress = {});

/// Draws the breast from the side before and after, with the plates, and after from the front
/// (.png). Throws InputError when it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteCompressionPicture(const CompressionCaseResult& result,
  const std::string& path);
}

#endif
