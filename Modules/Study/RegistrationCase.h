// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationCase_h
#define mammoray_RegistrationCase_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayStudyModule.h"

#include "vtkSmartPointer.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
struct StudyChoice;
struct StudyTissue;

/// Scatter in synthetic mammograms, by kernels.
struct RegisteredScatter
{
  /// From the back of the tissue to the detector, 0 to 200 mm. Absent: the height of the support.
  std::optional<double> AirGapMm;
  /// Anti-scatter grid as in AntiscatterGridOptions::OfLead. Absent: no grid.
  std::optional<std::array<double, 3>> Grid;
  std::string Interspace = "fibre";
};

/// Inputs of a registration, by files, and its options. The members have the defaults.
struct RegistrationCase
{
  /// A clinic's export (TakeStudy). Its MRI is segmented, or Labels, if they have a path, are its
  /// tissue (LabelStudy). Null: none.
  std::shared_ptr<const StudyChoice> Study;
  /// Numbers of the export's volumes to take (ChooseForRegistration), or of Image's (ReadMri);
  /// empty: those that are chosen, or the only one.
  std::vector<int> Series;
  /// By default, finer label volumes are resampled to 0.5 mm.
  LabelSource Labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
  /// Material table: a path (.json) or the name of a shipped one.
  std::string Materials;
  /// DICOM MG, one exposure or the projections of a tomosynthesis (ReadProjections) each. Several
  /// mammograms of one breast are registered together.
  std::vector<std::string> Mammograms;
  /// Pixel size at the receptor, mm; views ("CC", "MLO", ...), one for each mammogram; the side,
  /// 'L' or 'R'. They replace what a header says, and are required of pictures (.jpg, .png).
  std::optional<double> PixelSpacingMm;
  std::vector<std::string> MammogramViews;
  std::string Laterality;
  /// One image for each mammogram, which is not compared where the image is not 0 (ExcludePixels).
  std::vector<std::string> Masks;
  /// How mammograms are outlined, and what of them is compared.
  TargetOptions Targets;
  /// Spectrum: a path (.spc) or the name of a shipped one.
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  /// Absent: primary radiation alone.
  std::optional<RegisteredScatter> Scatter;
  /// Directions of the volume's axes (AnatomicalAxes::FromCode).
  std::string Orientation = "LPS";
  /// Meshes made before (mammoray mesh). Empty: they are made from the labels.
  std::string AnatomyMesh;
  std::string SimulationMesh;
  /// Upper bounds of cell sizes, mm. They decide the time that a registration takes. 0 for the
  /// mechanics: a size that gives 3000 to 6000 cells.
  double AnatomyCellSizeMm = 4.0;
  double SimulationCellSizeMm = 0.0;
  ProjectorOptions Projector;

  /// The unit. These distances replace those of the header; absent, the header's or
  /// MammographyUnit's count.
  std::optional<double> SourceToDetectorMm;
  std::optional<double> SupportHeightMm;
  double EdgeRadiusMm = SearchedEdgeRadiusMm;

  /// How the patient lay in the volume. The breast is unloaded of the weight that it had there, and
  /// compressed under that of the standing patient. Absent: the volume is free of load.
  std::optional<PatientPosition> ImagePosition;
  ChestWallMode ChestWall = ChestWallMode::Fixed;

  /// Start of the search by PoseParameterIndex: a value for each mammogram, or one for all if
  /// headers do not give the parameter. Parameters that are not free keep it. Empty: the header's
  /// value, or else PoseParameter::Start.
  std::array<std::vector<double>, ParameterCount> Start;
  /// Names of the parameters that are found. Empty: those with PoseParameter::Free, and of several
  /// mammograms the stiffness of gland (if any), which they share.
  std::vector<std::string> Free;
  /// Standard deviation of the roll about its start, degrees. 0: no prior.
  double RollSigmaDeg = 0;
  /// Folder of an earlier result of the same inputs, or of a run that was cut off and left a
  /// checkpoint; or a checkpoint. The search goes on from its pose, in its bounds. Empty: none.
  std::string Resume;
  /// Results and reports name the input files and series, which may hold the patient's name.
  /// Shipped files are always named.
  bool NameInputs = false;
  /// File that holds the last accepted step of the search (CheckpointPath). Empty: none.
  std::string Checkpoint;
  /// Places that the report shows in each mammogram: a point of the volume, mm, and each label of a
  /// volume of lesions (path, with the same axes as Labels).
  std::optional<Vector3> Point;
  std::string Lesions;
  /// MRI in the frame of Labels (path), which the report shows around these places and the result
  /// keeps. A study has its own. Empty: tissues are shown in colour.
  std::string Image;
  /// The report names patient and study, as the first mammogram's header does.
  bool NamePatient = false;
  RegistrationOptions Options;
};

