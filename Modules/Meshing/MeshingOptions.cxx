// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/MeshingOptions.h"

#include "mammoray/Foundation/Error.h"

#include <cmath>
#include <sstream>
#include <string>

namespace mammoray
{
MeshingOptions MeshingOptions::Anatomy(const std::vector<int>& thinMaterials)
{
  MeshingOptions options;
  options.CellSizeMm = 5.0;
  options.FacetSizeMm = 3.0;
  options.FacetDistanceMm = 0.5;
  for (const int material : thinMaterials)
  {
    options.FacetSizeOfMaterialMm[material] = 1.2;
    options.FacetDistanceOfMaterialMm[material] = 0.25;
    options.CellSizeOfMaterialMm[material] = 2.0;
  }
  options.LayerFacetSizeMm = 0.5;
  options.OptimisationSeconds = 0;
  return options;
}

void MeshingOptions::Validate() const
{
  const auto need = [](bool good, const char* name, const char* expected, double found)
  {
    if (!good || !std::isfinite(found))
    {
      std::ostringstream text;
      text << "meshing: " << name << ": expected " << expected << ", found " << found;
      throw InputError(text.str());
    }
  };
  need(this->CellSizeMm > 0, "cell size", "a positive number of mm", this->CellSizeMm);
  need(this->FacetSizeMm > 0, "facet size", "a positive number of mm", this->FacetSizeMm);
  for (const auto* sizes :
    { &this->CellSizeOfMaterialMm, &this->FacetSizeOfMaterialMm, &this->FacetDistanceOfMaterialMm })
  {
    for (const auto& [material, size] : *sizes)
    {
      need(size > 0, "size or distance of a material", "a positive number of mm", size);
    }
  }
  need(this->LayerFacetSizeMm >= 0, "layer facet size", "a number of mm of at least 0",
    this->LayerFacetSizeMm);
  need(this->FacetDistanceMm > 0, "facet distance", "a positive number of mm",
    this->FacetDistanceMm);
  need(this->FacetAngleDeg >= 0 && this->FacetAngleDeg <= 30, "facet angle",
    "0 to 30 degrees (refinement need not end above)", this->FacetAngleDeg);
  need(this->CellRadiusEdgeRatio >= 2 || this->CellRadiusEdgeRatio == 0, "cell radius-edge ratio",
    "at least 2 (refinement need not end below), or 0 for none", this->CellRadiusEdgeRatio);
  need(this->SmallestComponentMm3 >= 0, "smallest component", "a number of mm3 of at least 0",
    this->SmallestComponentMm3);
  need(this->SmoothingVoxels >= 0 && this->SmoothingVoxels <= 5, "smoothing", "0 to 5 voxels",
    this->SmoothingVoxels);
  need(this->SmallestDihedralDeg >= 0 && this->SmallestDihedralDeg <= 40, "smallest dihedral angle",
    "0 to 40 degrees", this->SmallestDihedralDeg);
  need(this->OptimisationSeconds >= 0, "optimisation time", "a number of s of at least 0",
    this->OptimisationSeconds);
}
}
