// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ChestWall_h
#define mammoray_ChestWall_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

#include <vector>

namespace mammoray
{
struct ChestWallSheet
{
  /// Height y of the front of the chest wall over every coronal voxel (x, z), mm. Outside the body
  /// it continues smoothly.
  HeightMap::Pointer Front;
  /// The stiff plate near which the front was searched.
  HeightMap::Pointer Stiff;
  /// Median step from fat to muscle along the sheet where at least 30 mm of body lie in front of
  /// it; the mean over several channels. 0 without a breast.
  double Step = 0;
  /// Step from fat to muscle in every column; 0 where there is none.
  HeightMap::Pointer Steps;
  /// 90th percentile of the steps in these columns.
  double LargeStep = 0;
};

/**
 * Finds the front of muscle and ribs as one smooth sheet with fat in front and muscle behind.
 *
 * `channels` are images on one grid of cubic voxels that decrease by up to about 1 from fat to
 * muscle. In each column along y, the quality of a height is the step from the mean over the 6 mm
 * in front of it to the mean over the 6 mm behind it. The surface of least cost over all columns is
 * found by dynamic programming along x and z in both directions (semi-global matching:
 * Hirschmueller, IEEE PAMI 30, 2008) with a penalty on slopes. Gland has similar fronts, but none
 * that continue over breasts, sternum and sides. The search is therefore repeated near a stiff
 * plate (220 mm) through the first sheet, then near a plate that tends to a paraboloid, as the
 * thorax recedes at the sides. The result is the plate of 20 mm through the last sheet (see
 * FitRobustPlate).
 *
 * `body` is what air does not reach from the front; `tissue` is brighter than noise.
 */
MAMMORAYSEGMENTATION_EXPORT ChestWallSheet FindChestWall(
  const std::vector<FloatImage::Pointer>& channels, const MaskImage* body, const MaskImage* tissue);

/// Refines a known sheet. The channels are 1 in fat and 0 elsewhere, including lung, so that fat
/// behind the sheet counts against it: there is fat behind gland, but hardly any behind muscle.
MAMMORAYSEGMENTATION_EXPORT ChestWallSheet RefineChestWall(
  const std::vector<FloatImage::Pointer>& fatness, const MaskImage* body, const MaskImage* tissue,
  const HeightMap* near);

/// Makes a channel from a scanned image: its logarithm, averaged over 2 mm of body, decreasing from
/// fat to muscle, less its mean over 30 mm of body. That is mostly the coil's sensitivity: towards
/// the back it falls by as much over 6 mm as suppressed fat is darker than muscle. `floor` is added
/// before the logarithm, so that noise counts little.
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer LogChannel(const FloatImage* image,
  const MaskImage* body, double floor, bool fatBright);

/// A layer behind a sheet, and the thickness of body in front that a column needs to count; mm.
struct Behind
{
  double FromMm;
  double ToMm;
  double BodyMm;
};

/// Intensities of tissue in this layer, in columns where the sheet has at least half of its large
/// step. A sheet that did not follow the chest wall as it recedes at the sides has fat behind it.
MAMMORAYSEGMENTATION_EXPORT std::vector<float> BehindSheet(const FloatImage* image,
  const MaskImage* tissue, const HeightMap* skin, const ChestWallSheet& sheet,
  const Behind& behind);

/// The body farther than `apartMm` from the air, in front of the sheet and of the coronal plane at
/// `cutMm`.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer BeforeSheet(const MaskImage* body,
  const ChestWallSheet& sheet, double apartMm, double cutMm);

/// Height of the front face of the foremost voxel of the mask in each column, mm; -1 if there is
/// none.
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FrontOf(const MaskImage* mask);

/// Interpolates the heights bilinearly at the columns of another image in the same frame; outside,
/// the nearest value is used.
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer HeightsOver(const HeightMap* map,
  const itk::ImageBase<3>& image);
}

#endif
