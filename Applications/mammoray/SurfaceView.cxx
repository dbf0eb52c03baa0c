// SPDX-License-Identifier: Apache-2.0
#include "SurfaceView.h"

#include "SceneOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"

#include <filesystem>
#include <utility>

namespace mammoray
{
ViewedScene ReadViewedScene(const SurfaceViewInput& input,
  const std::function<bool(const std::string&)>& isGiven, std::vector<int>& priority)
{
  std::vector<SurfaceSample> samples = ToSamples(input.Surfaces);
  SpectrumArguments xRays;
  xRays.EnergyKeV = input.EnergyKeV;
  xRays.Spectrum = input.Spectrum.empty() ? xRays.Spectrum : input.Spectrum;
  std::string materials = input.Materials;
  SceneDescription scene;
  if (!input.Scene.empty())
  {
    scene = ReadScene(input.Scene);
    const SaidOnce check{ isGiven, input.Scene };
    if (scene.Beam)
    {
      check("beam", { "--kev", "--spectrum" });
      SetBeam(*scene.Beam, xRays);
    }
    if (!scene.Materials.empty())
    {
      check("materials", { "--materials" });
      materials = scene.Materials;
    }
    if (!scene.Samples.empty())
    {
      samples = std::move(scene.Samples);
    }
    if (!scene.Source != !scene.Detector)
    {
      throw InputError(input.Scene + ": expected both source and detector, or neither, to look at");
    }
  }
  if (samples.empty())
  {
    throw InputError("view: expected a --scene with samples, found none");
  }
  SurfaceScene surfaces =
    ReadSurfaces(samples, materials.empty() ? MaterialTable() : FindMaterialTable(materials));
  for (const std::string& name : scene.OverlapPriority)
  {
    priority.push_back(surfaces.Materials.IndexOf(name));
  }
  ViewedScene viewed;
  viewed.Name = input.Scene.empty() ? samples.front().File : input.Scene;
  viewed.Name = std::filesystem::path(viewed.Name).lexically_normal().string();
  viewed.Surface = std::move(surfaces.Surface);
  viewed.Materials = std::move(surfaces.Materials);
  viewed.Spectrum = ToSpectrum(xRays);
  if (scene.Source)
  {
    viewed.Source = ToSource(*scene.Source);
    viewed.Detector = ToDetector(*scene.Detector);
  }
  else
  {
    viewed.PlaceAround();
  }
  return viewed;
}
}
