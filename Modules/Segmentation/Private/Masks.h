// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Masks_h
#define mammoray_Masks_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

#include <vector>

namespace mammoray
{
/// Components of a mask (voxels that share a face), numbered from 1 by falling size; 0 elsewhere.
using ComponentImage = itk::Image<unsigned, 3>;
MAMMORAYSEGMENTATION_EXPORT ComponentImage::Pointer FindComponents(const MaskImage* mask,
  std::size_t smallestVoxels);

/// The largest component of a mask.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer LargestComponent(const MaskImage* mask);

/// Of the mask the voxels from which the volume's front (the last along y) is reached within it.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer ReachedFromFront(const MaskImage* mask);

/// Everything that is not set.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer Complement(const MaskImage* mask);

/// The mask without what a ball of that radius, mm, does not fit into.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer Open(const MaskImage* mask, double radiusMm);

/// What lies within a ball of that radius, mm, around a voxel of the mask.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer Dilate(const MaskImage* mask, double radiusMm);

/// The values of the image in the mask.
MAMMORAYSEGMENTATION_EXPORT std::vector<float> ValuesIn(const FloatImage* image,
  const MaskImage* mask);
}

#endif
