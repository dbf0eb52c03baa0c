// SPDX-License-Identifier: Apache-2.0
#include "ProjectorTesting.h"
#include "mammoray/XRay/Private/SpatialOrder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

/// Sum of the ways from each triangle's first corner to that of the next one in an order, mm.
double Way(const SurfaceMesh& mesh, const std::vector<std::uint32_t>& order)
{
  double way = 0;
  for (std::size_t index = 1; index < order.size(); ++index)
  {
    way += Norm(PointOf(mesh, mesh.Triangles[3 * std::size_t{ order[index] }]) -
      PointOf(mesh, mesh.Triangles[3 * std::size_t{ order[index - 1] }]));
  }
  return way;
}

TEST(SpatialOrder, IsAPermutationOfNeighbours)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 5, 6, 7 }, 30, 4, 1);
  std::vector<std::uint32_t> shuffled(mesh.NumberOfTriangles());
  std::iota(shuffled.begin(), shuffled.end(), 0u);
  std::mt19937 generator(3);
  std::shuffle(shuffled.begin(), shuffled.end(), generator);
  const std::vector<std::uint32_t> order = SpatialOrder(mesh);
  EXPECT_TRUE(std::is_permutation(order.begin(), order.end(), shuffled.begin(), shuffled.end()));
  // Two points of the sphere lie 40 mm apart on average (4/3 of its radius); edges have 2 mm.
  EXPECT_NEAR(Way(mesh, shuffled) / static_cast<double>(shuffled.size()), 40, 2);
  EXPECT_LT(Way(mesh, order) / static_cast<double>(order.size()), 6);
}

TEST(SpatialOrder, DoesNotDependOnWhereTheMeshLies)
{
  SurfaceMesh mesh;
  AddBox(mesh, { 0, 0, 0 }, { 64, 16, 4 }, 1);
  const std::vector<std::uint32_t> order = SpatialOrder(mesh);
  for (double& coordinate : mesh.Points)
  {
    coordinate = 2 * coordinate + 1024; // exact in floats, too
  }
  EXPECT_EQ(SpatialOrder(mesh), order);
  EXPECT_TRUE(SpatialOrder({}).empty());
}
}
