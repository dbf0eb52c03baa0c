// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_VirtualStudy_h
#define mammoray_Validation_VirtualStudy_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Study/StudyAnswers.h"

#include <array>
#include <cstdint>
#include <string>

namespace mammoray
{
/// Makers whose headers a virtual MRI can have: descriptions, scan options, how phases are stored.
/// "siemens": a series for each phase, fat suppression in the scan options; "ge": "Ph0/Ax VIBRANT";
/// "philips": all phases in one series, with a temporal position.
inline constexpr std::array<const char*, 3> Scanners{ "siemens", "ge", "philips" };

struct VirtualStudyOptions
{
  /// Of everything that is drawn below; it gives the same numbers on every machine.
  std::uint32_t Seed = 1;
  /// The patient's own breast, 'L' or 'R'; phantoms of the other side are mirrored.
  char Laterality = 'L';
  /// T1 without and with fat suppression; at least one.
  bool Plain = true;
  bool FatSuppressed = true;
  /// The other breast, a mirrored copy, is in the field of view, too.
  bool BothBreasts = true;
  /// One of Scanners; empty: chosen by the seed.
  std::string Scanner;
  /// Voxels of the MRI: in plane and along the body, mm.
  double MriPixelMm = 1.0;
  double MriSliceMm = 2.0;
  /// Signal of fat over the standard deviation of the noise, in the middle of the breast.
  double SignalToNoise = 30;
  /// Pixels of the mammograms, mm, and their noise relative to the intensity.
  double MammogramPixelMm = 0.2;
  double MammogramNoise = 0.02;
  /// Edge of a cube with the breast's volume over the cell size of the mechanics: under gravity and
  /// between the plates.
  double GravityFineness = 7;
  double CompressionFineness = 9;
  /// Upper bound of the cells of the X-rayed anatomy, mm.
  double AnatomyMm = 5.5;
  /// Width of the chest that is added around a breast cut out of a body, in its mechanics and in
  /// its MRI, mm (SurroundByChest).
  double ChestAroundMm = 0;
  /// The plates close until the paddle presses with this force, N, but not below 0.4 of the
  /// breast's height; 0: only to the height that was drawn. In 560 women the force was 49 to 186 N
  /// (Radiology 181, 355 (1991)).
  double LeastForceN = 0;
  std::string Spectrum = "W30kVp_Rh50um_Be1mm";
  int NumberOfPoints = 100;
  /// Number of projections of a tomosynthesis of the CC's compression, over SpanDeg about an axis
  /// TomosynthesisAxisMm above the receptor; together they have the dose of one mammogram. Less
  /// than 2: none. They are written to FOLDER/cc-projections.dcm, beside the export.
  int Projections = 0;
  double SpanDeg = 25;
};

/// Height over the receptor of the axis about which the source turns, mm: 40 in the GE SenoClaire,
/// 0 to 50 in others (Sechopoulos, Med. Phys. 40, 014301, 2013).
inline constexpr double TomosynthesisAxisMm = 40;
inline constexpr const char* StudyProjectionsFile = "cc-projections.dcm";

/**
 * Makes a clinic's export with known truth from a label phantom: FOLDER/export, files as a clinic
 * gives them, and FOLDER/truth.json beside it.
 *
 * The stress-free phantom, bent onto a rib cage, gets stiffness from the seed: fat, gland and skin
 * each half to twice the table's; it glides along the chest wall against 0.015 to 0.06 kPa / mm. It
 * hangs under gravity on one mesh and is written as MRI of a prone patient: with the chest wall,
 * ribs and lung behind it and the other breast beside it, coil sensitivity that falls with depth,
 * Rician noise, partial volume; T1 with and without fat suppression among a localizer, a T2, a
 * phase after contrast, its subtraction and its projection. It is compressed standing on a finer
 * mesh, with the paddle tilted by 2 degrees, the unit square on the chest wall behind the breast
 * and pressed towards it until 86 % of the points lie in front of the receptor's edge, or by 3 mm,
 * with the breast in the middle of the receptor to 10 mm. The plates stand at most 8 mm above or
 * below its middle, and close from where they touch nothing. It is X-rayed as CC and MLO, on a
 * field of 24 x 18 cm or, if that cuts the breast off at its front, 30 x 24: For Presentation (12
 * bits, a display curve), with noise, another spectrum than the default, and a header whose
 * thickness is off by up to 4 mm.
 *
 * `materials`: indices of `table`, some held, in a frame with these `axes`. Throws InputError, also
 * if they hold two breasts (MidlineBetweenBreasts) or FOLDER is not empty; ConvergenceError if
 * there is no equilibrium for three thicknesses; DeviceError, Interrupted.
 */
StudyTruth MakeVirtualStudy(const LabelVolume& materials, const MaterialTable& table,
  const AnatomicalAxes& axes, const VirtualStudyOptions& options, const std::string& folder,
  const ProgressCallback& progress = {});
}

#endif
