// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SceneOptions_h
#define mammoray_SceneOptions_h

#include "mammoray/IO/SceneIO.h"

#include <functional>
#include <string>
#include <vector>

namespace mammoray
{
/// Whether an option was given, "--source".
using IsGivenFunction = std::function<bool(const std::string&)>;

/// The surfaces of --surface, "MATERIAL=FILE" each. Throws InputError where one has another form,
/// or its file is missing.
std::vector<SurfaceSample> ToSamples(const std::vector<std::string>& surfaces);

/// Reads the file of --scene over a description. Throws InputError as ReadScene does, and where an
/// option gives a value that is in the file, too.
void ApplySceneFile(const std::string& path, const IsGivenFunction& isGiven,
  SceneDescription& description);
}

#endif
