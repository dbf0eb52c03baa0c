// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastSegmentation_h
#define mammoray_BreastSegmentation_h

#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoraySegmentationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Labels of SegmentBreast, those of the built-in material table "segment".
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

/// What fat is like in a T1-weighted image: bright, or dark where it is suppressed.
enum class FatContrast
{
  Auto,
  FatBright,
  FatDark
};

struct MAMMORAYSEGMENTATION_EXPORT SegmentationOptions
{
  /// Where left, front and head are in the volume frame.
  AnatomicalAxes Axes;
  /// The patient's own left or right; one of them needs a volume with two breasts.
  BreastSide Side = BreastSide::Both;
  /// Of the image, where one is given; Auto finds out.
  FatContrast Contrast = FatContrast::Auto;
  /// Voxel size of the result along all axes, mm; 0 keeps the grid of the MRI.
  double SpacingMm = 1.0;
  /// Thickness of the layer below the air that becomes skin, mm; 0: none. Two voxels by default,
  /// which meshes need; measured skin has 1.45 mm on average (Huang et al. 2008).
  double SkinThicknessMm = 2.0;
  /// How far the result reaches behind the front of the chest wall, mm; positive.
  double ChestWallDepthMm = 30.0;
  /// Intensity classes of the breast, 2 to 5; the brightest (fat dark: the darkest) is fat, all
  /// others are gland.
  int Classes = 2;
  /// Intensity of the MRI below which voxels that reach the front are air; 0: by Otsu's method.
  double AirThreshold = 0.0;
  /// Fraction of fat's intensity below which the breast is gland, (0, 1), or, where Contrast is
  /// FatDark, above which it is, beyond 1; 0: by Otsu's method. Of two images it is that of the one
  /// on whose side of 1 it lies.
  double GlandThreshold = 0.0;
  /// Smaller parts of gland become fat, mm^3.
  double SmallestGlandMm3 = 10.0;
  /// False: the intensities are even already.
  bool CorrectBias = true;
  /// What no patient's MRI has (Plausible::VoxelSpacing) is taken, too.
  bool AcceptUnusual = false;

  /// Throws InputError that names the option and its range.
  void Validate() const;
};

/// What was found, to be judged: of all breasts of the result together.
struct BreastMeasures
{
  double FatCm3 = 0;
  double GlandCm3 = 0;
  double SkinCm3 = 0;
  double ChestWallCm3 = 0;
  /// Gland in fat, gland and skin, [0, 1].
  double GlandFraction = 0;
  /// How far the skin lies before the chest wall (99th percentile over the coronal plane), mm.
  double DepthMm = 0;
  /// Gland's median intensity over muscle's; near 1 in T1, where both relax alike. 0: no gland.
  double GlandOverMuscle = 0;
};

struct SegmentationResult
{
  /// TissueLabel values; axes as the MRI's.
  LabelVolume Labels;
  /// The MRI on the grid of Labels after bias correction; fat is 1.
  IntensityVolume Corrected;
  /// What was used: intensity of the MRI, and fraction of fat's intensity.
  double AirThreshold = 0.0;
  double GlandThreshold = 0.0;
  /// Muscle's intensity as a fraction of fat's.
  double MuscleLevel = 0.0;
  /// That of the (first) image: FatBright or FatDark.
  FatContrast Contrast = FatContrast::FatBright;
  /// One or two.
  int Breasts = 0;
  BreastMeasures Measures;
  /// What is unusual but possible, a line each, with its figure; empty: nothing.
  std::vector<std::string> Warnings;
};

/**
 * Air, skin, fat, gland and chest wall of a T1-weighted breast MRI: prone, air in front of the
 * breast, muscle behind it; fat bright (plain) or dark (SPAIR, SPIR, Dixon water).
 *
 * - Air: what lies below Otsu's threshold of the logarithm (Otsu 1979), or is noise as loud as its
 *   surroundings', and reaches the volume's front without crossing tissue; later refined to what is
 *   half as bright as the skin nearby.
 * - Chest wall: one smooth sheet, a height over the coronal plane, in front of which lies fat and
 *   behind which muscle (see Private/ChestWall.h). Everything of the body behind it is chest wall,
 *   down to the coronal plane ChestWallDepthMm behind its front (the 90th percentile); what lies
 *   farther back is left out, as air.
 * - Coil: the intensity of the breast's fat, a smooth function, by which the image is divided.
 * - Gland: beyond Otsu's threshold in the breast together with the muscle next to it, so that a
 *   breast of almost only fat has a second class too; darker than fat or brighter, as the contrast
 *   says. What lies mostly within a few mm of chest wall or skin is muscle or skin, not gland.
 * - Skin: by distance from air, see AddSkin; the cut planes have none.
 *
 * Throws InputError on an unusable volume or option, on a breast that stands out less than 15 mm,
 * on volumes that no breast has (see Private/Plausibility.h) and where a side is asked for and one
 * breast found; ConvergenceError where a filter fails.
 */
MAMMORAYSEGMENTATION_EXPORT SegmentationResult SegmentBreast(const IntensityVolume& image,
  const SegmentationOptions& options, const ProgressCallback& progress = {});

/**
 * The same from two images of one session, without and with fat suppression: the outline from the
 * first, chest wall and gland from both. The second is resampled onto the first by the frame they
 * share; that the patient moved between them is not looked for.
 */
MAMMORAYSEGMENTATION_EXPORT SegmentationResult SegmentBreast(const IntensityVolume& plain,
  const IntensityVolume& fatSuppressed, const SegmentationOptions& options,
  const ProgressCallback& progress = {});
}

#endif
