// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/ElasticMaterial.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

TEST(ElasticTable, HasAnEntryForEachMaterialInItsOrder)
{
  MaterialTable table;
  for (int n = 0; n < 4; ++n)
  {
    Material material;
    material.Name = "material " + std::to_string(n);
    material.YoungsModulusKPa = 1.5 + n;
    material.PoissonRatio = 0.41 + 0.01 * n;
    material.FungExponent = 2.0 * n;
    material.DensityGPerCm3 = 0.9 + 0.1 * n;
    material.Fixed = n == 2;
    table.Materials.push_back(material);
  }
  const ElasticTable elastic(table);
  ASSERT_EQ(elastic.Elastic.size(), 4u);
  EXPECT_EQ(elastic.Fixed, (std::vector<bool>{ false, false, true, false }));
  for (std::size_t n = 0; n < 4; ++n)
  {
    EXPECT_EQ(elastic.Elastic[n].YoungsModulusKPa, table.Materials[n].YoungsModulusKPa);
    EXPECT_EQ(elastic.Elastic[n].PoissonRatio, table.Materials[n].PoissonRatio);
    EXPECT_EQ(elastic.Elastic[n].FungExponent, table.Materials[n].FungExponent);
    EXPECT_EQ(elastic.Elastic[n].DensityGPerCm3, table.Materials[n].DensityGPerCm3);
  }
  EXPECT_TRUE(ElasticTable().Elastic.empty());
}
}
