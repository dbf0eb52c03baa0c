// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plausibility_h
#define mammoray_Plausibility_h

#include "mammoray/Segmentation/BreastSegmentation.h"

namespace mammoray
{
/// Volumes of the labels, and gland's level over muscle's in the corrected image.
MAMMORAYSEGMENTATION_EXPORT void Measure(SegmentationResult& result);

/**
 * Refuses, by InputError with its figure, what no breast is: less than 15 or more than 5000 cm3 of
 * a breast, more than 300 mm deep, more than 0.9 of gland; and warns of what few are: less than 60
 * or more than 3000 cm3, gland below 0.005 or above 0.6, skin above a third, gland more than twice
 * or less than half as bright as muscle (no T1 weighting, or contrast medium).
 * `breasts`: how many the result holds; `glandGiven`: its threshold is the caller's own concern.
 */
MAMMORAYSEGMENTATION_EXPORT void Judge(SegmentationResult& result, int breasts, bool glandGiven);
}

#endif
