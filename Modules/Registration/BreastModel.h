// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastModel_h
#define mammoray_BreastModel_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/Volumes.h"
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
 * Radius of the plates' chest-wall edges in a search, mm. It is larger than a unit's 3 mm and than
 * the 6 mm between the nodes of a patient's mechanics: tissue passes a sharper edge node by node,
 * in jumps of some mm that derivatives do not show.
 */
inline constexpr double SearchedEdgeRadiusMm = 8.0;

/// A unit that a pose places around a breast: the unit, and the frame that the pose refers to.
struct MAMMORAYREGISTRATION_EXPORT UnitPlacement
{
  PoseFrame Frame;
  MammographyUnit Unit;

  VolumeFromGantry At(const BreastPose& pose) const
  {
    return PlaceUnit(this->Frame, this->Unit, pose);
  }
  /// The plates in the volume frame.
  PlatePair PlatesAt(const BreastPose& pose) const;
  /// Velocities of the plates with each of PoseParameters before the stiffness, per mm or degree.
  std::vector<PlatePairVelocity> PlateVelocitiesAt(const BreastPose& pose) const;
};

/**
 * Simulation of a breast whose glandular stiffness is a parameter of the pose, and the X-rayed
 * surface that moves with it. Calls set the stiffness of the simulation as they need it.
 */
class MAMMORAYREGISTRATION_EXPORT BreastBody
{
public:
  /// `elastic`: the simulation's materials at a stiffness of 1; `gland`: indices of those that are
  /// scaled by it.
  BreastBody(CompressionSimulation simulation, std::vector<ElasticMaterial> elastic,
    std::vector<int> gland);

  CompressionSimulation& Simulation() { return this->Simulated; }
  const CompressionSimulation& Simulation() const { return this->Simulated; }
  const std::vector<ElasticMaterial>& Elastic() const { return this->ReferenceMaterials; }
  /// Replaces the materials at a stiffness of 1, as many as before.
  void SetElastic(std::vector<ElasticMaterial> elastic);
  /// True if the stiffness scales any material.
  bool HasGland() const { return !this->Gland.empty(); }

  /// Sets the X-rayed points: 3 x pointCount, frame of the mesh, mm.
  void SetSurface(const std::vector<double>& points);
  /// Throws InputError if no surface was set.
  const Embedding& Surface() const;

  /// Equilibrium at a pose. Throws as CompressionSimulation::Compress, at once.
  CompressionState Compress(const UnitPlacement& placement, const BreastPose& pose,
    const CompressionState* start = nullptr, const ProgressCallback& progress = {});

  /// The equilibrium that `state` of another body of the same breast, at this stiffness, stands
  /// for (CompressionSimulation::Adopt).
  CompressionState Adopt(const BreastBody& other, const CompressionState& state, double stiffness,
    const ProgressCallback& progress = {});

  /**
   * How points that move with the simulation change with the parameters numbered in `wanted`, seen
   * from the unit: exact derivatives of their equilibrium `state` at `pose` minus the motion of the
   * unit's own points. `positions`: of the points in that state (Embedding::Map). One field
   * each, volume frame, mm per unit of the parameter.
   */
  VectorFields VelocitiesSeenFromUnit(const UnitPlacement& placement, const BreastPose& pose,
    const CompressionState& state, const Embedding& points, const std::vector<double>& positions,
    const std::vector<int>& wanted);

private:
  void SetStiffness(double factor);
  MaterialDerivative StiffnessVelocity() const;

  CompressionSimulation Simulated;
  std::vector<ElasticMaterial> ReferenceMaterials;
  std::vector<int> Gland;
  std::optional<Embedding> SurfacePoints;
};

/**
 * Largest number of cells of a mesh that is simulated as it is: 20000 quadratic or 150000 linear
 * ones, whose cold start takes about a minute and a gigabyte (Validation/reports/speed.md). Larger
 * meshes are carried by a coarser one, on which each equilibrium of a search takes seconds.
 */
MAMMORAYREGISTRATION_EXPORT std::size_t MostSimulationCells(ElementType element);

/**
 * Makes a coarse mesh for the mechanics of a volume of material indices (MeshForSimulation of the
 * Meshing module). `fixed`: whether each material is fixed. Throws InputError in a build without
 * Meshing.
 */
MAMMORAYREGISTRATION_EXPORT TetrahedralMesh MakeSimulationMesh(const LabelVolume& materials,
  const std::vector<bool>& fixed, double cellSizeMm, const ProgressCallback& progress = {});

