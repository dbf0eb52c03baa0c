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
  /// Height y of the front of the chest wall over every coronal voxel (x, z), mm; beside the body
  /// its smooth continuation.
  HeightMap::Pointer Front;
  /// The stiff plate next to which it was found.
  HeightMap::Pointer Stiff;
  /// Median step from fat to muscle along the sheet where a breast stands before it, 30 mm of body;
  /// of several channels their mean. 0: no breast.
  double Step = 0;
  /// Sum of the steps there over the columns.
  double Support = 0;
  /// The step from fat to muscle in every column; 0 where there is none.
  HeightMap::Pointer Steps;
  /// What the tenth of those columns with the largest steps has at least.
  double LargeStep = 0;
};

/**
 * The front of muscle and ribs as one smooth sheet in front of which lies fat and behind which
 * muscle.
 *
 * `channels` are images on one grid of cubes that fall by up to about 1 from fat to muscle. In each
 * column along y the step from the mean of the 6 mm in front of a height to that of the 6 mm behind
 * it says how well the height fits. The surface of least cost over all columns is found by dynamic
 * programming along x and z both ways (semi-global matching: Hirschmueller, IEEE PAMI 30, 2008)
 * with a price on slopes. Gland has fronts like that too, but none that continue over breasts,
 * sternum and sides: the sheet is looked for again near a stiff plate (220 mm) through the first,
 * then near one whose shape is a paraboloid, as the thorax falls back to the sides, and the plate
 * of 20 mm through that is the answer (see FitRobustPlate).
 *
 * `body`: what air does not reach from the front; `tissue`: what is brighter than noise.
 */
MAMMORAYSEGMENTATION_EXPORT ChestWallSheet FindChestWall(
  const std::vector<FloatImage::Pointer>& channels, const MaskImage* body, const MaskImage* tissue);

/**
 * The same near a sheet that is known about. The channels are 1 in fat and 0 in all else, lung
 * included, so that fat behind the sheet speaks against it too: behind gland there is fat, behind
 * muscle hardly.
 */
MAMMORAYSEGMENTATION_EXPORT ChestWallSheet RefineChestWall(
  const std::vector<FloatImage::Pointer>& fatness, const MaskImage* body, const MaskImage* tissue,
  const HeightMap* near);

/**
 * A channel from an image as scanned: its logarithm, averaged over 2 mm of body, falling from fat
 * to muscle. The coil's sensitivity, which changes by a few per cent over 6 mm, does not matter.
 * `floor` is added before the logarithm is taken, so that noise counts little.
 */
MAMMORAYSEGMENTATION_EXPORT FloatImage::Pointer LogChannel(const FloatImage* image,
  const MaskImage* body, double floor, bool fatBright);

/// From where to where behind a sheet, and the body before it that makes a column count; mm.
struct Behind
{
  double FromMm;
  double ToMm;
  double BodyMm;
};

/**
 * The values of the tissue there, in columns where the sheet has at least half of its large step:
 * a sheet that could not follow the chest wall as it recedes at the sides has fat behind it.
 */
MAMMORAYSEGMENTATION_EXPORT std::vector<float> BehindSheet(const FloatImage* image,
  const MaskImage* tissue, const HeightMap* skin, const ChestWallSheet& sheet,
  const Behind& behind);

/// The body farther than `apartMm` from the air and before the sheet, and before the coronal plane
/// at `cutMm`.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer BeforeSheet(const MaskImage* body,
  const ChestWallSheet& sheet, double apartMm, double cutMm);

/// Height, mm, of the front face of the foremost voxel of the mask in each column; -1: none.
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer FrontOf(const MaskImage* mask);

/// The heights over the columns of another image of the same frame: bilinear, nearest outside.
MAMMORAYSEGMENTATION_EXPORT HeightMap::Pointer HeightsOver(const HeightMap* map,
  const itk::ImageBase<3>& image);
}

#endif
