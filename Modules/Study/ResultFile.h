// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ResultFile_h
#define mammoray_ResultFile_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammorayStudyModule.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// The name of the file that ends a result folder, and by which such a folder is known.
inline constexpr const char* ResultFileName = "result.json";
/// Its "formatVersion": of both kinds, raised whenever a field changes its meaning or is added.
inline constexpr int ResultFormatVersion = 5;

/// Roles of the inputs that are asked for by them.
inline constexpr const char* MammogramRole = "Mammogram";
inline constexpr const char* MaterialTableRole = "Material table";

/// One unknown of the search: what was allowed and what was found, in its unit.
struct ResultParameter
{
  std::string Name;
  std::string Unit;
  double Value = 0;
  /// One standard deviation by the covariance at the solution; NaN where it is not known.
  double StandardDeviation = std::numeric_limits<double>::quiet_NaN();
  double Start = 0;
  double Lower = 0;
  double Upper = 0;
  bool Fixed = false;
  bool AtBound = false;
};

/// The mechanical state between the plates; see CompressionState.
struct ResultCompression
{
  double PaddleForceN = 0;
  double SupportForceN = 0;
  double LargestWallGlideMm = 0;
  /// See ViewResult.
  double OtherEquilibriumMm = 0;
  double VolumeRatio = 1;
  double SmallestJ = 1;
  double LargestJ = 1;
  double LargestPenetrationMm = 0;
  double RelativeResidual = 0;
};

/// A further projection of a tomosynthesis.
struct ResultProjection
{
  /// Of its focal spot, gantry frame.
  Vector3 FocalSpotMm{ 0, 0, 0 };
  Similarity After;
};

/// What scattered onto the synthetic mammogram.
struct ResultScatter
{
  /// "none" or "kernels"; of none the others mean nothing.
  std::string Method = "none";
  double AirGapMm = 0;
  /// Of the grid: ratio, lines per cm, micrometres of a septum; a ratio of 0: none.
  std::array<double, 3> Grid{ 0, 0, 0 };
  /// "fibre", "air" or "aluminium".
  std::string Interspace = "fibre";
};

struct ResultInput
{
  /// "Label volume" or, of a study, "MRI", "MRI without fat suppression" and "MRI with fat
  /// suppression"; "Material table", "Mammogram", "MRI" of labels, "Lesions", "Anatomy mesh" or
  /// "Simulation mesh".
  std::string Role;
  /// ShownName; of a series its description.
  std::string File;
  /// Sha256OfFile; of an MRI, Sha256OfFiles.
  std::string Sha256;
};

/**
 * What result.json says of one registered mammogram. Points and directions are those of the label
 * volume's frame unless they are said to be of the gantry frame; mm and degrees.
 * docs/result-file.md is the format.
 */
struct ResultFile
{
  /// The folder it was read from, which holds the meshes too; not in the file.
  std::string Folder;

  Assessment Trust;
  AnatomicalAxes Axes;
  /// What the pose refers to (FindPoseAnchor).
  Vector3 Anchor{ 0, 0, 0 };
  /// What the parameters below say; the file holds them only.
  BreastPose Pose;
  /// All PoseParameters, in their order, and covariances of them in that order, row by row; empty
  /// where they are not known. See ViewResult.
  std::vector<ResultParameter> Parameters;
  std::vector<double> Covariance;
  std::vector<double> ConsideredCovariance;
  /// The mammogram's pixels.
  ReceptorGrid Grid;
  VolumeFromGantry Placed;
  MammographyUnit Unit;
  Similarity After;
  /// Beside the mammogram above, which is the middle one; empty unless it is a tomosynthesis.
  std::vector<ResultProjection> Projections;
  RegistrationMisfit Misfit;
  /// NaN where it is not known.
  ExpectedError Expected{ std::numeric_limits<double>::quiet_NaN(),
    std::numeric_limits<double>::quiet_NaN() };
  bool Converged = false;
  std::string StopReason;
  int Evaluations = 0;
  /// Wall time of the search, and of each stage of the whole case, s.
  double Seconds = 0;
  std::vector<std::pair<std::string, double>> Timings;
  std::vector<RegistrationIteration> Iterations;
  ResultCompression Compression;
  /// The mammogram as the search knew it: of its header what the file holds, without pixels.
  mammoray::Mammogram Mammogram;
  /// Share of the breast's picture that was left out of the comparison, [0, 1].
  double ShareExcluded = 0;
  std::vector<std::string> Warnings;
  std::vector<ResultInput> Inputs;
  /// Name of a shipped spectrum or path of another.
  std::string Spectrum;
  ResultScatter Scatter;
  /// What took part, and its version or size.
  std::vector<std::pair<std::string, std::string>> Versions;
};

/// What result.json says of several mammograms of one breast that were registered together.
struct JointResultFile
{
  /// In short, one of the mammograms; all that is known of it is in its own folder.
  struct Registered
  {
    /// Its folder within that of the joint result.
    std::string Folder;
    std::string View;
    char Laterality = '?';
    Trust Level = Trust::Good;
    double Correlation = 0;
    double MeanOutlineDistanceMm = 0;
  };
  /// A free parameter, of one mammogram or of all.
  struct Unknown
  {
    std::string Name;
    std::string Unit;
    /// The folder of the mammogram it belongs to; nothing where all share it.
    std::optional<std::string> Folder;
    double Value = 0;
    double StandardDeviation = std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<Registered> Mammograms;
  std::vector<Unknown> Unknowns;
  /// The covariance of the unknowns, row by row; empty where it is not known.
  std::vector<double> Covariance;
  bool Converged = false;
  std::string StopReason;
  double Seconds = 0;
};

/// Write result.json into a folder. Throw InputError when it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteResultFile(const ResultFile& result, const std::string& folder);
MAMMORAYSTUDY_EXPORT void WriteResultFile(const JointResultFile& result, const std::string& folder);

/**
 * Reads the result of one mammogram. Throws InputError, one line, that names the file and, where it
 * is of another version or damaged, the field, what was expected there and what was found; for a
 * joint result it names the folders of which one is to be given.
 */
MAMMORAYSTUDY_EXPORT ResultFile ReadResultFile(const std::string& folder);

/// Reads a joint result. Throws as ReadResultFile.
MAMMORAYSTUDY_EXPORT JointResultFile ReadJointResultFile(const std::string& folder);

/// Reads the results of all mammograms of a folder: that of the folder itself, or those within a
/// joint one, in its order. Throws as ReadResultFile.
MAMMORAYSTUDY_EXPORT std::vector<ResultFile> ReadResultFiles(const std::string& folder);
}

#endif
