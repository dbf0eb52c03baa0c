// SPDX-License-Identifier: Apache-2.0
// A radiograph of an STL, by the projector alone: no VTK. usage: radiograph FOLDER
#include <mammoray/XRay/Exposer.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>

using namespace mammoray;

/// The triangles of a binary STL; its outside is air.
SurfaceMesh ReadStl(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::uint32_t count = 0;
  file.seekg(80).read(reinterpret_cast<char*>(&count), 4);
  SurfaceMesh mesh;
  float normalAndCorners[12];
  while (count-- && file.read(reinterpret_cast<char*>(normalAndCorners), 48).ignore(2))
  {
    mesh.Points.insert(mesh.Points.end(), normalAndCorners + 3, normalAndCorners + 12);
  }
  mesh.Triangles.resize(mesh.NumberOfPoints());
  std::iota(mesh.Triangles.begin(), mesh.Triangles.end(), 0);
  mesh.FrontMaterials.assign(mesh.NumberOfTriangles(), 0);
  mesh.BackMaterials.assign(mesh.NumberOfTriangles(), 1);
  return mesh;
}

int main(int, char** arguments)
{
  if (ListDevices().empty())
  {
    return 125; // no Vulkan device
  }
  Scene scene;
  scene.Samples = { { std::make_shared<SurfaceMesh>(ReadStl("Data/parts/bearing.stl")) } };
  scene.Materials.Materials = { { "air" }, { "iron" } };
  scene.Attenuations = { {}, { "iron", 7.87, { 150 }, { 0.1546 } } }; // 1/mm at 150 keV, by NIST
  scene.Source.Position = { 0, -250, 433 };
  scene.Detector = { { -39.9, 15.45, -106.55 }, { 0.2, 0, 0 }, { 0, 0.1732, 0.1 }, 400, 400 };
  scene.XRays = Spectrum::Monochromatic(150);
  const Exposure image = Exposer().Expose(scene);

  std::ofstream picture(std::string(arguments[1]) + "/radiograph.pgm", std::ios::binary);
  picture << "P5 400 400 255\n";
  for (const float transmission : image.Transmission)
  {
    picture.put(static_cast<char>(std::lround(255 * transmission)));
  }
  const float least = *std::min_element(image.Transmission.begin(), image.Transmission.end());
  std::printf("least transmission %.3f\n", least);
  return least < 0.2 ? 0 : 1; // the balls are almost black
}
