// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationCase_h
#define mammoray_RegistrationCase_h

#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Biomechanics/WallAttachment.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/LabelSource.h"
#include "mammorayStudyModule.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct StudyChoice;
struct StudyTissue;

/// What synthetic mammograms have of scatter: by kernels.
struct RegisteredScatter
{
  /// From the back of the tissue to the detector, 0 to 200 mm; nothing: as high as the unit's
  /// support.
  std::optional<double> AirGapMm;
  /// AntiscatterGridOptions::OfLead; nothing: no grid.
  std::optional<std::array<double, 3>> Grid;
  std::string Interspace = "fibre";
};

/// Everything that says what is registered to what, by files; the members carry the defaults.
struct RegistrationCase
{
  /// A clinic's export whose MRI is segmented in place of Labels (TakeStudy); null: none.
  std::shared_ptr<const StudyChoice> Study;
  /// Finer label volumes are resampled to 0.5 mm unless told otherwise.
  LabelSource Labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
  /// Material table: a path (.json) or the name of a shipped one.
  std::string Materials;
  /// DICOM MG, one exposure or the projections of a tomosynthesis (ReadProjections) each; more than
  /// one of the same breast are registered together.
  std::vector<std::string> Mammograms;
  /// Of mammograms that are pictures (.jpg, .png), and in place of what a header says: mm at the
  /// receptor; "CC", "MLO", ..., one for each mammogram; 'L' or 'R'.
  std::optional<double> PixelSpacingMm;
  std::vector<std::string> MammogramViews;
  std::string Laterality;
  /// Images that are not 0 where a mammogram is not to be compared (ExcludeByImage), one for each.
  std::vector<std::string> Masks;
  /// How mammograms are outlined, and what of them is compared.
  TargetOptions Targets;
  /// Spectrum: a path (.spc) or the name of a shipped one.
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  /// What scatters onto the synthetic mammograms (ScatterModel); nothing: primary radiation alone.
  std::optional<RegisteredScatter> Scatter;
  /// Directions of the volume's axes (AnatomicalAxes::FromCode).
  std::string Orientation = "LPS";
  /// Meshes made before (mammoray mesh), used instead of meshing; empty: mesh.
  std::string AnatomyMesh;
  std::string SimulationMesh;
  /// Seconds and cells are spent here: upper bounds of cell sizes, mm. 0 for the mechanics takes
  /// one that gives 3000 to 6000 cells.
  double AnatomyCellSizeMm = 4.0;
  double SimulationCellSizeMm = 0.0;
  /// Part of a Vulkan device's name; empty: the most capable one.
  std::string Device;
  /// "auto", "ray-tracing" or "rasterisation"; see ProjectorOptions::Method.
  std::string Projector = "auto";

  /// The unit; what the header says about it wins unless given here.
  std::optional<double> SourceToDetectorMm;
  std::optional<double> SupportHeightMm;
  double SupportEdgeMm = 0.0;
  double PaddleEdgeMm = 0.0;
  double EdgeRadiusMm = SearchedEdgeRadiusMm;

  /// How the patient lay in the volume: the breast is unloaded of the weight it hangs or lies under
  /// there, and compressed under that of the standing patient. None: the volume is free of load.
  std::optional<PatientPosition> ImagePosition;
  ChestWallMode ChestWall = ChestWallMode::Fixed;

