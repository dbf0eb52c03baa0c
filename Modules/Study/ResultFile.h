// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ResultFile_h
#define mammoray_ResultFile_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
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
/// Name of the file that makes a folder a result folder; it is written last.
inline constexpr const char* ResultFileName = "result.json";
/// Its "formatVersion", for both kinds; raised whenever a field changes its meaning or is added.
inline constexpr int ResultFormatVersion = 5;

/// Roles by which inputs are looked up.
inline constexpr const char* MammogramRole = "Mammogram";
/// Of a study, too, whose MRI was segmented if there is none.
inline constexpr const char* LabelRole = "Label volume";
inline constexpr const char* MaterialTableRole = "Material table";

/// One parameter of the search: its bounds and its value, in its unit.
struct ResultParameter
{
  std::string Name;
  std::string Unit;
  double Value = 0;
  /// Standard deviation by the covariance at the solution; NaN if it is unknown.
  double StandardDeviation = std::numeric_limits<double>::quiet_NaN();
  double Start = 0;
  double Lower = 0;
  double Upper = 0;
  bool Fixed = false;
  bool AtBound = false;
};

/// A further projection of a tomosynthesis.
struct ResultProjection
{
  /// Focal spot, gantry frame, mm.
  Vector3 FocalSpotMm{ 0, 0, 0 };
  Similarity After;
};

/// Scatter in the synthetic mammogram.
struct ResultScatter
{
  /// "none" or "kernels". If it is "none", the other fields are unused.
  std::string Method = "none";
  double AirGapMm = 0;
  /// Anti-scatter grid: ratio (0 without a grid), lines per cm, thickness of a septum in um.
  std::array<double, 3> Grid{ 0, 0, 0 };
  /// "fibre", "air" or "aluminium".
  std::string Interspace = "fibre";
};

struct ResultInput
{
  /// "Label volume" or, for a study, "MRI", "MRI without fat suppression" and "MRI with fat
  /// suppression"; "Material table", "Mammogram", "MRI" beside labels, "Lesions", "Anatomy mesh" or
  /// "Simulation mesh".
  std::string Role;
  /// ShownName; of a series its description.
  std::string File;
  /// Sha256OfFile, or Sha256OfFiles for an MRI.
  std::string Sha256;
};

/**
 * The result of one registered mammogram as in result.json (Data/result.schema.json). Points
 * and directions are in the frame of the label volume unless the gantry frame is stated; mm and
 * degrees.
 */
struct ResultFile : ViewFigures
{
  /// The folder it was read from, which contains the meshes too; not in the file.
  std::string Folder;
  AnatomicalAxes Axes;
  /// Point that the pose refers to (FindPoseFrame).
  Vector3 Anchor{ 0, 0, 0 };
  /// All PoseParameters, in their order; their values are the pose.
  std::vector<ResultParameter> Parameters;
  /// The mammogram's pixels.
  ReceptorGrid Grid;
  MammographyUnit Unit;
  /// Further projections; empty unless the mammogram is the middle one of a tomosynthesis.
  std::vector<ResultProjection> Projections;
  /// Wall time by stage of the whole case, s.
  std::vector<std::pair<std::string, double>> Timings;
  /// The mechanical state between the plates.
  EquilibriumMeasures Compression;
  /// The mammogram as the search knew it, without pixels and fields that are not in the file.
  mammoray::Mammogram Mammogram;
  /// Share of the breast's pixels that were not compared, [0, 1].
  double ShareExcluded = 0;
  std::vector<std::string> Warnings;
  /// See RegistrationCaseResult. Empty of results of builds that did not keep them.
  std::vector<std::string> Notes;
  std::vector<ResultInput> Inputs;
  /// Name of a shipped spectrum, or of another one's file.
  std::string Spectrum;
  ResultScatter Scatter;
  /// Software, device and meshes with their version or size.
  std::vector<std::pair<std::string, std::string>> Versions;
};

/// The result of several mammograms of one breast that were registered together.
struct JointResultFile
{
  /// Summary of one mammogram; its whole result is in its own folder.
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
  /// A free parameter of one mammogram or of all.
  struct Unknown
  {
    std::string Name;
    std::string Unit;
    /// Folder of the mammogram it belongs to; nothing if all share it.
    std::optional<std::string> Folder;
    double Value = 0;
    double StandardDeviation = std::numeric_limits<double>::quiet_NaN();
  };
  std::vector<Registered> Mammograms;
  std::vector<Unknown> Unknowns;
  /// The covariance of the unknowns, row by row; empty if unknown.
  std::vector<double> Covariance;
  bool Converged = false;
  std::string StopReason;
  double Seconds = 0;
};

/// Writes result.json into a folder. Throws InputError if it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteResultFile(const ResultFile& result, const std::string& folder);
MAMMORAYSTUDY_EXPORT void WriteResultFile(const JointResultFile& result, const std::string& folder);

/**
 * Reads the result of one mammogram. Throws InputError, one line that names the file and, if its
 * version is another one or it is damaged, the field, the expected value and the one found. For a
 * joint result the message names a folder to give instead.
 */
MAMMORAYSTUDY_EXPORT ResultFile ReadResultFile(const std::string& folder);

/// Reads a joint result. Throws as ReadResultFile.
MAMMORAYSTUDY_EXPORT JointResultFile ReadJointResultFile(const std::string& folder);

/// Reads the results of all mammograms of a folder: its own, or those of a joint result in its
/// order. Throws as ReadResultFile.
MAMMORAYSTUDY_EXPORT std::vector<ResultFile> ReadResultFiles(const std::string& folder);
}

#endif
