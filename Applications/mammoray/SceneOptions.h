// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SceneOptions_h
#define mammoray_SceneOptions_h

#include "SpectrumOptions.h"
#include "mammoray/IO/SurfaceSceneIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

namespace mammoray
{
struct ProjectArguments;

/// The surfaces of --surface, "MATERIAL=FILE" each. Throws InputError where one is none, or its
/// file is not there.
std::vector<SurfaceSample> ToSamples(const std::vector<std::string>& surfaces);

/// Refuses options that say what a part of a scene does.
struct SaidOnce
{
  /// Whether an option was given, "--source".
  std::function<bool(const std::string&)> IsGiven;
  std::string Scene;

  void operator()(const std::string& part, std::initializer_list<const char*> options) const;
};

/// What parts of a scene are as options say them, and to the projectors.
void SetBeam(const SceneBeam& beam, SpectrumArguments& arguments);
XRaySource ToSource(const SceneSource& source);
XRayDetector ToDetector(const SceneDetector& detector);

/// Fills in what the scene of --scene says, and the samples of --surface. Throws InputError on what
/// ReadScene refuses, and on what both the scene and an option say.
void ApplyScene(ProjectArguments& arguments);
}

#endif
