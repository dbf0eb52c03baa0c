// SPDX-License-Identifier: Apache-2.0
#include "Private/SimulationShape.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Meshing/LabelMesher.h"

#include <chrono>
#include <cmath>
#include <string>

namespace mammoray
{
namespace
{
/// Intended number of cells if no size is given, and the accepted range.
constexpr double WantedCells = 4200;
constexpr double FewestCells = 3400;
constexpr double MostCells = 5200;
/// Largest number of attempts, and the exponent of the number of cells as a function of their size,
/// measured on meshes of breasts.
constexpr int MostMeshes = 4;
constexpr double CellsBySize = 2.4;
/// Fixed cells do not move and can be larger.
constexpr double FixedFactor = 1.5;

/// The most frequent moving and the most frequent fixed material.
struct CommonestMaterials
{
  int Moving = 0;
  int Fixed = 0;
  std::size_t MovingVoxels = 0;

  CommonestMaterials(const LabelVolume& materials, const std::vector<bool>& fixed)
  {
    std::size_t most[2] = { 0, 0 };
    for (const auto& [material, count] : materials.CountLabels())
    {
      if (static_cast<std::size_t>(material) >= fixed.size())
      {
        throw InputError("simulation mesh: expected materials 0 to " +
          std::to_string(fixed.size() - 1) + ", found " + std::to_string(material));
      }
      if (material == 0)
      {
        continue;
      }
      const bool isFixed = fixed[material];
      this->MovingVoxels += isFixed ? 0 : count;
      if (count > most[isFixed])
      {
        most[isFixed] = count;
        (isFixed ? this->Fixed : this->Moving) = material;
      }
    }
  }
};

MeshingOptions SizesFor(double cellSizeMm)
{
  MeshingOptions options;
  constexpr int moving = SimulationShape::Moving;
  options.CellSizeMm = FixedFactor * cellSizeMm;
  options.CellSizeOfMaterialMm[moving] = cellSizeMm;
  options.FacetSizeMm = FixedFactor * 0.8 * cellSizeMm;
  options.FacetSizeOfMaterialMm[moving] = 0.8 * cellSizeMm;
  options.FacetDistanceMm = FixedFactor * 0.1 * cellSizeMm;
  options.FacetDistanceOfMaterialMm[moving] = 0.1 * cellSizeMm;
  options.CellRadiusEdgeRatio = 2.0;
  options.SmallestComponentMm3 = 0;
  return options;
}
}

MeshingResult MeshForSimulation(const LabelVolume& materials, const std::vector<bool>& fixed,
  double cellSizeMm, const ProgressCallback& progress)
{
  const auto start = std::chrono::steady_clock::now();
  if (!(cellSizeMm >= 0))
  {
    throw InputError("simulation mesh: expected a cell size of at least 0 mm, found " +
      std::to_string(cellSizeMm));
  }
  materials.Validate("volume to mesh");
  const CommonestMaterials commonest(materials, fixed);
  if (commonest.MovingVoxels == 0)
  {
    throw InputError("simulation mesh: expected tissue that is not fixed, found none");
  }
  double size = cellSizeMm > 0
    ? cellSizeMm
    : std::cbrt(static_cast<double>(commonest.MovingVoxels) * materials.VoxelVolume()) / 7;
  MeshingResult result;
  double movingMm3 = 0;
  for (int mesh = 0; mesh < MostMeshes; ++mesh)
  {
    const SimulationShape shape = ShapeForCells(materials, fixed, size);
    movingMm3 = shape.MovingMm3;
    result = MeshMaterials(shape.Tissue, SizesFor(size), progress);
    const auto count = static_cast<double>(result.Mesh.NumberOfCells());
    if (cellSizeMm > 0 || (count >= FewestCells && count <= MostCells))
    {
      break;
    }
    size *= std::pow(count / WantedCells, 1 / CellsBySize);
  }
  for (std::int32_t& material : result.Mesh.Materials)
  {
    material = material == SimulationShape::Fixed ? commonest.Fixed : commonest.Moving;
  }
  for (MaterialReport& report : result.Reports)
  {
    const bool isFixed = report.Material == SimulationShape::Fixed;
    report.Material = isFixed ? commonest.Fixed : commonest.Moving;
    report.VolumeInMm3 = isFixed ? report.VolumeInMm3 : movingMm3;
  }
  result.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}
}
