// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/BreastMechanics.h"

#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MeshVoxels.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SimulationMesh.h"
#endif

#include <algorithm>

namespace mammoray
{
namespace
{
/// A coarse mesh of the breast; `volume` is filled where it is empty.
TetrahedralMesh MakeSimulationMesh(const TetrahedralMesh& anatomy, const std::vector<bool>& held,
  double cellSizeMm, std::optional<LabelVolume>& volume, const ProgressCallback& progress)
{
#ifdef MAMMORAY_HAS_MESHING
  if (!volume)
  {
    volume = Voxelize(anatomy, BreastMechanicsOptions::VoxelMm);
  }
  return MeshForSimulation(*volume, held, cellSizeMm, progress).Mesh;
#else
  (void)held;
  (void)cellSizeMm;
  (void)volume;
  (void)progress;
  throw InputError("mechanics: this build has no Meshing module; expected a simulation mesh, or an "
                   "anatomy of at most " +
    std::to_string(BreastMechanicsOptions::MostCells) + " cells, found " +
    std::to_string(anatomy.NumberOfCells()));
#endif
}
}

BreastMechanics::BreastMechanics(const TetrahedralMesh& anatomy, const MaterialTable& table,
  BreastMechanicsOptions options, const ProgressCallback& progress)
  : Volume(std::move(options.Volume))
{
  const ElasticTable mechanics(table);
  if (std::find(mechanics.Held.begin(), mechanics.Held.end(), true) == mechanics.Held.end())
  {
    throw InputError("table '" + table.Name +
      "': expected a material with \"held\": true (the chest wall), found none");
  }
  this->Elastic = mechanics.Elastic;
  this->Gland = table.Glandular();
  const bool own = !options.Mesh && anatomy.NumberOfCells() <= BreastMechanicsOptions::MostCells;
  if (!options.Mesh && !own)
  {
    options.Mesh =
      MakeSimulationMesh(anatomy, mechanics.Held, options.CellSizeMm, this->Volume, progress);
  }
  const TetrahedralMesh& mesh = own ? anatomy : *options.Mesh;
  this->CellCount = mesh.NumberOfCells();
  if (!own && !this->Volume)
  {
    this->Volume = Voxelize(anatomy, BreastMechanicsOptions::VoxelMm);
  }
  MaterialField field;
  if (this->Volume)
  {
    field = [this](const Vector3& point) { return static_cast<int>(this->Volume->LabelAt(point)); };
  }
  this->Body.emplace(mesh, mechanics.Elastic, mechanics.Held, field);
  if (options.Scouted)
  {
    CompressionOptions linear;
    linear.Element = ElementType::PatchAveragedLinear;
    this->Scout.emplace(mesh, mechanics.Elastic, mechanics.Held, field, linear);
  }
  this->Points.emplace(*this->Body, anatomy.Points);
}

RegistrationModel BreastMechanics::Model()
{
  RegistrationModel model;
  model.Simulation = &*this->Body;
  model.Scout = this->Scout ? &*this->Scout : nullptr;
  model.Elastic = this->Elastic;
  model.ScaledMaterials = this->Gland;
  return model;
}
}
