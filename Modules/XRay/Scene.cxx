// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scene.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
SurfaceMesh Placed(const SceneSample& sample)
{
  SurfaceMesh mesh = *sample.Surface;
  for (std::size_t index = 0; index < mesh.Points.size(); index += 3)
  {
    const Vector3 own{ mesh.Points[index], mesh.Points[index + 1], mesh.Points[index + 2] };
    const Vector3 placed = Rotated(own, sample.Rotation) + sample.TranslationMm;
    std::copy(placed.begin(), placed.end(), &mesh.Points[index]);
  }
  return mesh;
}

void Append(const SurfaceMesh& mesh, SurfaceMesh& all)
{
  const auto base = static_cast<std::uint32_t>(all.NumberOfPoints());
  all.Points.insert(all.Points.end(), mesh.Points.begin(), mesh.Points.end());
  for (const std::uint32_t id : mesh.Triangles)
  {
    all.Triangles.push_back(base + id);
  }
  all.FrontMaterials.insert(all.FrontMaterials.end(), mesh.FrontMaterials.begin(),
    mesh.FrontMaterials.end());
  all.BackMaterials.insert(all.BackMaterials.end(), mesh.BackMaterials.begin(),
    mesh.BackMaterials.end());
}
}

void Scene::Validate() const
{
  this->Detection.Validate();
  const bool scatters =
    this->Scatter.Method != SceneScatter::Model::None || this->Detection.Scatter;
  if (this->Scatter.Grid && !scatters)
  {
    throw InputError("grid: expected scatter beside it, found none");
  }
  const bool isDetected = this->Detection.PhotonsPerPixel > 0 || this->Detection.HasBlur() ||
    this->Detection.HasPixelErrors() || this->Detection.FocalSpotColumnMm > 0 ||
    this->Detection.FocalSpotRowMm > 0 || !this->Detection.OpenField.empty();
  if (this->Refraction && (isDetected || this->HasField() || scatters))
  {
    throw InputError("refraction: expected no noise, blur, focal spot, heel, inverse square or "
                     "scatter beside it, found some");
  }
}

Beam MakeBeam(const Scene& scene, const std::vector<bool>& used)
{
  const std::size_t count = std::max(used.size(), scene.Attenuations.size());
  const AttenuationTable unknown{ "unknown", 1, scene.XRays.EnergiesKeV,
    std::vector<double>(scene.XRays.EnergiesKeV.size(), 1.0) };
  std::vector<const AttenuationTable*> tables(std::max<std::size_t>(count, 1), nullptr);
  std::vector<double> densities(tables.size(), 1.0);
  for (std::size_t material = 1; material < count; ++material)
  {
    const bool isKnown = material < scene.Attenuations.size() &&
      material < scene.Materials.Materials.size() &&
      !scene.Attenuations[material].EnergiesKeV.empty();
    if (isKnown)
    {
      tables[material] = &scene.Attenuations[material];
      densities[material] = scene.Materials.Materials[material].DensityGPerCm3;
      continue;
    }
    if (material < used.size() && used[material])
    {
      const bool isNamed = material < scene.Materials.Materials.size();
      throw InputError("material " +
        (isNamed ? "'" + scene.Materials.Materials[material].Name + "' " : std::string()) + "(" +
        std::to_string(material) + "): expected an attenuation, found none");
    }
    tables[material] = &unknown;
  }
  return Beam(scene.XRays, scene.Response, tables, densities);
}

std::shared_ptr<const SurfaceMesh> Assemble(const Scene& scene)
{
  const auto materials = static_cast<int>(scene.Materials.Materials.size());
  for (std::size_t index = 0; index < scene.Samples.size(); ++index)
  {
    const SceneSample& sample = scene.Samples[index];
    const std::string place = "samples[" + std::to_string(index) + "]: ";
    if (!sample.Surface)
    {
      throw InputError(place + "expected a surface, found none");
    }
    if (sample.Material < -1 || sample.Material == 0 || sample.Material >= materials)
    {
      throw InputError(place + "expected a material from 1 to " + std::to_string(materials - 1) +
        ", found " + std::to_string(sample.Material));
    }
  }
  if (scene.Samples.size() == 1 &&
    scene.Samples.front() == SceneSample{ scene.Samples.front().Surface })
  {
    return scene.Samples.front().Surface;
  }
  auto all = std::make_shared<SurfaceMesh>();
  for (const SceneSample& sample : scene.Samples)
  {
    if (sample.Material < 0)
    {
      Append(Placed(sample), *all);
    }
    else
    {
      AppendBoundary(Placed(sample), sample.Material, *all);
    }
  }
  return all;
}

void PlaceAround(Scene& scene)
{
  const std::array<Extent, 3> box =
    ExtentsAlong<3>({ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } }, Assemble(scene)->Points);
  const double diagonal = Norm({ box[0].Length(), box[1].Length(), box[2].Length() });
  if (!(diagonal > 0) || !std::isfinite(diagonal))
  {
    throw InputError("scene: expected surfaces with an extent, found none");
  }
  constexpr double Before = 4;
  constexpr double Behind = 1.5;
  // A tenth wider than the shadow of the sphere around the box.
  const double width = 1.1 * diagonal * (Before + Behind) / Before;
  const Vector3 middle{ box[0].Middle(), box[1].Middle(), box[2].Middle() };
  scene.Source.Type = XRaySource::Kind::Point;
  scene.Source.Position = middle - Vector3{ 0, Before * diagonal, 0 };
  XRayDetector& detector = scene.Detector;
  const double spacing = width / std::min(detector.Columns, detector.Rows);
  detector.ColumnStep = { spacing, 0, 0 };
  detector.RowStep = { 0, 0, -spacing };
  detector.Origin = middle + Vector3{ 0, Behind * diagonal, 0 } -
    0.5 * ((detector.Columns - 1) * detector.ColumnStep + (detector.Rows - 1) * detector.RowStep);
}
}
