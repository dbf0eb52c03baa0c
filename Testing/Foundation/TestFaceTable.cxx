// SPDX-License-Identifier: Apache-2.0
#include "TestMeshes.h"
#include "mammoray/Foundation/FaceTable.h"

#include <gmock/gmock.h>

#include <set>

namespace
{
using namespace mammoray;

TEST(FaceTable, ABlockHasTheFacesThatEulerCounts)
{
  const TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 3, 2, 2 }, { 3, 2, 2 });
  FaceTable faces(mesh);
  std::size_t inner = 0;
  std::size_t outer = 0;
  std::set<std::size_t> seen;
  std::array<std::int32_t, 3> last{ -1, -1, -1 };
  faces.ForEachFace(
    [&](std::span<const FaceTable::Entry> same)
    {
      ASSERT_LE(same.size(), 2u);
      ++(same.size() == 2 ? inner : outer);
      std::array<std::int32_t, 3> points = faces.Corners(same[0].Face);
      std::sort(points.begin(), points.end());
      EXPECT_LT(last, points); // sorted, and none twice
      last = points;
      for (const FaceTable::Entry& entry : same)
      {
        EXPECT_TRUE(seen.insert(entry.Face).second);
        std::array<std::int32_t, 3> own = faces.Corners(entry.Face);
        std::sort(own.begin(), own.end());
        EXPECT_EQ(own, points);
      }
      if (same.size() == 2)
      {
        EXPECT_TRUE(faces.OnDifferentSides(same[0].Face, same[1].Face));
      }
    });
  EXPECT_EQ(seen.size(), 4 * mesh.NumberOfCells());
  // Two triangles for each of 2 (3 2 + 2 2 + 3 2) squares of the surface.
  EXPECT_EQ(outer, 64u);
  EXPECT_EQ(2 * inner + outer, 4 * mesh.NumberOfCells());
}

TEST(FaceTable, CornersTurnCounterClockwiseSeenFromOutside)
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  mesh.Cells = { 0, 1, 2, 3 };
  mesh.Materials = { 1 };
  ASSERT_GT(mesh.CellVolume(0), 0);
  const FaceTable faces(mesh);
  for (std::size_t face = 0; face < 4; ++face)
  {
    const auto [a, b, c] = faces.Corners(face);
    EXPECT_THAT((std::set<std::size_t>{ face, static_cast<std::size_t>(a),
                  static_cast<std::size_t>(b), static_cast<std::size_t>(c) }),
      testing::SizeIs(4)); // opposite to its corner
    const Vector3 origin = mesh.Point(static_cast<std::size_t>(a));
    const Vector3 normal = Cross(mesh.Point(static_cast<std::size_t>(b)) - origin,
      mesh.Point(static_cast<std::size_t>(c)) - origin);
    EXPECT_LT(Dot(normal, mesh.Point(face) - origin), 0);
  }
}

TEST(FaceTable, TellsCellsOnTheSameSide)
{
  TetrahedralMesh mesh;
  mesh.Points = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 2, 0, 0, -1 };
  mesh.Cells = { 0, 1, 2, 3, 0, 1, 2, 4, 0, 2, 1, 5 };
  mesh.Materials = { 1, 1, 1 };
  FaceTable faces(mesh);
  EXPECT_FALSE(faces.OnDifferentSides(3, 7));
  EXPECT_TRUE(faces.OnDifferentSides(3, 11));
  std::size_t most = 0;
  faces.ForEachFace(
    [&](std::span<const FaceTable::Entry> same) { most = std::max(most, same.size()); });
  EXPECT_EQ(most, 3u);
}
}
