// SPDX-License-Identifier: Apache-2.0
#include "SurfaceView.h"

#include "mammoray/Foundation/Error.h"

#include <filesystem>
#include <utility>

namespace mammoray
{
ViewedScene ReadViewedScene(const SurfaceViewInput& input, const IsGivenFunction& isGiven)
{
  SceneDescription description;
  description.Samples = ToSamples(input.Surfaces);
  description.Materials = input.Materials;
  description.Beam.EnergyKeV = input.EnergyKeV;
  if (!input.Spectrum.empty())
  {
    description.Beam.Spectrum = input.Spectrum;
  }
  ApplySceneFile(input.Scene, isGiven, description);
  if (description.Has("source") != description.Has("detector"))
  {
    throw InputError(input.Scene + ": expected both source and detector, or neither, to look at");
  }
  if (description.Samples.empty() && description.Mesh.empty())
  {
    throw InputError("view: expected a --scene with samples, found none");
  }
  ViewedScene viewed;
  viewed.Name = !input.Scene.empty() ? input.Scene : description.Samples.front().File;
  viewed.Name = std::filesystem::path(viewed.Name).lexically_normal().string();
  viewed.Scene = LoadScene(description);
  viewed.Scene.Samples = { { Assemble(viewed.Scene) } };
  viewed.Scene.Detector.Samples = 1;
  if (!description.Has("source"))
  {
    viewed.PlaceAround();
  }
  return viewed;
}
}