  /// Where the search starts, and where stays what is not free: of each of PoseParameters one value
  /// for each mammogram, or one for all where headers do not tell it. Empty: what the header says,
  /// else PoseParameter::Start.
  std::array<std::vector<double>, ParameterCount> Start;
  /// Names of the parameters that are found; the others keep their start. Empty: those with
  /// PoseParameter::Free of each mammogram, and, of several mammograms, the stiffness of gland (if
  /// any), which they share.
  std::vector<std::string> Free;
  /// Standard deviation of the roll about what the header says, degrees; 0: nothing is assumed.
  double RollSigmaDeg = 0;
  /// Folder of an earlier result of the same volume, materials and mammogram, or of one that was
  /// cut off and has a checkpoint, whose pose the search goes on from, in its bounds; or a
  /// checkpoint itself. Empty: none.
  std::string Resume;
  /// Write the names of the inputs' files and series into results and reports: they may hold the
  /// patient's name, so they are not written unless asked for. Those of shipped files are.
  bool NameInputs = false;
  /// File that always holds the last accepted step of the search (see CheckpointPath); empty: none.
  std::string Checkpoint;
  /// What the report begins with: a point of the volume, mm, and each label of a volume of lesions
  /// (path; its axes are taken as those of Labels); where each mammogram shows them.
  std::optional<Vector3> Point;
  std::string Lesions;
  /// MRI in the frame of Labels (path), which the report shows around them and the result keeps; a
  /// study has its own. Empty: tissues are shown in colour.
  std::string Image;
  /// The report says patient and study, as the first mammogram's header names them.
  bool NamePatient = false;
  /// The search itself.
  RegistrationOptions Options;
};

/// A mammogram of a case, and what a run made of it.
struct RegisteredView
{
  /// Of the mammogram.
  std::string Path;
  /// Of a tomosynthesis its middle projection.
  mammoray::Mammogram Mammogram;
  mammoray::View View;
  ViewResult Registration;
  /// What had to be assumed, a sentence each.
  std::vector<std::string> Warnings;
};

struct RegistrationCaseResult
{
  MaterialTable Materials;
  AnatomicalAxes Axes;
  /// What a study's MRI was segmented into; null where labels were given.
  std::shared_ptr<const StudyTissue> Tissue;
  /// Where something was asked for: what was registered, material indices, and the lesions; null
  /// where they are not needed.
  std::shared_ptr<const LabelVolume> Volume;
  std::shared_ptr<const LabelVolume> Lesions;
  /// The case's Image; null: none was given.
  std::shared_ptr<const IntensityVolume> Image;
  Vector3 Anchor{ 0, 0, 0 };
  /// At rest, volume frame.
  TetrahedralMesh Anatomy;
  /// In the order of the case's mammograms.
  std::vector<RegisteredView> Views;
  /// What all of them had free, and its covariance (RegistrationResult).
  std::vector<FreeParameter> FreeParameters;
  std::vector<double> Covariance;
  /// Name of the projecting device, and the method.
  std::string Device;
  std::size_t SimulationCells = 0;
  std::size_t SurfaceTriangles = 0;
  /// Stage -> wall time, s, in the order they ran.
  std::vector<std::pair<std::string, double>> Timings;
};

/// What a case is made from: a file, or the files of a series.
struct CaseInput
{
  /// What it is used for (ResultInput::Role).
  std::string Role;
  /// Of the file or folder, without the folder it is in, where it is named
  /// (RegistrationCase::NameInputs) or a shipped one, else "*" and the file's extension; a series'
  /// description.
  std::string Name;
  std::vector<std::string> Files;

  /// SHA-256 of all its bytes. Throws InputError when they cannot be read.
  std::string Sha256() const;
};

/// How results call an input file: see CaseInput::Name.
MAMMORAYSTUDY_EXPORT std::string ShownName(const std::string& path, bool named);

/// What was given, with one of the mammograms.
MAMMORAYSTUDY_EXPORT std::vector<CaseInput> CaseInputs(const RegistrationCase& input,
  const std::string& mammogram);

/**
 * Reads, meshes, compresses, projects and registers. Throws InputError on unusable input,
 * DeviceError without a device, ConvergenceError where not even the start has an equilibrium,
 * Interrupted when stopped before the search began; later it gives the best pose so far.
 */
MAMMORAYSTUDY_EXPORT RegistrationCaseResult RunRegistrationCase(const RegistrationCase& input,
  const ProgressCallback& progress = {});
}

#endif
