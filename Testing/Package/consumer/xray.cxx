// SPDX-License-Identifier: Apache-2.0
// X-rays without VTK: a plate of 10 mm in parallel rays that slant by 3 in 4. Exit 125: no Vulkan
// device.
#include <mammoray/XRay/Exposer.h>

#include <cmath>
#include <cstdio>

int main()
{
  if (mammoray::ListDevices().empty())
  {
    std::puts("skipped: no Vulkan device");
    return 125;
  }
  mammoray::SurfaceMesh plate;
  for (int corner = 0; corner < 8; ++corner)
  {
    plate.Points.insert(plate.Points.end(),
      { corner & 1 ? 50.0 : -50.0, corner & 2 ? 50.0 : -50.0, corner & 4 ? 30.0 : 20.0 });
  }
  plate.Triangles = { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4,
    6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };
  plate.FrontMaterials.assign(12, 0);
  plate.BackMaterials.assign(12, 1);
  mammoray::Scene scene;
  scene.Samples = { { std::make_shared<const mammoray::SurfaceMesh>(plate) } };
  scene.Materials.Materials = { { "air" }, { "plate" } };
  scene.Attenuations = { {}, { "plate", 1, { 20 }, { 0.05 } } };
  scene.Source.Type = mammoray::XRaySource::Kind::Parallel;
  scene.Source.Direction = { 0, 3, -4 };
  mammoray::Exposer exposer;
  const mammoray::Exposure image = exposer.Expose(scene);
  const double expected = std::exp(-0.05 * 12.5);
  std::printf("transmission %.7f, expected %.7f\n", image.Transmission[0], expected);
  return std::abs(image.Transmission[0] - expected) < 1e-6 ? 0 : 1; // a float
}
