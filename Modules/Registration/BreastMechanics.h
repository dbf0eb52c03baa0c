// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastMechanics_h
#define mammoray_BreastMechanics_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammoray/Registration/RegistrationModel.h"
#include "mammorayRegistrationModule.h"

#include <optional>

namespace mammoray
{
/// What a breast's mechanics are made of besides its anatomy.
struct BreastMechanicsOptions
{
  /// Material indices, from which stiffness is sampled; none: from the anatomy.
  std::optional<LabelVolume> Volume;
  /// Some thousand tetrahedra to simulate on; none: the anatomy itself where it has no more than
  /// MostCells, else a mesh made for the purpose (needs the Meshing module).
  std::optional<TetrahedralMesh> Mesh;
  static constexpr std::size_t MostCells = 6000;
  /// Of the volume of an anatomy without one, from which stiffness is sampled: finer than any
  /// simulation cell.
  static constexpr double VoxelMm = 1.0;
  /// Of the mesh that is made, see MeshForSimulation; mm.
  double CellSizeMm = 0;
  /// Whether Model() has a Scout.
  bool Scouted = false;
};

/**
 * The simulation of a breast whose anatomy is given as tetrahedra, and the anatomy that moves with
 * it. Stays where it is made: others point into it.
 */
class MAMMORAYREGISTRATION_EXPORT BreastMechanics
{
public:
  /// Throws InputError, also where no material of the table is held, and Interrupted.
  BreastMechanics(const TetrahedralMesh& anatomy, const MaterialTable& table,
    BreastMechanicsOptions options = {}, const ProgressCallback& progress = {});
  BreastMechanics(const BreastMechanics&) = delete;
  BreastMechanics& operator=(const BreastMechanics&) = delete;

  /// The model's part that tells of mechanics: simulation and scout, elastic constants, scaled
  /// materials.
  RegistrationModel Model();
  CompressionSimulation& Simulation() { return *this->Body; }
  /// Moves the anatomy's points.
  const Embedding& AnatomyPoints() const { return *this->Points; }
  std::size_t NumberOfCells() const { return this->CellCount; }

private:
  std::optional<LabelVolume> Volume;
  std::vector<ElasticMaterial> Elastic;
  std::vector<int> Gland;
  std::optional<CompressionSimulation> Body;
  std::optional<CompressionSimulation> Scout;
  std::optional<Embedding> Points;
  std::size_t CellCount = 0;
};
}

#endif
