// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Valley_h
#define mammoray_Valley_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/// Between two breasts.
struct Valley
{
  /// Below the lower of the two, mm; 0: none.
  double DepthMm = 0;
  /// Its middle, x, mm: what is within 3 mm of its lowest place.
  double MiddleMm = 0;
};

/**
 * The deepest valley of the body's front seen from head or feet: the air line over the sternum.
 * Heights over the coronal plane, mm; columns with their skin behind the wall or the cut have none.
 */
MAMMORAYSEGMENTATION_EXPORT Valley DeepestValley(const HeightMap* skin, const HeightMap* wall,
  double cutMm);
}

#endif
