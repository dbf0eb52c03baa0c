// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_StudyTruth_h
#define mammoray_StudyTruth_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammorayStudyModule.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/// A mammogram of a virtual study and where it shows the points.
struct TrueView
{
  /// "CC" or "MLO".
  std::string View;
  /// Relative to the study's folder.
  std::string File;
  BreastPose Pose;
  MammographyUnit Unit;
  /// The thickness in the mammogram's header, mm.
  double HeaderThicknessMm = 0;
  double PaddleForceN = 0;
  /// For each point its position in the gantry frame, mm; its shadow on the receptor, mm (y < 0: it
  /// falls behind the receptor's edge); and continuous column and row of the image.
  std::vector<Vector3> Gantry;
  std::vector<std::array<double, 2>> Receptor;
  std::vector<std::array<double, 2>> Pixels;
};

/// The truth of a virtual study (`truth.json`).
struct StudyTruth
{
  /// The patient's own side, 'L' or 'R'.
  char Laterality = 'L';
  std::uint32_t Seed = 0;
  /// The maker whose headers the MRI has: "siemens", "ge" or "philips".
  std::string Scanner = "siemens";
  /// Names of the materials, and the factors on the table's Young's moduli.
  std::vector<std::string> Materials;
  std::vector<double> StiffnessFactors;
  std::vector<double> YoungsModuliKPa;
  /// Mean distance by which gravity moved the points, mm.
  double MeanHangMm = 0;
  /// Stiffness of the chest wall against gliding, kPa / mm.
  double GlideStiffness = 0;
  /// Points of the breast's interior: in the MRI and in the stress-free shape, DICOM LPS, mm.
  std::vector<Vector3> MriPoints;
  std::vector<Vector3> RestPoints;
  std::vector<TrueView> Views;

  /// Null if the study has no such view.
  MAMMORAYSTUDY_EXPORT const TrueView* FindView(const std::string& view) const;
};

/// Reads a truth.json. Throws InputError, one line with the file, on anything else.
MAMMORAYSTUDY_EXPORT StudyTruth ReadStudyTruth(const std::string& path);

/// Writes a file that ReadStudyTruth reads. Throws InputError where it cannot be written.
MAMMORAYSTUDY_EXPORT void WriteStudyTruth(const StudyTruth& truth, const std::string& path);
}

#endif
