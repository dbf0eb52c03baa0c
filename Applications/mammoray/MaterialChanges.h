// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MaterialChanges_h
#define mammoray_MaterialChanges_h

#include "mammoray/Foundation/MaterialTable.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Each change "material=attenuation" or "material=attenuation@density". Throws InputError.
void ReplaceAttenuations(const std::vector<std::string>& changes, bool acceptUnusual,
  MaterialTable& table);

/// Each addition "material=mg per ml". Throws InputError.
void AddIodine(const std::vector<std::string>& additions, MaterialTable& table);
}

#endif
