// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_DisplacementTransform_h
#define mammoray_Private_DisplacementTransform_h

#include "mammoray/IO/LabelVolumeIO.h"

#include <string>

namespace mammoray
{
/// True for .h5 and .tfm, in lower case.
bool IsTransformExtension(const std::string& extension);

/// Writes a sound field as an ITK transform file (see WriteDisplacement). Throws InputError when it
/// cannot be written.
void WriteDisplacementTransform(const DisplacementField& field, const std::string& path);
}

#endif
