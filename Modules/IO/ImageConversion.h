// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ImageConversion_h
#define mammoray_ImageConversion_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

class vtkImageData;

namespace mammoray
{
/// Returns the image's scalars (one component, whole values in [0, 65535]) on its grid, which may
/// be oblique; mm. Throws InputError, which names the voxel, on other scalars.
MAMMORAYIO_EXPORT LabelVolume ToLabelVolume(vtkImageData* image);

/// Returns the image that vtkMammogramReader outputs.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToImage(const Mammogram& mammogram);
/// Converts such an image back. Throws InputError if it has no pixels or no spacing.
MAMMORAYIO_EXPORT Mammogram ToMammogram(vtkImageData* image);
}

#endif
