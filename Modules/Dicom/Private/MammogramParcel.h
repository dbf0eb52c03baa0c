// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MammogramParcel_h
#define mammoray_Private_MammogramParcel_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/IO/GuardedRead.h"

namespace mammoray
{
/// Passes every member of a mammogram.
inline void Exchange(Parcel& parcel, Mammogram& mammogram)
{
  parcel(mammogram.Columns, mammogram.Rows, mammogram.Pixels, mammogram.InvertedForDisplay,
    mammogram.PresentationIntent, mammogram.IntensityRelationship, mammogram.IntensitySign,
    mammogram.BitsStored, mammogram.ColumnSpacingMm, mammogram.RowSpacingMm, mammogram.View,
    mammogram.Laterality, mammogram.RowDirection, mammogram.ColumnDirection,
    mammogram.BodyPartThicknessMm, mammogram.PositionerPrimaryAngleDeg,
    mammogram.SourceToDetectorMm, mammogram.SourceToPatientMm, mammogram.PeakKilovoltage,
    mammogram.AnodeMaterial, mammogram.FilterMaterial, mammogram.SourceFootPixel);
}
}

#endif
