// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastModel_h
#define mammoray_BreastModel_h

#include "mammoray/Biomechanics/ElasticTable.h"
#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammoray/Registration/BreastBody.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace mammoray
{
/**
 * Cells up to which a mesh is simulated on as it is: 20000 quadratic or 150000 linear ones, whose
 * cold start takes about a minute and a gigabyte (docs/speed.md). What is larger moves with
 * a coarser mesh made for the purpose, on which a search takes seconds for each equilibrium.
 */
MAMMORAYREGISTRATION_EXPORT std::size_t MostSimulationCells(ElementType element);

/**
 * A coarse mesh to simulate the tissue of a volume of material indices on: MeshForSimulation of the
 * Meshing module. Throws InputError in a build without it.
 */
MAMMORAYREGISTRATION_EXPORT TetrahedralMesh MakeSimulationMesh(const LabelVolume& materials,
  const std::vector<bool>& held, double cellSizeMm, const ProgressCallback& progress = {});

/**
 * Lets a coarse quadratic mesh go the way of a cold start first
 * (CompressionSimulation::SetPredictor) where `mesh`, that of the simulation, has more than 20000
 * linear cells, on which this takes longer than ten seconds; quadratic cells have their linear ones
 * for that. Does nothing where no such mesh can be made. `materials`, `options`: those of the
 * simulation.
 */
MAMMORAYREGISTRATION_EXPORT void AddColdStartPredictor(CompressionSimulation& simulation,
  const TetrahedralMesh& mesh, const ElasticTable& materials, const CompressionOptions& options,
  const ProgressCallback& progress = {});

/// What a breast's mechanics are made of besides its anatomy.
struct BreastModelOptions
{
  /// Material indices, from which stiffness is sampled; none: from the anatomy.
  std::optional<LabelVolume> Volume;
  /// Samples stiffness in place of a volume, where given.
  MaterialField Field;
  /// Where the body goes on that the tissue was cut out of (CompressionSimulation); none: nowhere.
  BodyField OutsideTissue;
  /// Tetrahedra to simulate on; none: the anatomy itself up to MostSimulationCells, else a mesh
  /// that is made of the volume (MakeSimulationMesh) with this cell size, mm.
  std::optional<TetrahedralMesh> SimulationMesh;
  double CellSizeMm = 0;
  /// Elements, chest wall and loads of the simulation.
  CompressionOptions Compression;
  /// The weight that the anatomy hangs or lies under in its image, m/s^2, which is unloaded of
  /// (CompressionSimulation::Unload); zero: none.
  Vector3 ImageGravityMPerS2{ 0, 0, 0 };
  /// Makes a predictor: linear elements on the same mesh, ten times as fast, with which a search
  /// begins.
  bool Predicted = false;
};

/**
 * A breast that can be compressed and X-rayed: its anatomy, the simulation that moves it, a cheaper
 * one that predicts where a search leads, and the projector and beam that picture it. It knows no
 * unit (UnitPlacement). What is asked of it changes the state of its simulations and of its
 * projector: one model is not to be used by two threads at a time.
 */
class MAMMORAYREGISTRATION_EXPORT BreastModel
{
public:
  /// `gland`: the materials that BreastPose::Stiffness scales, possibly none. Throws InputError and
  /// Interrupted.
  BreastModel(TetrahedralMesh anatomy, const ElasticTable& materials, std::vector<int> gland,
    BreastModelOptions options = {}, const ProgressCallback& progress = {});
  /// Throws InputError, too, where no material of the table is held.
  BreastModel(TetrahedralMesh anatomy, const MaterialTable& table, BreastModelOptions options = {},
    const ProgressCallback& progress = {});

  const TetrahedralMesh& Anatomy() const { return this->Tissue; }
  BreastBody& Body() { return this->Full; }
  const BreastBody& Body() const { return this->Full; }
  /// Null where none was asked for.
  BreastBody* Predictor() { return this->Cheap ? &*this->Cheap : nullptr; }
  std::size_t NumberOfSimulationCells() const { return this->CellCount; }
  /// Whether another mesh than the anatomy's is simulated on.
  bool IsCarried() const { return this->Carried; }
  /// Moves the anatomy's points with Body; made when first asked for.
  const Embedding& AnatomyPoints();

  /// Gives the model what it is X-rayed with. `surface`: the interfaces of its materials, at rest,
  /// in the frame of the anatomy; the projector is given it.
  void SetXRays(SurfaceMesh surface, std::unique_ptr<PathLengthProjector> projector, Beam beam);
  /// Another spectrum or detector.
  void SetBeam(Beam beam);
  /// What of the same beam scatters onto its pictures; nothing, as at first: pictures are of the
  /// primary radiation alone.
  void SetScatter(std::optional<ScatterModel> scatter) { this->Secondary = std::move(scatter); }
  const std::optional<ScatterModel>& Scatter() const { return this->Secondary; }
  bool HasXRays() const { return this->Projector != nullptr; }
  const SurfaceMesh& Surface() const { return this->Interfaces; }
  /// The edges between skin and air of the surface (OuterEdges).
  const std::vector<std::array<std::uint32_t, 2>>& SurfaceEdges() const { return this->Edges; }
  const Beam& XRays() const { return *this->Rays; }
  /// Path lengths through the surface with its points at `points`.
  PathLengthImage Project(const std::vector<double>& points, const XRaySource& source,
    const XRayDetector& detector);
  /// The same with derivatives (see PathLengthProjector::Project).
  PathLengthImage Project(const std::vector<double>& points, const XRaySource& source,
    const XRayDetector& detector, const std::vector<double>& velocities, int fields,
    PathLengthDerivatives& derivatives);

private:
  struct Basis;
  BreastModel(TetrahedralMesh&& anatomy, const ElasticTable& materials, std::vector<int> gland,
    const BreastModelOptions& options, const Basis& basis, const ProgressCallback& progress);

  TetrahedralMesh Tissue;
  BreastBody Full;
  std::optional<BreastBody> Cheap;
  std::size_t CellCount = 0;
  bool Carried = false;
  std::optional<Embedding> TissuePoints;
  SurfaceMesh Interfaces;
  std::vector<std::array<std::uint32_t, 2>> Edges;
  std::unique_ptr<PathLengthProjector> Projector;
  std::optional<Beam> Rays;
  std::optional<ScatterModel> Secondary;
};
}

#endif