/// A mammogram of a case and its registration.
struct RegisteredView
{
  std::string Path;
  /// The middle projection of a tomosynthesis.
  mammoray::Mammogram Mammogram;
  mammoray::View View;
  ViewResult Registration;
  /// Assumptions and notes of the search, a sentence each.
  std::vector<std::string> Warnings;
};

struct RegistrationCaseResult
{
  MaterialTable Materials;
  AnatomicalAxes Axes;
  /// Tissue in a study's MRI. Null without a study.
  std::shared_ptr<const StudyTissue> Tissue;
  /// If the case asks for places: the registered volume, material indices, and the lesions. Null if
  /// they are not needed.
  std::shared_ptr<const LabelVolume> Volume;
  std::shared_ptr<const LabelVolume> Lesions;
  /// The case's Image. Null: none.
  std::shared_ptr<const IntensityVolume> Image;
  Vector3 Anchor{ 0, 0, 0 };
  /// Uncompressed, volume frame.
  TetrahedralMesh Anatomy;
  /// In the order of the case's mammograms.
  std::vector<RegisteredView> Views;
  /// See RegistrationResult.
  std::vector<FreeParameter> FreeParameters;
  std::vector<double> Covariance;
  /// Notes of the readers (InputNote) on the case's inputs, each once: ShownName and text, without
  /// names from the files.
  std::vector<std::string> Notes;
  /// Name of the projecting device, and the method.
  std::string Device;
  std::size_t SimulationCells = 0;
  std::size_t SurfaceTriangles = 0;
  /// Name and wall time, s, of each stage, in the order they ran.
  std::vector<std::pair<std::string, double>> Timings;
};

/// Name of an input file in results: its name without the folder if `named`
/// (RegistrationCase::NameInputs) or if it is a shipped file, else "*" and its extension.
MAMMORAYSTUDY_EXPORT std::string ShownName(const std::string& path, bool named);

/**
 * Reads, meshes, compresses, projects and registers. Throws InputError on unusable input,
 * DeviceError without a device, ConvergenceError where not even the start has an equilibrium,
 * Interrupted when stopped before the search began; later it gives the best pose so far.
 */
MAMMORAYSTUDY_EXPORT RegistrationCaseResult RunRegistrationCase(const RegistrationCase& input,
  const ProgressCallback& progress = {}, const SearchObserver& observer = {});

/// The uncompressed anatomy, volume frame, with the point array "Displacement" (mm), those of the
/// sensitivities (SensitivityArrayPrefix), and the unit's "Placement".
MAMMORAYSTUDY_EXPORT vtkSmartPointer<vtkUnstructuredGrid> UncompressedGrid(
  const RegistrationCaseResult& result, const RegisteredView& registered);

/// Folders of the mammograms within the result's folder: their views in small letters ("cc",
/// "mlo"), numbered if they repeat; "" for a single mammogram.
MAMMORAYSTUDY_EXPORT std::vector<std::string> MammogramFolders(
  const RegistrationCaseResult& result);

/// Whether a result's folder, or one of its mammograms', has a file of this name.
MAMMORAYSTUDY_EXPORT bool IsFileOfResult(const std::string& name);

/// The checkpoint of a search whose result goes to this folder, until the result is written.
MAMMORAYSTUDY_EXPORT std::string CheckpointPath(const std::string& folder);

/// Reserves the folder (ReserveFolder). Throws InputError unless the folder is new or empty or,
/// with `overwrite`, has an earlier result and nothing else.
MAMMORAYSTUDY_EXPORT void CheckResultFolder(const std::string& folder, bool overwrite);

/**
 * Writes a folder, complete or not at all, and removes the case's checkpoint.
 *
 * One mammogram: uncompressed.vtu and compressed.vtu (volume frame, both with the point array
 * "Displacement", mm, from the one to the other), synthetic.mha (log attenuation on the mammogram's
 * pixel grid, float), the result file, and the files of WriteRegistrationReport. Several: a folder
 * with these for each (MammogramFolders), the joint result file, and the files of WriteJointReport.
 * A study adds labels.seg.nrrd and mri.nrrd (StudyTissue) and a section of the report. The case's
 * Image becomes mri.nrrd, too.
 *
 * Throws InputError as CheckResultFolder, and if a file cannot be written or an input cannot be
 * read.
 */
MAMMORAYSTUDY_EXPORT void WriteRegistrationCase(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::string& folder, bool overwrite = false);
}

#endif
