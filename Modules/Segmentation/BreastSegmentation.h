// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastSegmentation_h
#define mammoray_BreastSegmentation_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoraySegmentationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Labels of SegmentBreast; those of the built-in material table "segment".
enum class TissueLabel : std::uint16_t
{
  Air = 0,
  Fat = 1,
  Gland = 2,
  Skin = 3,
  ChestWall = 4
};

enum class BreastSide
{
  Both,
  Left,
  Right
};

/// Appearance of fat in a T1-weighted image: bright, or dark if it is suppressed.
enum class FatContrast
{
  Auto,
  FatBright,
  FatDark
};

struct MAMMORAYSEGMENTATION_EXPORT SegmentationOptions
{
  /// Directions of left, front and head in the volume frame.
  AnatomicalAxes Axes;
  /// The patient's own left or right; a single side requires a volume with two breasts.
  BreastSide Side = BreastSide::Both;
  /// Contrast of the image, if there is only one; Auto determines it.
  FatContrast Contrast = FatContrast::Auto;
  /// Voxel size of the result along all axes, mm; 0 keeps the grid of the MRI.
  double SpacingMm = 1.0;
  /// Thickness of the layer below the air that becomes skin, mm; 0 for none. The default is two
  /// voxels, which meshes need. Measured skin is 1.45 mm thick on average (Huang et al. 2008).
  double SkinThicknessMm = 2.0;
  /// Depth of the result behind the front of the chest wall, mm; positive.
  double ChestWallDepthMm = 30.0;
  /// Number of intensity classes of the breast, 2 to 5. The brightest (if fat is dark: the darkest)
  /// is fat; all others are gland.
  int Classes = 2;
  /// MRI intensity below which voxels connected with the front are air; 0 selects it by Otsu's
  /// method.
  double AirThreshold = 0.0;
  /// Threshold of gland as a fraction of fat's intensity. Gland is below it, in (0, 1), if fat is
  /// bright, and above it, beyond 1, if fat is dark. 0 selects it by Otsu's method. With two images
  /// it applies to the one whose side of 1 it is on.
  double GlandThreshold = 0.0;
  /// Parts of gland below this volume become fat, mm^3.
  double SmallestGlandMm3 = 10.0;
  /// Set to false if the intensities are already uniform.
  bool CorrectBias = true;
  /// If true, voxel spacings outside ValidRanges::VoxelSpacing are accepted.
  bool AcceptUnusual = false;

  /// Throws InputError with the option and its range.
  void Validate() const;
};

/// Measures of the result, of all its breasts together.
struct BreastMeasures
{
  double FatCm3 = 0;
  double GlandCm3 = 0;
  double SkinCm3 = 0;
  double ChestWallCm3 = 0;
  /// Fraction of gland in fat, gland and skin, [0, 1].
  double GlandFraction = 0;
  /// Distance of the skin from the chest wall (99th percentile over the coronal plane), mm.
  double DepthMm = 0;
  /// Median intensity of gland divided by that of muscle; near 1 in T1, where both have similar
  /// relaxation. 0 without gland.
  double GlandOverMuscle = 0;
};

/**
 * How well one breast's borders show in the image. "Columns" are those along the posterior
 * direction through the breast; fractions are in [0, 1].
 */
struct BreastQuality
{
  /// Both if the volume shows one breast.
  BreastSide Side = BreastSide::Both;
  /// Fraction of the columns in which the image shows the chest wall's front: intensities fall
  /// there by at least a fifth of the difference between fat and muscle.
  double WallSeen = 0;
  /// Fraction of the columns in which two ways to find the front agree within 4 mm: one uses the
  /// logarithm of the scanned image, the other the image after the coil's correction.
  double WallAgreement = 0;
  /// Fraction of the columns in which the skin's surroundings are at least three times as bright as
  /// noise; elsewhere the outline is extrapolated.
  double SkinSeen = 0;
  /// What is doubtful and why, in one line; empty if the borders show well.
  std::string Doubt;
};

struct SegmentationResult
{
  /// TissueLabel values; the axes are those of the MRI.
  LabelVolume Labels;
  /// The MRI on the grid of Labels after bias correction; fat is 1.
  IntensityVolume Corrected;
  /// The thresholds used: MRI intensity, and fraction of fat's intensity.
  double AirThreshold = 0.0;
  double GlandThreshold = 0.0;
  /// Intensity of muscle as a fraction of fat's.
  double MuscleLevel = 0.0;
  /// Contrast of the (first) image: FatBright or FatDark.
  FatContrast Contrast = FatContrast::FatBright;
  /// Number of breasts: 1 or 2.
  int Breasts = 0;
  BreastMeasures Measures;
  /// One per breast of the result, right before left.
  std::vector<BreastQuality> Quality;
  /// Doubts about the quality, then unusual but possible findings with their values, one line each.
  std::vector<std::string> Warnings;
};

/**
 * Segments air, skin, fat, gland and chest wall in a T1-weighted breast MRI. The patient lies
 * prone, with air in front of the breast and muscle behind it. Fat is bright (plain) or dark
 * (SPAIR, SPIR, Dixon water).
 *
 * - Air: voxels that are more probably noise than tissue, given their neighbours (a Markov random
 *   field, see Private/Outline.h), connected with the volume's front without crossing tissue. Where
 *   tissue is clearly brighter than noise, the border is then refined to half the brightness of the
 *   skin nearby. Axial planes at either end without enough signal become air.
 * - Chest wall: one smooth sheet, a height over the coronal plane, with fat in front and muscle
 *   behind (see Private/ChestWall.h). Everything behind it within the body, lung included, is chest
 *   wall, down to the coronal plane ChestWallDepthMm behind its front (the 90th percentile).
 *   Everything farther back becomes air.
 * - Coil: the image is divided by the intensity of the breast's fat, a smooth function.
 * - Gland: voxels beyond Otsu's threshold. It is computed in the breast together with the adjacent
 *   muscle, so that a breast of almost pure fat has a second class, too. Gland is darker or
 *   brighter than fat, according to the contrast. Parts that lie mostly within a few millimetres of
 *   chest wall or skin are muscle or skin. Suppressed fat that is much brighter than muscle and
 *   reaches the skin is fat whose suppression failed.
 * - Skin: by the distance from air (see AddSkin); the cut planes have none.
 *
 * Throws InputError on an unusable volume or option, on a breast less than 15 mm high, on volumes
 * that no breast has (see Private/Plausibility.h), and if a side is requested but one breast is
 * found; ConvergenceError if a filter fails.
 */
MAMMORAYSEGMENTATION_EXPORT SegmentationResult SegmentBreast(const IntensityVolume& image,
  const SegmentationOptions& options, const ProgressCallback& progress = {});

/// Segments two images of one session, without and with fat suppression: the outline comes from the
/// first, chest wall and gland from both. The second image is resampled to the first in their
/// common frame; motion between the images is not corrected.
MAMMORAYSEGMENTATION_EXPORT SegmentationResult SegmentBreast(const IntensityVolume& plain,
  const IntensityVolume& fatSuppressed, const SegmentationOptions& options,
  const ProgressCallback& progress = {});
}

#endif
