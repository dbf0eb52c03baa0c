// SPDX-License-Identifier: Apache-2.0
// The files of a scene's surfaces.
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/SceneIO.h"

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <memory>
#include <utility>

namespace mammoray
{
namespace
{
void ReadSample(SurfaceSample& sample)
{
  MeshOrSurface read;
  if (sample.Material.empty())
  {
    read = ReadMeshOrSurface(sample.File);
  }
  else
  {
    read.Surface = ReadSurface(sample.File, &read.MaterialNames);
  }
  if (read.Volume)
  {
    try
    {
      read.Surface = ExtractInterfaces(FromGrid(read.Volume, &read.MaterialNames));
    }
    catch (const InputError& error)
    {
      throw InputError(sample.File + ": " + error.what());
    }
  }
  ScaleSurface(sample.File, sample.UnitMm, sample.Name, read.Surface);
  sample.Surface = std::make_shared<const SurfaceMesh>(std::move(read.Surface));
  sample.MaterialNames = std::move(read.MaterialNames);
}
}

void ReadSurfaces(SceneDescription& description)
{
  if (!description.Mesh.empty())
  {
    SurfaceSample mesh{ .Name = description.Mesh, .File = std::exchange(description.Mesh, {}) };
    if (!description.MeshUnit.empty())
    {
      mesh.UnitMm = LengthUnitMm(description.MeshUnit);
    }
    description.Samples.insert(description.Samples.begin(), std::move(mesh));
  }
  for (SurfaceSample& sample : description.Samples)
  {
    if (!sample.Surface)
    {
      ReadSample(sample);
    }
  }
}

Scene LoadScene(SceneDescription description)
{
  ReadSurfaces(description);
  return MakeScene(std::move(description));
}

Scene LoadPlacedScene(const SceneDescription& description, const std::string& name)
{
  if (description.HasSource() != description.HasDetector())
  {
    throw InputError(name + ": expected both source and detector, or neither, to look at");
  }
  if (description.Samples.empty() && description.Mesh.empty())
  {
    throw InputError(name + ": expected samples to look at, found none");
  }
  Scene scene = LoadScene(description);
  if (!description.HasSource())
  {
    scene.Detector.Columns = scene.Detector.Rows = 512;
    PlaceAround(scene);
  }
  return scene;
}

Scene LoadScene(const std::string& path)
{
  const SceneDescription description = ReadScene(path);
  const auto require = [&](bool isThere, const char* expected)
  {
    if (!isThere)
    {
      throw InputError(path + ": expected " + expected + ", found none");
    }
  };
  require(description.HasSource(), "source.position or source.beam-direction");
  require(description.HasDetector(), "detector.origin");
  require(!description.Mesh.empty() || !description.Samples.empty(), "samples or a mesh");
  Scene scene = LoadScene(description);
  scene.Dose = false;
  return scene;
}
}
