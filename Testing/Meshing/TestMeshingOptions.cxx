// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/Meshing/LabelMesher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace
{
using mammoray::test::RefusalOf;
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
  EXPECT_THAT(Refusal([](MeshingOptions& o) { o.CellSizeMm = -1; }),
    test::Mentions("cell size", "-1"));
  EXPECT_THAT(Refusal([](MeshingOptions& o) { o.FacetAngleDeg = 31; }),
    test::Mentions("facet angle", "0 to 30", "31"));
  EXPECT_THAT(Refusal([](MeshingOptions& o) { o.FacetDistanceMm = NAN; }),
    test::Mentions("facet distance", "nan"));
  EXPECT_THAT(Refusal([](MeshingOptions& o) { o.CellSizeOfMaterialMm[2] = 0; }),
    test::Mentions("of a material", "found 0"));
  EXPECT_THAT(Refusal([](MeshingOptions& o) { o.SmoothingVoxels = 5.5; }),
    test::Mentions("smoothing", "0 to 5", "5.5"));
}
}
