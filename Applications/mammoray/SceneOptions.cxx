// SPDX-License-Identifier: Apache-2.0
#include "SceneOptions.h"

#include "OptionList.h"
#include "OutputFiles.h"
#include "mammoray/Foundation/Error.h"

#include <initializer_list>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
/// The options that set the same as a key of a scene's file.
struct SceneKey
{
  const char* Key;
  std::initializer_list<const char*> Options;
};
const SceneKey SceneKeys[] = {
  { "source", { "--source", "--beam-direction" } },
  { "source.focal-spot", { "--focal-spot" } },
  { "source.focal-spot-samples", { "--focal-spot-samples" } },
  { "source.heel", { "--heel" } },
  { "source.inverse-square", { "--inverse-square" } },
  { "detector",
    { "--detector-origin", "--column-direction", "--row-direction", "--columns", "--rows",
      "--pixel-spacing" } },
  { "detector.samples", { "--samples" } },
  { "detector.response", { "--response" } },
  { "detector.scintillator", { "--scintillator" } },
  { "detector.response-table", { "--response-table" } },
  { "detector.photons", { "--photons" } },
  { "detector.electronic-noise", { "--electronic-noise" } },
  { "detector.half-modulation", { "--half-modulation" } },
  { "detector.seed", { "--seed" } },
  { "beam", { "--kev", "--spectrum", "--tube", "--kvp", "--filter" } },
  { "materials", { "--materials" } },
  { "attenuations", { "--attenuation" } },
  { "iodine", { "--iodine" } },
  { "mesh", { "--mesh", "--surface" } },
  { "samples", { "--mesh", "--surface" } },
  { "overlap-priority", { "--overlap-priority" } },
  { "scatter",
    { "--scatter", "--air-gap", "--grid", "--grid-interspace", "--mc-photons", "--mc-voxels" } },
  { "refraction", { "--refraction", "--bend-distance" } },
  { "dose", { "--dose" } },
};
}

std::vector<SurfaceSample> ToSamples(const std::vector<std::string>& surfaces)
{
  std::vector<SurfaceSample> samples;
  for (const std::string& text : surfaces)
  {
    // Mass fractions have no '=', and a path may have one.
    SurfaceSample sample;
    std::tie(sample.Material, sample.File) = SplitAssignment(text, "--surface", "MATERIAL=FILE");
    sample.Name = "--surface " + text;
    CheckInputFile(sample.File);
    samples.push_back(std::move(sample));
  }
  return samples;
}

void ApplySceneFile(const std::string& path, const IsGivenFunction& isGiven,
  SceneDescription& description)
{
  if (path.empty())
  {
    return;
  }
  description = ReadScene(path, std::move(description));
  for (const SceneKey& known : SceneKeys)
  {
    for (const char* option : known.Options)
    {
      if (description.Has(known.Key) && isGiven(option))
      {
        throw InputError(std::string(option) +
          ": expected it in the scene or as an option, found " + known.Key + " in " + path +
          ", too");
      }
    }
  }
  if (!description.Mesh.empty())
  {
    CheckInputFile(description.Mesh);
  }
  for (const SurfaceSample& sample : description.Samples)
  {
    CheckInputFile(sample.File);
  }
}
}
