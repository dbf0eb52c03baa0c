// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ImageConversion_h
#define mammoray_ImageConversion_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

class vtkImageData;

namespace mammoray
{
/// The image's scalars (one component, whole values in [0, 65535]) on its grid, oblique or not; mm.
/// Throws InputError that names the voxel on anything else.
MAMMORAYIO_EXPORT LabelVolume ToLabelVolume(vtkImageData* image);

/// The image that vtkMammogramReader gives, and the mammogram of such an image; throws InputError
/// where it has no pixels or no spacing.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToImage(const Mammogram& mammogram);
MAMMORAYIO_EXPORT Mammogram ToMammogram(vtkImageData* image);
}

#endif
