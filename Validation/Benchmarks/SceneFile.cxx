// SPDX-License-Identifier: Apache-2.0
#include "SceneFile.h"

#include "mammoray/Foundation/Error.h"

#include <nlohmann/json.hpp>

#include <fstream>

namespace mammoray::benchmarks
{
namespace
{
using Json = nlohmann::ordered_json;

template <typename Value>
void WriteArray(std::ofstream& file, const std::vector<Value>& values)
{
  file.write(reinterpret_cast<const char*>(values.data()),
    static_cast<std::streamsize>(values.size() * sizeof(Value)));
}

template <typename Value>
void ReadArray(std::ifstream& file, std::size_t count, std::vector<Value>& values)
{
  values.resize(count);
  file.read(reinterpret_cast<char*>(values.data()),
    static_cast<std::streamsize>(count * sizeof(Value)));
}
}

void WriteScene(const ExampleScene& scene, const std::string& path)
{
  const XRayDetector& detector = scene.Detector;
  Json header{ { "name", scene.Name }, { "points", scene.Surface.NumberOfPoints() },
    { "triangles", scene.Surface.NumberOfTriangles() }, { "source", scene.Source.Position },
    { "origin", detector.Origin }, { "columnStep", detector.ColumnStep },
    { "rowStep", detector.RowStep }, { "columns", detector.Columns }, { "rows", detector.Rows },
    { "materials", Json::array() } };
  for (const Material& material : scene.Materials.Materials)
  {
    header["materials"].push_back({ material.Name, material.Attenuation, material.DensityGPerCm3 });
  }
  std::ofstream file(path, std::ios::binary);
  file << header.dump() << "\n";
  WriteArray(file, scene.Surface.Points);
  WriteArray(file, scene.Surface.Triangles);
  WriteArray(file, scene.Surface.FrontMaterials);
  WriteArray(file, scene.Surface.BackMaterials);
  file.close();
  if (!file)
  {
    throw Error(path + ": cannot be written");
  }
}

ExampleScene ReadScene(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!std::getline(file, line))
  {
    throw Error(path + ": cannot be read");
  }
  const Json header = Json::parse(line);
  ExampleScene scene;
  scene.Name = header.at("name");
  scene.Source.Position = header.at("source");
  scene.Detector.Origin = header.at("origin");
  scene.Detector.ColumnStep = header.at("columnStep");
  scene.Detector.RowStep = header.at("rowStep");
  scene.Detector.Columns = header.at("columns");
  scene.Detector.Rows = header.at("rows");
  for (const Json& entry : header.at("materials"))
  {
    Material material;
    material.Name = entry.at(0);
    material.Attenuation = entry.at(1);
    material.DensityGPerCm3 = entry.at(2);
    scene.Materials.Materials.push_back(material);
  }
  const std::size_t triangleCount = header.at("triangles");
  ReadArray(file, 3 * header.at("points").get<std::size_t>(), scene.Surface.Points);
  ReadArray(file, 3 * triangleCount, scene.Surface.Triangles);
  ReadArray(file, triangleCount, scene.Surface.FrontMaterials);
  ReadArray(file, triangleCount, scene.Surface.BackMaterials);
  if (!file)
  {
    throw Error(path + ": shorter than its header says");
  }
  return scene;
}
}
