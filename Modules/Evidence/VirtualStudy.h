// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VirtualStudy_h
#define mammoray_VirtualStudy_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayEvidenceModule.h"

#include <cstdint>
#include <string>
#include <vector>

namespace mammoray
{
/// Which maker's headers a virtual MRI imitates: descriptions, scan options, how phases are stored.
enum class ScannerStyle
{
  BySeed,
  Siemens, ///< a series for each phase, fat suppression in the scan options
  Ge,      ///< "Ph0/Ax VIBRANT"
  Philips  ///< all phases in one series, told apart by their temporal position
};

struct VirtualStudyOptions
{
  /// Draws everything that is drawn below; the same numbers on every machine.
  std::uint32_t Seed = 1;
  /// The patient's own breast, 'L' or 'R'; phantoms of the other side are mirrored.
  char Laterality = 'L';
  /// T1 without and with fat suppression; at least one.
  bool Plain = true;
  bool FatSuppressed = true;
  /// The other breast, a mirrored copy, is in the field of view, too.
  bool BothBreasts = true;
  ScannerStyle Style = ScannerStyle::BySeed;
  /// Voxels of the MRI: in plane and along the body, mm.
  double MriPixelMm = 1.0;
  double MriSliceMm = 2.0;
  /// Fat's signal over the deviation of the noise, in the middle of the breast.
  double SignalToNoise = 30;
  /// Pixels of the mammograms, mm, and their noise, of the intensity.
  double MammogramPixelMm = 0.2;
  double MammogramNoise = 0.02;
  /// Edge of a cube as large as the breast over the cells of the mechanics: under gravity
  /// (quadratic) and between the plates (linear, patch-averaged).
  double GravityFineness = 7;
  double CompressionFineness = 10;
  /// Upper bound of the cells of the pictured anatomy, mm.
  double AnatomyMm = 5.5;
  /// Of a breast that was cut out of a body: so much of the chest goes on around it, in its
  /// mechanics as in its MRI, mm.
  double ChestAroundMm = 0;
  /// The plates close on until the paddle presses so, N, but not below 0.4 of the height. 0: only
  /// to the height that was drawn. Of 560 women the least was 49, the most 186 (Radiology 181, 355
  /// (1991)).
  double LeastForceN = 0;
  std::string Spectrum = "W30kVp_Rh50um_Be1mm";
  int NumberOfPoints = 100;
  /// The CC's compression is pictured as a tomosynthesis, too, by so many projections over SpanDeg
  /// about an axis TomosynthesisAxisMm above the receptor, which share the dose of one mammogram;
  /// less than 2: none. FOLDER/cc-projections.dcm, beside the export.
  int Projections = 0;
  double SpanDeg = 25;
};

/// Height of the axis about which a unit's source goes, over the receptor, mm: 40 of the GE
/// SenoClaire, 0 to 50 of others (Sechopoulos, Med. Phys. 40, 014301, 2013).
inline constexpr double TomosynthesisAxisMm = 40;
inline constexpr const char* StudyProjectionsFile = "cc-projections.dcm";

/// A mammogram of a virtual study and where it has the points.
struct VirtualView
{
  std::string View;
  /// Below the study's folder.
  std::string File;
  BreastPose Pose;
  MammographyUnit Unit;
  /// What the header says, mm.
  double HeaderThicknessMm = 0;
  double PaddleForceN = 0;
  /// Of each point: gantry frame, mm; its shadow on the receptor, mm; column and row of the image.
  std::vector<Vector3> Gantry;
  std::vector<std::array<double, 2>> Receptor;
  std::vector<std::array<double, 2>> Pixels;
};

/// What is known of a virtual study; `truth.json` holds it.
struct VirtualStudyTruth
{
  char Laterality = 'L';
  std::uint32_t Seed = 0;
  ScannerStyle Style = ScannerStyle::Siemens;
  /// Factors on Young's moduli of the table, by material.
  std::vector<std::string> Materials;
  std::vector<double> StiffnessFactors;
  std::vector<double> YoungsModuliKPa;
  /// How far gravity moved the points on average, mm.
  double MeanHangMm = 0;
  /// How the chest wall holds the breast along itself, kPa / mm.
  double GlideStiffness = 0;
  /// Points of the breast's interior: in the MRI (DICOM LPS, mm) and free of load.
  std::vector<Vector3> MriPoints;
  std::vector<Vector3> RestPoints;
  std::vector<VirtualView> Views;
};

/**
 * Makes a clinic's export with known truth out of a label phantom: FOLDER/export, the files as a
 * clinic gives them, and FOLDER/truth.json beside it.
 *
 * The phantom, free of load and bent onto a rib cage, is given stiffness by the seed: fat, gland
 * and skin each half to twice the table's; it glides along the chest wall against 0.015 to 0.06 kPa
 * / mm. It hangs under gravity on one mesh (quadratic cells) and is written as MRI of a prone
 * patient: with the chest wall, ribs and lung behind it and the other breast beside it, coil
 * sensitivity that falls with depth, Rician noise, partial volume; T1 with and without fat
 * suppression among a localizer, T2, a phase after contrast, its subtraction and projection. It is
 * compressed standing, the paddle tilted by 2 degrees, on another mesh of other elements (linear,
 * patch-averaged) and X-rayed as CC and MLO, on a field of 24 x 18 cm or, where that cuts the
 * breast off at its front, 30 x 24: For Presentation (12 bits, a display curve), noise, another
 * spectrum than the default, a header whose thickness is off by up to 4 mm.
 *
 * `materials`: indices of `table`, some held, in a frame of these `axes`. Throws InputError, also
 * where FOLDER is not empty; ConvergenceError where no equilibrium was found for three drawn
 * thicknesses; DeviceError, Interrupted.
 */
MAMMORAYEVIDENCE_EXPORT VirtualStudyTruth MakeVirtualStudy(const LabelVolume& materials,
  const MaterialTable& table, const AnatomicalAxes& axes, const VirtualStudyOptions& options,
  const std::string& folder, const ProgressCallback& progress = {});

/// Reads a truth.json. Throws InputError, one line with the file, on anything else.
MAMMORAYEVIDENCE_EXPORT VirtualStudyTruth ReadVirtualStudyTruth(const std::string& path);
}

#endif