/**
 * Gives a simulation of more than 20000 linear cells, whose cold start takes longer than ten
 * seconds, a coarse quadratic mesh that finds the way first
 * (CompressionSimulation::SetPredictor). Quadratic cells use their linear ones for that. Does
 * nothing if no such mesh can be made. `mesh`, `materials`, `options`: those of the simulation.
 */
MAMMORAYREGISTRATION_EXPORT void AddColdStartPredictor(CompressionSimulation& simulation,
  const TetrahedralMesh& mesh, const ElasticTable& materials, const CompressionOptions& options,
  const ProgressCallback& progress = {});

/// Everything that a breast's mechanics need besides its anatomy.
struct BreastModelOptions
{
  /// Material indices from which stiffness is sampled. If empty, it is sampled from the anatomy.
  std::optional<LabelVolume> Volume;
  /// If set, replaces Volume as the source of stiffness.
  MaterialField Field;
  /// Where the body continues beyond the cut tissue (CompressionSimulation). Empty: nowhere.
  BodyField OutsideTissue;
  /// Tetrahedra for the mechanics. If empty, the anatomy itself is used up to MostSimulationCells,
  /// and beyond that a mesh of Volume with this cell size, mm (MakeSimulationMesh).
  std::optional<TetrahedralMesh> SimulationMesh;
  double CellSizeMm = 0;
  /// Elements, chest wall and loads of the simulation.
  CompressionOptions Compression;
  /// Gravity that loads the anatomy in its image, m/s^2; the stress-free shape is found from it
  /// (CompressionSimulation::Unload). Zero: the image shows the stress-free shape.
  Vector3 ImageGravityMPerS2{ 0, 0, 0 };
  /// Adds a predictor: linear elements on the same mesh, ten times as fast. A search begins with
  /// it.
  bool Predicted = false;
};

/**
 * A breast that can be compressed and X-rayed: its anatomy, the simulation that moves it, a faster
 * one that predicts where a search leads, and projector and beam. It does not know the unit
 * (UnitPlacement). Its methods change the state of simulations and projector, so only one thread
 * may use a model at a time.
 */
class MAMMORAYREGISTRATION_EXPORT BreastModel
{
public:
  /// `gland`: the materials that BreastPose::Stiffness scales, possibly none. Throws InputError and
  /// Interrupted.
  BreastModel(TetrahedralMesh anatomy, const ElasticTable& materials, std::vector<int> gland,
    BreastModelOptions options = {}, const ProgressCallback& progress = {});
  /// Throws InputError, too, where no material of the table is fixed.
  BreastModel(TetrahedralMesh anatomy, const MaterialTable& table, BreastModelOptions options = {},
    const ProgressCallback& progress = {});

  const TetrahedralMesh& Anatomy() const { return this->Tissue; }
  BreastBody& Body() { return this->Quadratic; }
  const BreastBody& Body() const { return this->Quadratic; }
  /// Null unless BreastModelOptions::Predicted.
  BreastBody* Predictor() { return this->Predicting ? &*this->Predicting : nullptr; }
  std::size_t NumberOfSimulationCells() const { return this->CellCount; }
  /// True if a mesh other than the anatomy's is simulated.
  bool IsCarried() const { return this->Carried; }
  /// Interpolates the anatomy's points from Body; made at the first call.
  const Embedding& AnatomyPoints();

  /// Sets projector, beam and surface. `surface`: the interfaces of the materials, uncompressed, in
  /// the frame of the anatomy.
  void SetXRays(SurfaceMesh surface, std::unique_ptr<PathLengthProjector> projector, Beam beam);
  /// Replaces spectrum and detector.
  void SetBeam(Beam beam);
  /// Sets the scatter of the same beam; nothing (the default): primary radiation alone.
  void SetScatter(std::optional<ScatterModel> scatter) { this->Scattering = std::move(scatter); }
  const std::optional<ScatterModel>& Scatter() const { return this->Scattering; }
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
    const XRayDetector& detector, const VectorFields& velocities,
    PathLengthDerivatives& derivatives);

private:
  struct Basis;
  BreastModel(TetrahedralMesh&& anatomy, const ElasticTable& materials, std::vector<int> gland,
    const BreastModelOptions& options, const Basis& basis, const ProgressCallback& progress);

  TetrahedralMesh Tissue;
  BreastBody Quadratic;
  std::optional<BreastBody> Predicting;
  std::size_t CellCount = 0;
  bool Carried = false;
  std::optional<Embedding> TissuePoints;
  SurfaceMesh Interfaces;
  std::vector<std::array<std::uint32_t, 2>> Edges;
  std::unique_ptr<PathLengthProjector> Projector;
  std::optional<Beam> Rays;
  std::optional<ScatterModel> Scattering;
};
}

#endif
