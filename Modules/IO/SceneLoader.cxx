// SPDX-License-Identifier: Apache-2.0
// From the description of a scene to its meshes, tables and spectra.
#include "Private/SceneTable.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Composition.h"

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace mammoray
{
namespace
{
/// Sets attenuation and density from "ATTENUATION[@DENSITY]". Throws InputError.
void SetAttenuation(const std::string& text, const std::string& where, Material& material)
{
  material.Attenuation = text;
  const double density = TakeDensity(material.Attenuation, where);
  try
  {
    material.DensityGPerCm3 = FindAttenuationTable(material.Attenuation).DensityOf(density);
  }
  catch (const InputError& error)
  {
    throw InputError(where + ": " + error.what());
  }
}

/// A material of the table, by its name, or a new one of that composition.
int MaterialFor(const SurfaceSample& sample, MaterialTable& table)
{
  const auto known = std::find_if(table.Materials.begin(), table.Materials.end(),
    [&](const Material& material) { return material.Name == sample.Material; });
  if (known != table.Materials.end())
  {
    if (known == table.Materials.begin())
    {
      throw InputError(sample.Name + ": expected a material, found air");
    }
    return static_cast<int>(known - table.Materials.begin());
  }
  Material material;
  material.Name = sample.Material;
  SetAttenuation(sample.Material, sample.Name, material);
  table.Materials.push_back(material);
  return static_cast<int>(table.Materials.size()) - 1;
}

/// Adds the sample, and its material where the table has none of it.
void AddSample(const SurfaceSample& sample, Scene& scene)
{
  SceneSample placed;
  placed.Material = MaterialFor(sample, scene.Materials);
  auto part = std::make_shared<SurfaceMesh>(ReadSurface(sample.File));
  const auto several = [](const std::vector<std::uint16_t>& sides)
  { return std::any_of(sides.begin(), sides.end(), [](std::uint16_t side) { return side > 1; }); };
  if (several(part->BackMaterials) || several(part->FrontMaterials))
  {
    throw InputError(sample.Name +
        ": expected a surface of one material, found several, as of a mesh with a table",
      { "File", sample.File, { "Mesh" } });
  }
  ScaleSurface(sample.File, sample.UnitMm, sample.Name, *part);
  placed.Surface = std::move(part);
  placed.Rotation =
    (sample.RotationDeg * std::numbers::pi / 180 / Norm(sample.RotationAxis)) * sample.RotationAxis;
  placed.TranslationMm = sample.TranslationMm;
  scene.Samples.push_back(std::move(placed));
}

/// The interfaces of a mesh's file, whose materials are those of the scene's table.
void AddMesh(const std::string& path, const std::string& unit, Scene& scene)
{
  MeshOrSurface read = ReadMeshOrSurface(path);
  if (read.Volume)
  {
    try
    {
      read.Surface = ExtractInterfaces(FromGrid(read.Volume, &read.MaterialNames));
    }
    catch (const InputError& error)
    {
      throw InputError(path + ": " + error.what());
    }
  }
  auto surface = std::make_shared<SurfaceMesh>(std::move(read.Surface));
  if (!unit.empty())
  {
    ScaleSurface(path, LengthUnitMm(unit), path, *surface);
  }
  scene.Materials.FitMesh(*surface, read.MaterialNames, path);
  scene.Samples.push_back({ std::move(surface) });
}

MaterialTable MaterialsOf(const SceneDescription& description)
{
  MaterialTable table =
    description.Materials.empty() ? MaterialTable() : FindMaterialTable(description.Materials);
  const auto named = [&table](const std::string& name) -> Material&
  { return table.Materials[static_cast<std::size_t>(table.IndexOf(name))]; };
  for (const auto& [name, text] : description.Attenuations)
  {
    SetAttenuation(text, "attenuation of " + name, named(name));
  }
  for (const auto& [name, iodine] : description.IodineMgPerMl)
  {
    named(name).IodineMgPerMl = iodine;
  }
  if (table.Materials.empty())
  {
    table.Name = "surfaces";
    table.Materials.push_back({ .Name = "air" });
  }
  return table;
}

DetectorResponse ResponseOf(const SceneDescription& description)
{
  if (!description.ResponseTable.empty())
  {
    return ReadDetectorResponse(description.ResponseTable);
  }
  DetectorResponse response;
  if (!description.Scintillator.empty())
  {
    response = AbsorbingDetector(XRayFilter::FromText(description.Scintillator));
  }
  response.ByEnergy = description.Fixed.Response.ByEnergy;
  return response;
}
}

Spectrum FindSpectrum(const SceneDescription& description)
{
  std::vector<XRayFilter> filters;
  for (const std::string& text : description.Filters)
  {
    filters.push_back(XRayFilter::FromText(text));
  }
  if (!description.Tube.Anode.empty() && !description.EnergyKeV)
  {
    XRayTube tube = description.Tube;
    tube.Filters = std::move(filters);
    return TubeSpectrum(tube);
  }
  Spectrum spectrum = description.EnergyKeV ? Spectrum::Monochromatic(*description.EnergyKeV)
                                            : FindSpectrum(description.Spectrum);
  for (const XRayFilter& filter : filters)
  {
    spectrum = FilterSpectrum(spectrum, filter);
  }
  return spectrum;
}

Scene LoadScene(const SceneDescription& description)
{
  description.Validate();
  Scene scene = description.Fixed;
  scene.Detector.ColumnStep = description.PixelSpacingMm * scene.Detector.ColumnStep;
  scene.Detector.RowStep = description.PixelSpacingMm * scene.Detector.RowStep;
  scene.Materials = MaterialsOf(description);
  scene.XRays = FindSpectrum(description);
  scene.Response = ResponseOf(description);
  if (!description.Mesh.empty())
  {
    AddMesh(description.Mesh, description.MeshUnit, scene);
  }
  for (const SurfaceSample& sample : description.Samples)
  {
    AddSample(sample, scene);
  }
  scene.Attenuations = FindAttenuations(scene.Materials);
  if (!description.Tube.Anode.empty())
  {
    scene.Field.Heel.Target = description.Tube.Anode;
  }
  for (const std::string& name : description.OverlapPriority)
  {
    scene.OverlapPriority.push_back(scene.Materials.IndexOf(name));
  }
  if (scene.Scatter.Method == SceneScatter::Model::Kernels)
  {
    scene.Scatter.Kernels = std::make_shared<const ScatterKernels>(FindScatterKernels());
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
