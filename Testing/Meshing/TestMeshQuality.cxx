// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/Private/MeshQuality.h"

#include <gtest/gtest.h>

#include <numbers>

using namespace mammoray;

TEST(MeshQuality, RegularTetrahedron)
{
  TetrahedralMesh mesh;
  mesh.Points = { 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1 };
  mesh.Cells = { 0, 1, 2, 3 };
  mesh.Materials = { 1 };
  // Closed forms: arccos(1/3) and sqrt(6)/4; a dozen double operations.
  EXPECT_NEAR(SmallestDihedralDeg(mesh, 0), std::acos(1.0 / 3.0) * 180 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(RadiusEdgeRatio(mesh, 0), std::sqrt(6.0) / 4.0, 1e-12);
}

TEST(MeshQuality, CornerAndSliver)
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0.5, 0.5, 1e-3 };
  mesh.Cells = { 0, 1, 2, 3, 0, 1, 4, 5 };
  mesh.Materials = { 1, 1 };
  // A cube's corner: the slanted face meets the others at arccos(1/sqrt(3)), its sphere is the
  // cube's.
  EXPECT_NEAR(SmallestDihedralDeg(mesh, 0), std::acos(1 / std::sqrt(3.0)) * 180 / std::numbers::pi,
    1e-12);
  EXPECT_NEAR(RadiusEdgeRatio(mesh, 0), std::sqrt(3.0) / 2.0, 1e-12);
  EXPECT_LT(SmallestDihedralDeg(mesh, 1), 0.2);
}
