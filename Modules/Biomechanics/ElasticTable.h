// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticTable_h
#define mammoray_ElasticTable_h

#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Foundation/MaterialTable.h"

#include <vector>

namespace mammoray
{
/// What mechanics needs of a table of materials, one entry for each.
struct ElasticTable
{
  std::vector<ElasticMaterial> Elastic;
  /// Whether the body holds it.
  std::vector<bool> Held;

  ElasticTable() = default;
  explicit ElasticTable(const MaterialTable& table)
    : Held(table.Held())
  {
    for (const Material& material : table.Materials)
    {
      this->Elastic.push_back({ material.YoungsModulusKPa, material.PoissonRatio,
        material.FungExponent, material.DensityGPerCm3 });
    }
  }
};
}

#endif
