// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ViewedBreast_h
#define mammoray_ViewedBreast_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/XRay/Beam.h"
#include "mammorayAppModule.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// What to look at, by files; the members carry the defaults.
struct ViewInput
{
  /// Folder of 'mammoray register'; or a mesh (.vtu), which may be one that 'mammoray compress'
  /// wrote. One of them.
  std::string Result;
  std::string Mesh;
  /// DICOM MG, those registered of a result, in any order; empty: none is shown.
  std::vector<std::string> Mammograms;
  /// MRI in the frame of the mesh, and of a folder of several volumes the number (see ReadMri);
  /// empty: the result's mri.nrrd, if any.
  std::string Image;
  std::optional<int> ImageSeries;
  /// Label volume of lesions in that frame; empty: none.
  std::string Lesions;
  /// Material table, a path or a shipped one's name; of a result: empty takes the one that it was
  /// made with, if that is shipped.
  std::string Materials;
  /// A path or a shipped one's name; empty: the result's, else W28kVp_Rh50um_Be1mm.
  std::string Spectrum;
  /// Directions of the mesh's axes (AnatomicalAxes::FromCode); a result tells its own.
  std::string Orientation = "LPS";
  /// Of PoseParameters; what is given replaces what the input says, by which it is compressed anew,
  /// or else the default.
  std::array<std::optional<double>, ParameterCount> Pose;
  /// Pixels of the synthetic mammogram where there is no real one, mm.
  double PixelSpacingMm = 0.2;
  /// For the mechanics, as in a registration; empty: made of the mesh.
  LabelSource Labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
  std::string SimulationMesh;
};

/// What the views of a breast in one unit need to know.
struct ViewedBreast
{
  /// The path of what was read, for messages.
  std::string Name;
  /// "cc", of several mammograms; empty: there is one.
  std::string View;
  /// MRI, tissues (material indices) and lesions, which the slices show; null where there are none.
  std::shared_ptr<const IntensityVolume> Image;
  std::shared_ptr<const LabelVolume> Tissue;
  std::shared_ptr<const LabelVolume> Lesions;
  /// As it stands at the beginning; compressed may be uncompressed. The grid is the mammogram's, or
  /// one that holds the breast.
  BreastInUnit Breast;
  TetrahedralMesh Anatomy;
  MaterialTable Materials;
  mammoray::Spectrum Spectrum;
  AnatomicalAxes Axes;
  PoseFrame Frame;
  BreastPose Pose;
  /// 'L', 'R' or '?'.
  char Laterality = '?';
  /// With its picture, on Breast's grid; none without a mammogram.
  std::optional<RegistrationTarget> Real;
  /// How far the registration may be relied on; good, and nothing expected, where there is none.
  Assessment Trust;
  std::optional<ExpectedError> Expected;
  /// The pose asked for is not that of the compressed points.
  bool PoseDiffers = false;
  BreastModelOptions Mechanics;
};

/// The grid with other points, 3 x pointCount, its arrays shared.
MAMMORAYAPP_EXPORT vtkSmartPointer<vtkUnstructuredGrid> WithPoints(vtkUnstructuredGrid* grid,
  const std::vector<double>& points);

/// Reads it: of a joint result one for each mammogram, in its order, else one. Throws InputError,
/// one line, on anything unusable.
MAMMORAYAPP_EXPORT std::vector<ViewedBreast> ReadViewedBreasts(const ViewInput& input);
}

#endif
