// SPDX-License-Identifier: Apache-2.0
// A part turns before the detector: one row of all projections is a sinogram. usage: turn FOLDER
#include <mammoray/XRay/Exposer.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

using namespace mammoray;

int main(int, char** arguments)
{
  if (ListDevices().empty())
  {
    return 125; // no Vulkan device
  }
  // A bar of 8 x 8 x 20 mm beside the axis, 10 to 18 mm away from it.
  SurfaceMesh bar;
  for (int corner = 0; corner < 8; ++corner)
  {
    bar.Points.insert(bar.Points.end(),
      { corner & 1 ? 18.0 : 10.0, corner & 2 ? 4.0 : -4.0, corner & 4 ? 10.0 : -10.0 });
  }
  bar.Triangles = { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6,
    0, 6, 2, 1, 3, 7, 1, 7, 5 };
  bar.FrontMaterials.assign(12, 0);
  bar.BackMaterials.assign(12, 1);
  Scene scene;
  scene.Samples = { { std::make_shared<SurfaceMesh>(bar) } };
  scene.Materials.Materials = { { "air" }, { "bar" } };
  scene.Attenuations = { {}, { "aluminium", 2.7, { 60 }, { 0.075 } } };
  scene.XRays = Spectrum::Monochromatic(60);
  scene.Source.Position = { 0, -500, 0 };
  scene.Detector = { { -29.9, 100, 0 }, { 0.2, 0, 0 }, { 0, 0, 0.2 }, 300, 1 };

  Exposer exposer; // keeps the part on the device
  float least = 1;
  std::ofstream picture(std::string(arguments[1]) + "/turn.pgm", std::ios::binary);
  picture << "P5 300 180 255\n";
  for (int degree = 0; degree < 360; degree += 2)
  {
    scene.Samples[0].Rotation = { 0, 0, degree * M_PI / 180 };
    for (const float transmission : exposer.Expose(scene).Transmission)
    {
      least = std::min(least, transmission);
      picture.put(static_cast<char>(std::lround(255 * transmission)));
    }
  }
  // The longest way is the diagonal, 11.3 mm of 0.075/mm.
  std::printf("least transmission %.3f\n", least);
  return std::abs(-std::log(least) - 0.075 * 8 * std::sqrt(2.0)) < 0.02 ? 0 : 1;
}
