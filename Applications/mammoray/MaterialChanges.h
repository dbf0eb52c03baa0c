// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MaterialChanges_h
#define mammoray_MaterialChanges_h

#include "mammoray/IO/SceneIO.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Each change of --attenuation, "material=attenuation" or "material=attenuation@density". Throws
/// InputError.
void SetAttenuations(const std::vector<std::string>& changes, bool acceptUnusual,
  SceneDescription& description);

/// Each addition of --iodine, "material=mg per ml". Throws InputError.
void SetIodine(const std::vector<std::string>& additions, SceneDescription& description);
}

#endif
