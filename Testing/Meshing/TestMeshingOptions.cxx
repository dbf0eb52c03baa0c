// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Meshing/MeshingOptions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace
{
using mammoray::testing_support::RefusalOf;
using namespace mammoray;

std::string Refusal(const std::function<void(MeshingOptions&)>& change)
{
  MeshingOptions options;
  change(options);
  return RefusalOf([&] { options.Validate(); });
}

TEST(MeshingOptions, DefaultsAndAnatomyAreValid)
{
  EXPECT_NO_THROW(MeshingOptions().Validate());
  const MeshingOptions anatomy = MeshingOptions::Anatomy({ 3, 5 });
  EXPECT_NO_THROW(anatomy.Validate());
  EXPECT_EQ(anatomy.FacetSizeOfMaterialMm.size(), 2u);
  EXPECT_LT(anatomy.FacetSizeOfMaterialMm.at(5), anatomy.FacetSizeMm);
}

TEST(MeshingOptions, ValidateNamesTheValueAndItsRange)
{
  EXPECT_EQ(Refusal([](MeshingOptions& o) { o.CellSizeMm = -1; }),
    "meshing: cell size: expected a positive number of mm, found -1");
  EXPECT_EQ(Refusal([](MeshingOptions& o) { o.FacetAngleDeg = 31; }),
    "meshing: facet angle: expected 0 to 30 degrees (refinement need not end above), found 31");
  EXPECT_EQ(Refusal([](MeshingOptions& o) { o.FacetDistanceMm = NAN; }),
    "meshing: facet distance: expected a positive number of mm, found nan");
  EXPECT_EQ(Refusal([](MeshingOptions& o) { o.CellSizeOfMaterialMm[2] = 0; }),
    "meshing: size or distance of a material: expected a positive number of mm, found 0");
  EXPECT_EQ(Refusal([](MeshingOptions& o) { o.SmoothingVoxels = 5.5; }),
    "meshing: smoothing: expected 0 to 5 voxels, found 5.5");
}
}
