// SPDX-License-Identifier: Apache-2.0
#include "SceneOptions.h"

#include "OptionList.h"
#include "OutputFiles.h"
#include "ProjectOptions.h"
#include "mammoray/Foundation/Error.h"

#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
void ApplySource(const SceneSource& source, const SaidOnce& check, ProjectArguments& arguments)
{
  check("source", { "--source", "--beam-direction" });
  arguments.Source = source.PositionMm;
  arguments.BeamDirection = source.Direction;
  if (source.FocalSpotMm)
  {
    check("source.focal-spot", { "--focal-spot" });
    arguments.FocalSpot = source.FocalSpotMm;
  }
}

void ApplyDetector(const SceneDetector& detector, const SaidOnce& check,
  ProjectArguments& arguments)
{
  check("detector",
    { "--detector-origin", "--column-direction", "--row-direction", "--columns", "--rows",
      "--pixel-spacing" });
  arguments.DetectorOrigin = detector.OriginMm;
  arguments.ColumnDirection = detector.ColumnDirection;
  arguments.RowDirection = detector.RowDirection;
  arguments.Columns = detector.Columns;
  arguments.Rows = detector.Rows;
  arguments.PixelSpacingMm = detector.PixelSpacingMm;
}

}

void SaidOnce::operator()(const std::string& part, std::initializer_list<const char*> options) const
{
  for (const char* option : options)
  {
    if (this->IsGiven(option))
    {
      throw InputError(std::string(option) + ": expected it in the scene or as an option, found " +
        part + " in " + this->Scene + ", too");
    }
  }
}

void SetBeam(const SceneBeam& beam, SpectrumArguments& arguments)
{
  arguments.EnergyKeV = beam.EnergyKeV;
  arguments.Spectrum = beam.Spectrum.empty() ? arguments.Spectrum : beam.Spectrum;
  arguments.Anode = beam.Anode;
  arguments.Tube.KilovoltagePeak = beam.KilovoltagePeak.value_or(arguments.Tube.KilovoltagePeak);
  arguments.Filters = beam.Filters;
}

XRaySource ToSource(const SceneSource& source)
{
  XRaySource result;
  if (source.Direction)
  {
    result.Type = XRaySource::Kind::Parallel;
    result.Direction = *source.Direction;
  }
  result.Position = source.PositionMm.value_or(result.Position);
  return result;
}

XRayDetector ToDetector(const SceneDetector& detector)
{
  XRayDetector result;
  result.Origin = detector.OriginMm;
  result.ColumnStep =
    (detector.PixelSpacingMm / Norm(detector.ColumnDirection)) * detector.ColumnDirection;
  result.RowStep = (detector.PixelSpacingMm / Norm(detector.RowDirection)) * detector.RowDirection;
  result.Columns = detector.Columns;
  result.Rows = detector.Rows;
  return result;
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

void ApplyScene(ProjectArguments& arguments)
{
  arguments.SurfaceSamples = ToSamples(arguments.Surfaces);
  if (arguments.Scene.empty())
  {
    return;
  }
  SceneDescription scene = ReadScene(arguments.Scene);
  const SaidOnce check{ arguments.IsGiven, arguments.Scene };
  if (scene.Source)
  {
    ApplySource(*scene.Source, check, arguments);
  }
  if (scene.Detector)
  {
    ApplyDetector(*scene.Detector, check, arguments);
  }
  if (scene.Beam)
  {
    check("beam", { "--kev", "--spectrum", "--tube", "--kvp", "--filter" });
    SetBeam(*scene.Beam, arguments.XRays);
  }
  if (!scene.Materials.empty())
  {
    check("materials", { "--materials" });
    arguments.Materials = scene.Materials;
  }
  if (!scene.OverlapPriority.empty())
  {
    check("overlap-priority", { "--overlap-priority" });
    arguments.OverlapPriority = scene.OverlapPriority;
  }
  if (!scene.Samples.empty())
  {
    check("samples", { "--mesh", "--surface" });
    arguments.SurfaceSamples = std::move(scene.Samples);
    for (const SurfaceSample& sample : arguments.SurfaceSamples)
    {
      CheckInputFile(sample.File);
    }
  }
}
}
