// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceView_h
#define mammoray_SurfaceView_h

#include "SceneOptions.h"
#include "mammoray/App/SurfaceViewer.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// The surfaces of 'mammoray view'.
struct SurfaceViewInput
{
  /// MATERIAL=FILE each, or a scene.
  std::vector<std::string> Surfaces;
  std::string Scene;
  /// A single energy in place of a spectrum.
  std::optional<double> EnergyKeV;
  /// A path or a shipped one's name; empty: as 'mammoray project'.
  std::string Spectrum;
  /// Likewise; empty: none.
  std::string Materials;

  bool IsAsked() const { return !this->Surfaces.empty() || !this->Scene.empty(); }
};

/// Throws InputError.
ViewedScene ReadViewedScene(const SurfaceViewInput& input, const IsGivenFunction& isGiven);
}

#endif
