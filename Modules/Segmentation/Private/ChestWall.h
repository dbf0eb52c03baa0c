// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ChestWall_h
#define mammoray_ChestWall_h

#include "Private/ItkImages.h"

namespace mammoray
{
/// Height of a column without chest wall.
constexpr float NoChestWall = -1.0f;

/**
 * The front of the chest wall as a height y, mm, over the image's coronal voxels (x, z),
 * NoChestWall beside it. `dark`: voxels as dark as muscle, the chest and its lungs included.
 *
 * The dark tissue loses what is thinner than 6 mm (vessels, ligaments, skin); of its parts the one
 * that covers most of the coronal plane is the chest wall. A bump of its front that is narrower
 * than 50 mm and higher than 5 mm is gland that lies against it: an opening of the height by a disc
 * takes it off, while slopes and the wide curve of the ribs stay. A height over 2 mm blocks,
 * smoothed.
 */
HeightMap::Pointer FindChestWall(const MaskImage* dark);
}

#endif
