// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Masks_h
#define mammoray_Masks_h

#include "Private/ItkImages.h"
#include "mammoraySegmentationModule.h"

#include <vector>

namespace mammoray
{
/// Finds the face-connected components of a mask with at least `smallestVoxels` voxels, numbered
/// from 1 by decreasing size; 0 elsewhere.
using ComponentImage = itk::Image<unsigned, 3>;
MAMMORAYSEGMENTATION_EXPORT ComponentImage::Pointer FindComponents(const MaskImage* mask,
  std::size_t smallestVoxels);

/// The largest component of a mask.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer LargestComponent(const MaskImage* mask);

/// The voxels of the mask that are connected within it with the volume's front (the last slice
/// along y).
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer ReachedFromFront(const MaskImage* mask);

/// All voxels that are not set.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer Complement(const MaskImage* mask);

/// Morphological opening of the mask by a ball of this radius, mm.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer Open(const MaskImage* mask, double radiusMm);

/// Morphological dilation of the mask by a ball of this radius, mm.
MAMMORAYSEGMENTATION_EXPORT MaskImage::Pointer Dilate(const MaskImage* mask, double radiusMm);

/// The intensities of the image inside the mask.
MAMMORAYSEGMENTATION_EXPORT std::vector<float> ValuesIn(const FloatImage* image,
  const MaskImage* mask);
}

#endif
