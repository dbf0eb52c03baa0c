// SPDX-License-Identifier: Apache-2.0
// A small breast to look at.
#ifndef mammoray_SmallBreast_h
#define mammoray_SmallBreast_h

#include "TestMeshes.h"
#include "mammoray/App/ViewedBreast.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "Files.h"
#include "vtkUnstructuredGrid.h"

#include <string>

namespace mammoray::test
{
inline constexpr const char* SmallTable = R"({ "materials": [
  { "name": "air", "labels": [0] },
  { "name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92,
    "youngs_modulus_kpa": 6, "poisson_ratio": 0.48 },
  { "name": "wall", "labels": [2], "attenuation": "muscle", "density_g_per_cm3": 1.05,
    "held": true },
  { "name": "gland", "labels": [3], "attenuation": "glandular", "density_g_per_cm3": 1.03,
    "youngs_modulus_kpa": 12, "poisson_ratio": 0.48 } ] })";

/// x lateral (left), y anterior, z up; gland in the middle.
inline TetrahedralMesh SmallBreastMesh()
{
  TetrahedralMesh mesh = MakeHalfEllipsoidMesh(40, 45, 38, 6);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    Vector3 middle{ 0, 0, 0 };
    for (int corner = 0; corner < 4; ++corner)
    {
      middle = middle + 0.25 * mesh.Point(mesh.Cells[4 * cell + corner]);
    }
    if (mesh.Materials[cell] == 1 && Norm(middle - Vector3{ 5, 20, 3 }) < 14)
    {
      mesh.Materials[cell] = 3;
    }
  }
  return mesh;
}

/// Writes mesh and table, and says how to look at them.
inline ViewInput WriteSmallBreast(const test::TemporaryFolder& folder)
{
  ViewInput input;
  input.Mesh = folder.File("breast.vtu");
  WriteMesh(ToGrid(SmallBreastMesh(), { "air", "fat", "wall", "gland" }), input.Mesh);
  input.Materials = folder.Write("table.json", SmallTable);
  input.Orientation = "LAS";
  input.PixelSpacingMm = 0.5;
  return input;
}
}

#endif
