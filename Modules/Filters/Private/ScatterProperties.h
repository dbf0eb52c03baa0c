// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterProperties_h
#define mammoray_ScatterProperties_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"

#include <array>
#include <optional>

namespace mammoray
{
/// What the properties Scatter, AirGapMm and Grid of a filter ask for. The table is read when first
/// needed, and kept.
class ScatterProperties
{
public:
  /// Throws InputError where they do not fit.
  std::optional<ScatterModel> ModelOf(bool scatter, double airGapMm,
    const std::array<double, 3>& gridNumbers, const Spectrum& spectrum,
    const DetectorResponse& response)
  {
    const bool hasGrid = gridNumbers[0] != 0;
    if (!scatter)
    {
      if (hasGrid)
      {
        throw InputError("Grid: expected Scatter beside it, found none");
      }
      return std::nullopt;
    }
    std::optional<AntiscatterGrid> grid;
    if (hasGrid)
    {
      grid.emplace(AntiscatterGridOptions::OfLead(gridNumbers));
    }
    if (!this->Kernels)
    {
      this->Kernels = FindScatterKernels();
    }
    return ScatterModel(*this->Kernels, spectrum, response, airGapMm, grid);
  }

private:
  std::optional<ScatterKernels> Kernels;
};
}

#endif
