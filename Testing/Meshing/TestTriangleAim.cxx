// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Meshing/Private/TriangleAim.h"

#include <gmock/gmock.h>

#include <cmath>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;
using Verdict = TriangleAim::Verdict;

LabelVolume Ball()
{
  return test::LabelledCube(40, 1, [](const Vector3& p) { return Norm(p) < 15 ? 1 : 0; });
}

/// Attempts until a mesher with so many triangles per squared size is at the count; 0: never.
int Attempts(std::size_t wanted, double factor, double power)
{
  MeshingOptions options;
  options.Triangles = wanted;
  const LabelVolume volume = Ball();
  TriangleAim aim(volume, options);
  for (int attempt = 1; attempt <= 9; ++attempt)
  {
    const double found = factor * std::pow(aim.Sizes().FacetSizeMm, -power);
    if (aim.Judge(static_cast<std::size_t>(found)) == Verdict::Met)
    {
      EXPECT_NEAR(found, static_cast<double>(wanted), 0.05 * static_cast<double>(wanted));
      return attempt;
    }
  }
  return 0;
}

TEST(TriangleAim, ReachesTheCountWhateverTheMeshersPower)
{
  for (const double power : { 1.0, 1.5, 2.0, 2.5 })
  {
    for (const double factor : { 3e3, 3e4 })
    {
      const int attempts = Attempts(20000, factor, power);
      EXPECT_GE(attempts, 1) << power << " " << factor;
      EXPECT_LE(attempts, 7) << power << " " << factor;
    }
  }
}

TEST(TriangleAim, ScalesFacetsAndKeepsCellsFromShrinking)
{
  MeshingOptions options;
  options.Triangles = 50000;
  options.FacetSizeOfMaterialMm[1] = 1.5;
  const LabelVolume volume = Ball();
  const MeshingOptions sizes = TriangleAim(volume, options).Sizes();
  // The first attempt aims at a tenth: 4 pi 15^2 mm^2 in triangles of 0.6 size^2, the stairs' area
  // being known to a few percent.
  EXPECT_NEAR(sizes.FacetSizeMm, std::sqrt(4 * 3.1416 * 225 / (0.6 * 5000)), 0.02);
  EXPECT_DOUBLE_EQ(sizes.FacetSizeOfMaterialMm.at(1), 0.5 * sizes.FacetSizeMm);
  EXPECT_DOUBLE_EQ(sizes.FacetDistanceMm / options.FacetDistanceMm,
    sizes.FacetSizeMm / options.FacetSizeMm);
  EXPECT_EQ(sizes.CellSizeMm, options.CellSizeMm);
}

TEST(TriangleAim, RefusesMoreThanVoxelsCanTell)
{
  MeshingOptions options;
  options.Triangles = 1000000;
  EXPECT_EQ(RefusalOf([&] { TriangleAim(Ball(), options); }).find("triangles: expected at most "),
    0u);
}

TEST(CheckSizes, RefusesMoreThanTheMemoryHolds)
{
  const LabelVolume volume = Ball();
  EXPECT_NO_THROW(CheckSizes(volume, MeshingOptions()));
  for (const double size : { 1e-3, 1e-300 })
  {
    MeshingOptions cells;
    cells.CellSizeMm = size;
    MeshingOptions cellsOfOne;
    cellsOfOne.CellSizeOfMaterialMm[1] = size;
    MeshingOptions facets;
    facets.FacetSizeMm = 1e-3 * size;
    MeshingOptions facetsOfOne;
    facetsOfOne.FacetSizeOfMaterialMm[0] = 1e-3 * size;
    for (const MeshingOptions& options : { cells, cellsOfOne, facets, facetsOfOne })
    {
      EXPECT_THAT(RefusalOf([&] { CheckSizes(volume, options); }),
        testing::AllOf(test::Mentions("sizes", "cells"), test::Mentions("GB")));
    }
  }
}
}
