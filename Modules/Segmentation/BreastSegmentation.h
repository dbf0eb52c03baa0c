// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastSegmentation_h
#define mammoray_BreastSegmentation_h

#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoraySegmentationModule.h"

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

struct MAMMORAYSEGMENTATION_EXPORT SegmentationOptions
{
  /// Where left, front and head are in the volume frame.
  AnatomicalAxes Axes;
  /// The patient's own left or right; one of them needs a volume with two breasts.
  BreastSide Side = BreastSide::Both;
  /// Voxel size of the result along all axes, mm; 0 keeps the grid of the MRI.
  double SpacingMm = 1.0;
  /// Thickness of the layer below the air that becomes skin, mm; 0: none. Two voxels by default,
  /// which meshes need; measured skin has 1.45 mm on average (Huang et al. 2008).
  double SkinThicknessMm = 2.0;
  /// How far the result reaches behind the front of the chest wall, mm; positive.
  double ChestWallDepthMm = 30.0;
  /// Intensity classes of the breast, 2 to 5; the brightest is fat, all others are gland.
  int Classes = 2;
  /// Intensity of the MRI below which voxels that reach the front are air; 0: by Otsu's method.
  double AirThreshold = 0.0;
  /// Fraction of fat's intensity below which the breast is gland, (0, 1); 0: by Otsu's method.
  double GlandThreshold = 0.0;
  /// Smaller parts of gland become fat, mm^3.
  double SmallestGlandMm3 = 10.0;
  /// False: the intensities are even already.
  bool CorrectBias = true;

  /// Throws InputError that names the option and its range.
  void Validate() const;
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
  /// One or two.
  int Breasts = 0;
};

/**
 * Air, skin, fat, gland and chest wall of a plain T1-weighted breast MRI: prone, fat bright (no fat
 * suppression), air in front of the breast, muscle behind it.
 *
 * - Air: what lies below Otsu's threshold of the logarithm (Otsu 1979) and reaches the volume's
 * front without crossing tissue; later refined to half of muscle's intensity. What lies behind 20
 * mm of tissue is body, however dark.
 * - Bias field: N4 (Tustison et al. 2010) in the body, then twice in the fat of the breast.
 * - Chest wall: of the dark tissue without its thin strands the part that covers most of the back,
 *   seen from the front; its front is a smooth height over the coronal plane, from which bumps
 *   narrower than 50 mm, that is gland that lies against the muscle, are taken off. Everything
 *   behind that surface is chest wall, down to the coronal plane ChestWallDepthMm behind the front
 *   of the chest wall (its 90th percentile); what lies farther back is left out, as air.
 * - Gland: darker than Otsu's threshold in the breast together with the muscle next to it, so that
 *   a breast of almost only fat has a dark class too.
 * - Skin: by distance from air, see AddSkin; the cut planes have none.
 *
 * Throws InputError on an unusable volume or option, on a breast that stands out less than 15 mm
 * and where a side is asked for and one breast found; ConvergenceError where a filter fails.
 */
MAMMORAYSEGMENTATION_EXPORT SegmentationResult SegmentBreast(const IntensityVolume& image,
  const SegmentationOptions& options, const ProgressCallback& progress = {});
}

#endif
