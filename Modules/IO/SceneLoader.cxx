// SPDX-License-Identifier: Apache-2.0
// From the description of a scene to its tables and spectra.
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Composition.h"

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

/// Whether the sides of all triangles are air or material 1.
bool HasOneMaterial(const SurfaceMesh& surface)
{
  const auto isOne = [](const std::vector<std::uint16_t>& sides)
  { return std::all_of(sides.begin(), sides.end(), [](std::uint16_t side) { return side < 2; }); };
  return isOne(surface.FrontMaterials) && isOne(surface.BackMaterials);
}

/// Adds the sample, and its material where the table has none of it.
void AddSample(const SurfaceSample& sample, Scene& scene)
{
  SceneSample placed;
  if (sample.Material.empty())
  {
    if (scene.Materials.Materials.size() < 2)
    {
      throw InputError(
        sample.Name + ".material: expected one, or materials of the scene, found neither");
    }
    auto fitted = std::make_shared<SurfaceMesh>(*sample.Surface);
    scene.Materials.FitMesh(*fitted, sample.MaterialNames, sample.Name);
    if (!sample.File.empty() && sample.MaterialNames.empty() &&
      scene.Materials.Materials.size() > 2 && HasOneMaterial(*fitted))
    {
      Note({ sample.Name,
        "tells no materials: all of it is taken as '" + scene.Materials.Materials[1].Name +
          "', the first of the table '" + scene.Materials.Name + "'" });
    }
    placed.Surface = std::move(fitted);
  }
  else
  {
    placed.Material = MaterialFor(sample, scene.Materials);
    if (!HasOneMaterial(*sample.Surface))
    {
      throw InputError(sample.Name +
          ": expected a surface of one material, found several, as of a mesh with a table",
        { "File", sample.File, { "Mesh" } });
    }
    placed.Surface = sample.Surface;
  }
  placed.Rotation =
    (sample.RotationDeg * std::numbers::pi / 180 / Norm(sample.RotationAxis)) * sample.RotationAxis;
  placed.TranslationMm = sample.TranslationMm;
  scene.Samples.push_back(std::move(placed));
}

/// The material that a key names.
int IndexForKey(const std::string& name, const MaterialTable& table, const std::string& key)
{
  try
  {
    return table.IndexOf(name);
  }
  catch (const InputError& error)
  {
    throw InputError(key + ": " + error.what());
  }
}

MaterialTable MaterialsOf(const SceneDescription& description)
{
  MaterialTable table = description.ReadTable();
  const auto named = [&table](const std::string& name, const std::string& key) -> Material&
  { return table.Materials[static_cast<std::size_t>(IndexForKey(name, table, key))]; };
  for (const auto& [name, text] : description.Attenuations)
  {
    SetAttenuation(text, "attenuation of " + name, named(name, "attenuations"));
  }
  for (const auto& [name, iodine] : description.IodineMgPerMl)
  {
    named(name, "iodine").IodineMgPerMl = iodine;
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
    response = AbsorbingDetector(XRayFilter::FromText(description.Scintillator, "scintillator"));
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
    : description.EnergiesKeV.empty()
    ? FindSpectrum(description.Spectrum)
    : Spectrum{ "spectrum", description.EnergiesKeV, description.Photons };
  for (const XRayFilter& filter : filters)
  {
    spectrum = FilterSpectrum(spectrum, filter);
  }
  return spectrum;
}

void CompleteUnit(SceneDescription& scene)
{
  if (!scene.IsRealistic)
  {
    return;
  }
  const auto standard = [&scene](const char* key, const char* value)
  {
    if (!scene.Has(key))
    {
      SetQuantity({ "realistic", key, { value } }, scene);
    }
  };
  if (!scene.Has("beam.kev") && !scene.Has("beam.energies") && !scene.Has("beam.spectrum") &&
    !scene.Has("beam.tube"))
  {
    standard("beam.tube", "W");
    standard("beam.kvp", "29");
    standard("beam.filter", "Rh:0.05");
  }
  standard("source.inverse-square", "true");
  standard("source.heel.angle", "20");
  standard("scatter.method", "kernels");
  standard("scatter.grid.ratio", "5");
  if (!scene.Has("detector.line-spread"))
  {
    standard("detector.half-modulation", "5");
  }
  standard("detector.electronic-noise", "5");
  if (!scene.Has("detector.photons"))
  {
    scene.Fixed.Detection.PhotonsPerPixel = 2e7 * scene.PixelSpacingMm * scene.PixelSpacingMm;
  }
}

MaterialTable SceneDescription::ReadTable() const
{
  if (this->Table || this->Materials.empty())
  {
    return this->Table.value_or(MaterialTable());
  }
  return this->Materials.starts_with('{') ? ParseMaterialTable(this->Materials)
                                          : FindMaterialTable(this->Materials);
}

Scene MakeScene(SceneDescription description)
{
  CompleteUnit(description);
  description.Validate();
  Scene scene = description.Fixed;
  scene.Detector.ColumnStep = description.PixelSpacingMm * scene.Detector.ColumnStep;
  scene.Detector.RowStep = description.PixelSpacingMm * scene.Detector.RowStep;
  scene.Materials = MaterialsOf(description);
  scene.XRays = FindSpectrum(description);
  scene.Response = ResponseOf(description);
  if (!description.LineSpread.empty())
  {
    scene.Detection.Spread = ReadLineSpread(description.LineSpread);
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
    scene.OverlapPriority.push_back(IndexForKey(name, scene.Materials, "overlap-priority"));
  }
  scene.Scatter.Compositions = PhotonCompositions(scene.Materials);
  if (scene.Scatter.Method == SceneScatter::Model::Kernels && description.Kernels != "scene")
  {
    scene.Scatter.Kernels =
      std::make_shared<const ScatterKernels>(FindScatterKernels(description.Kernels));
  }
  return scene;
}
}
