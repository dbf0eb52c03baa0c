// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticTable_h
#define mammoray_ElasticTable_h

#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Foundation/MaterialTable.h"

#include <vector>

namespace mammoray
{
/// The mechanical part of a table of materials, one entry per material.
struct ElasticTable
{
  std::vector<ElasticMaterial> Elastic;
  /// True for materials that are fixed to the body and do not move.
  std::vector<bool> Fixed;

  ElasticTable() = default;
  explicit ElasticTable(const MaterialTable& table)
    : Fixed(table.Fixed())
  {
    for (const Material& material : table.Materials)
    {
      this->Elastic.push_back({ .YoungsModulusKPa = material.YoungsModulusKPa,
        .PoissonRatio = material.PoissonRatio,
        .FungExponent = material.FungExponent,
        .DensityGPerCm3 = material.DensityGPerCm3 });
    }
  }
};
}

#endif
