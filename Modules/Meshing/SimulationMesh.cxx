// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/SimulationMesh.h"

#include "Private/SimulationShape.h"
#include "mammoray/Foundation/Error.h"

#include <chrono>
#include <cmath>
#include <string>

namespace mammoray
{
namespace
{
/// What is aimed at where no size is asked for, and what is taken.
constexpr double WantedCells = 4200;
constexpr double FewestCells = 3400;
constexpr double MostCells = 5200;
/// Meshes made to get there; cells come with the power of their size that meshes of breasts show.
constexpr int MostMeshes = 4;
constexpr double CellsBySize = 2.4;
/// Held cells move nothing: they may be larger.
constexpr double HeldFactor = 1.5;

/// The commonest materials of what moves and of what is held.
struct CommonestMaterials
{
  int Moving = 0;
  int Held = 0;
  std::size_t MovingVoxels = 0;

  CommonestMaterials(const LabelVolume& materials, const std::vector<bool>& held)
  {
    std::size_t most[2] = { 0, 0 };
    for (const auto& [material, count] : materials.CountLabels())
    {
      if (static_cast<std::size_t>(material) >= held.size())
      {
        throw InputError("simulation mesh: expected materials 0 to " +
          std::to_string(held.size() - 1) + ", found " + std::to_string(material));
      }
      if (material == 0)
      {
        continue;
      }
      const bool isHeld = held[material];
      this->MovingVoxels += isHeld ? 0 : count;
      if (count > most[isHeld])
      {
        most[isHeld] = count;
        (isHeld ? this->Held : this->Moving) = material;
      }
    }
  }
};

MeshingOptions SizesFor(double cellSizeMm)
{
  MeshingOptions options;
  constexpr int moving = SimulationShape::Moving;
  options.CellSizeMm = HeldFactor * cellSizeMm;
  options.CellSizeOfMaterialMm[moving] = cellSizeMm;
  options.FacetSizeMm = HeldFactor * 0.8 * cellSizeMm;
  options.FacetSizeOfMaterialMm[moving] = 0.8 * cellSizeMm;
  options.FacetDistanceMm = HeldFactor * 0.1 * cellSizeMm;
  options.FacetDistanceOfMaterialMm[moving] = 0.1 * cellSizeMm;
  options.CellRadiusEdgeRatio = 2.0;
  options.SmallestComponentMm3 = 0;
  return options;
}
}

MeshingResult MeshForSimulation(const LabelVolume& materials, const std::vector<bool>& held,
  double cellSizeMm, const ProgressCallback& progress)
{
  const auto start = std::chrono::steady_clock::now();
  if (!(cellSizeMm >= 0))
  {
    throw InputError("simulation mesh: expected a cell size of at least 0 mm, found " +
      std::to_string(cellSizeMm));
  }
  materials.Validate("volume to mesh");
  const CommonestMaterials commonest(materials, held);
  if (commonest.MovingVoxels == 0)
  {
    throw InputError("simulation mesh: expected tissue that is not held, found none");
  }
  double size = cellSizeMm > 0
    ? cellSizeMm
    : std::cbrt(static_cast<double>(commonest.MovingVoxels) * materials.VoxelVolume()) / 7;
  MeshingResult result;
  double movingMm3 = 0;
  for (int mesh = 0; mesh < MostMeshes; ++mesh)
  {
    const SimulationShape shape = ShapeForCells(materials, held, size);
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
    material = material == SimulationShape::Held ? commonest.Held : commonest.Moving;
  }
  for (MaterialReport& report : result.Reports)
  {
    const bool isHeld = report.Material == SimulationShape::Held;
    report.Material = isHeld ? commonest.Held : commonest.Moving;
    report.VolumeInMm3 = isHeld ? report.VolumeInMm3 : movingMm3;
  }
  result.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}
}
