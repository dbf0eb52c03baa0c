// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Valley_h
#define mammoray_Valley_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

namespace mammoray
{
/// The valley between two breasts.
struct Valley
{
  /// Depth below the lower of the two breasts, mm; 0 if there is none.
  double DepthMm = 0;
  /// x of its middle, mm: the centre of the columns within 3 mm of its lowest point.
  double MiddleMm = 0;
};

/// Finds the deepest valley of the body's front as seen from head or feet: the air above the
/// sternum. Heights are over the coronal plane, mm; columns whose skin lies behind the wall or the
/// cut have none.
MAMMORAYSEGMENTATION_EXPORT Valley DeepestValley(const HeightMap* skin, const HeightMap* wall,
  double cutMm);
}

#endif
