// SPDX-License-Identifier: Apache-2.0
// The length of each ray in each material: a ball within a ball. usage: path_lengths FOLDER
#include <mammoray/XRay/PathLengthProjector.h>

#include <cmath>
#include <cstdio>
#include <fstream>

using namespace mammoray;

/// Adds a ball about the origin, with a material on each side of its surface.
void AddBall(double radius, std::uint16_t outside, std::uint16_t inside, SurfaceMesh& mesh)
{
  const std::uint32_t rings = 48, sectors = 96;
  const auto first = static_cast<std::uint32_t>(mesh.NumberOfPoints());
  for (std::uint32_t point = 0; point < (rings + 1) * sectors; ++point)
  {
    const double polar = M_PI * (point / sectors) / rings;
    const double around = 2 * M_PI * (point % sectors) / sectors;
    mesh.Points.insert(mesh.Points.end(),
      { radius * std::sin(polar) * std::cos(around), radius * std::sin(polar) * std::sin(around),
        radius * std::cos(polar) });
  }
  for (std::uint32_t face = 0; face < rings * sectors; ++face)
  {
    const std::uint32_t a = first + face;
    const std::uint32_t b = first + face / sectors * sectors + (face + 1) % sectors;
    mesh.Triangles.insert(mesh.Triangles.end(), { a, a + sectors, b, b, a + sectors, b + sectors });
    mesh.FrontMaterials.insert(mesh.FrontMaterials.end(), 2, outside);
    mesh.BackMaterials.insert(mesh.BackMaterials.end(), 2, inside);
  }
}

int main(int, char** arguments)
{
  if (ListDevices().empty())
  {
    return 125; // no Vulkan device
  }
  SurfaceMesh balls;
  AddBall(30, 0, 1, balls);
  AddBall(12, 1, 2, balls);
  const std::unique_ptr<PathLengthProjector> projector = MakeProjector();
  projector->SetSurface(balls);
  const PathLengthImage image = projector->Project({ .Position = { 0, -500, 0 } },
    { { -40, 100, 40 }, { 0.5, 0, 0 }, { 0, 0, -0.5 }, 161, 161 });

  std::ofstream picture(std::string(arguments[1]) + "/path_lengths.pgm", std::ios::binary);
  picture << "P5 322 161 255\n"; // the materials beside each other
  for (int pixel = 0; pixel < 322 * 161; ++pixel)
  {
    const float* lengths = image.Material(1 + pixel / 161 % 2);
    picture.put(static_cast<char>(std::lround(4 * lengths[pixel / 322 * 161 + pixel % 161])));
  }
  const float outer = image.Material(1)[80 * 161 + 80], inner = image.Material(2)[80 * 161 + 80];
  std::printf("through the middle: %.2f mm and %.2f mm\n", outer, inner);
  return std::abs(outer - 36) < 0.1 && std::abs(inner - 24) < 0.1 ? 0 : 1;
}
