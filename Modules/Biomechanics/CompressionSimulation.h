// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionSimulation_h
#define mammoray_CompressionSimulation_h

#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Biomechanics/SimulationCells.h"
#include "mammoray/Biomechanics/WallAttachment.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
struct FrictionPoint;

struct CompressionOptions
{
  /// Quadratic cells for accuracy on some thousand cells, patch-averaged linear ones where there
  /// are tens of thousands.
  ElementType Element = ElementType::Quadratic;
  ChestWallMode ChestWall = ChestWallMode::Held;
  /// Counts for the elastic chest wall; a sliding one takes Normal from it, and along the wall
  /// SlidingStiffness.
  WallStiffness Wall{ 1000.0, 1.0 };
  /// kPa / mm; positive. Not 0: between plates without friction nothing else would hold the breast
  /// sideways. The weight of a breast of 0.4 kg on a base of 80 cm^2 shears it by 0.5 kPa, so that
  /// it glides by 17 mm, as is seen between lying and standing; a tenth of the pressures of
  /// compression.
  double SlidingStiffness = 0.03;
  /// Coefficient of friction between breast and plates, not negative (smoothed Coulomb friction).
  double Friction = 0.0;
  /// Acceleration of the patient's weight during compression, m/s^2, in the frame of the mesh.
  Vector3 GravityMPerS2{ 0, 0, 0 };
  /**
   * Force with which the technologist draws the breast onto the receptor, N, in the frame of the
   * mesh (the gantry's anterior direction): spread over the volume of what is not held, while the
   * plates close and after. A displacement of the chest wall instead would be the same as a shift
   * of the plates (BreastPose::AnteriorMm).
   */
  Vector3 PullN{ 0, 0, 0 };
  /// Contact: pressure = ContactStiffness * g^2, g the depth in a layer of 0.05 mm in front of each
  /// plate; in the plate along the tangent of that, from 150 kPa on. kPa / mm^2. At a breast's mean
  /// pressure of 1 to 10 kPa it rests 0.04 mm in front of the plates; where the plates' edges cut
  /// into it more than 200 kPa were met.
  double ContactStiffness = 60000.0;
  /// Newton stops when the residual force falls below this fraction of the contact force (or of the
  /// stiffness scale while there is no contact).
  double RelativeTolerance = 1e-8;
  /// Limits one solution; twice as many where contact has to be hardened in small steps.
  int MaximumNewtonSteps = 60;
  /// Largest closing of the plates in one load step of a cold start, as a fraction of the open gap.
  double LargestLoadStep = 0.1;

  bool operator==(const CompressionOptions&) const = default;
};

/// Rate of change of the loading in CompressionOptions with a parameter, per unit of it.
struct LoadingVelocity
{
  WallStiffness Wall;
  double Friction = 0.0;
  Vector3 GravityMPerS2{ 0, 0, 0 };
  Vector3 PullN{ 0, 0, 0 };
};

/// There is no equilibrium between the plates asked for, or it could not be reached.
class CompressionError : public ConvergenceError
{
public:
  CompressionError(const std::string& message, double lastGapMm, const std::string& reason)
    : ConvergenceError(message)
    , LastGap(lastGapMm)
    , Why(reason)
  {
  }
  /// The last distance of the plates on the way that has an equilibrium, mm; of a refusal at once,
  /// where the way ended.
  double LastGapMm() const { return this->LastGap; }
  /// What went wrong beyond it; part of the message.
  const std::string& Reason() const { return this->Why; }

private:
  double LastGap;
  std::string Why;
};

/// Distance of the faces, mm: of the paddle's edge from the face of the support.
MAMMORAYBIOMECHANICS_EXPORT double GapMm(const PlatePair& plates);

/// A converged state of equilibrium.
struct CompressionState
{
  /// Positions of the simulation nodes, 3 x nodeCount, mm.
  std::vector<double> Positions;
  /// Plates of this state.
  PlatePair Plates;
  /// Force of the paddle on the breast along its normal, N (kPa mm^2 = 1e-3 N).
  double PaddleForceN = 0;
  double SupportForceN = 0;
  /// Deepest penetration of a contact point, mm; at most PenetrationLimitMm(Plates).
  double LargestPenetrationMm = 0;
  /// That of the options, or stiffer where that was needed to keep the limit; kPa / mm^2.
  double ContactStiffness = 0;
  /// Smallest and largest det F over the quadrature points.
  double SmallestJ = 1;
  double LargestJ = 1;
  /// Deformed / undeformed volume.
  double VolumeRatio = 1;
  /// See CompressionSimulation::StiffnessFactor.
  double StiffnessFactor = 1;
  /// Norm of the residual force over that of the largest kind of force
  /// (CompressionOptions::RelativeTolerance).
  double RelativeResidual = 0;
  /// How far nodes have left or entered the chest wall and have glided along it at most, mm.
  double LargestWallLiftMm = 0;
  double LargestWallGlideMm = 0;
  /// Normal forces and anchors of friction that the state was found with; null without friction.
  std::shared_ptr<const std::vector<FrictionPoint>> Friction;
  /// Those of the predictor of a cold start are not counted.
  int NewtonSteps = 0;
  int LoadSteps = 0;
  double Seconds = 0;
  /// Most memory that the sparse factorisation took, MiB.
  double FactorMiB = 0;
};

/// The sentence that tells of a CompressionSimulation::StiffnessFactor; empty for 1.
MAMMORAYBIOMECHANICS_EXPORT std::string StiffnessNote(double factor);

/// Deepest penetration that a state may have: 0.05 mm or 0.1 % of the plates' distance, whichever
/// is larger.
MAMMORAYBIOMECHANICS_EXPORT double PenetrationLimitMm(const PlatePair& plates);

/**
 * Quasi-static compression of a nearly incompressible elastic body between two plates as a
 * minimum of energy (DESIGN.md section 6): psi = w(J^(-2/3) tr F^T F - 3) + kappa/2 (J - 1)^2, w
 * neo-Hookean or Fung's exponential (ElasticMaterial.h), on quadratic tetrahedra made from the
 * given linear ones or on these, most of kappa acting on the mean of J over a cell or a patch of
 * cells; contact by a C2 penalty, with smoothed Coulomb friction if wanted; the
 * breast is held by, glides along or is elastically attached to the chest wall. With
 * friction a state depends on the way to it: on the load steps and on the start.
 *
 * One thread at a time: const functions share a solver, whose last factor and evaluation they keep
 * for the next call. That is a cache: it changes what they answer within the tolerance only.
 */
class MAMMORAYBIOMECHANICS_EXPORT CompressionSimulation
{
public:
  /**
   * `mesh`: linear tetrahedra; its cell materials index `materials`. With a `field` the mesh need
   * not follow the anatomy: stiffness is averaged around each quadrature point from it (positions
   * where it answers 0 or a held material fall back on the cell's material). `held[m]` tells
   * whether material m does not move: every node of a cell of such a material is fixed. Unless the
   * chest wall is Held, nodes that other cells share belong to those and move along with them: the
   * held cells at the wall are then only drawn along.
   *
   * With `beside`, tissue whose border was cut rather than grown is held there, whatever the chest
   * wall does: a face of the boundary whose middle, half a side farther out, lies where the body
   * goes on has nodes that do not move. What goes on is as stiff as what was cut and hangs on to
   * the rest of the body: a free face would let it swing, and it does not glide either. Throws
   * InputError.
   */
  CompressionSimulation(const TetrahedralMesh& mesh, const std::vector<ElasticMaterial>& materials,
    const std::vector<bool>& held, const MaterialField& field = {},
    const CompressionOptions& options = {}, const BodyField& beside = {});
  ~CompressionSimulation();
  CompressionSimulation(CompressionSimulation&&) noexcept;
  CompressionSimulation& operator=(CompressionSimulation&&) noexcept;

  /**
   * Another simulation of the same body, of as many materials, that is to go the way of cold starts
   * first: on some thousand quadratic cells it takes seconds, where tens of thousands of cells
   * would take minutes to fold at the plates' edges. From where it arrives this one needs some
   * dozen steps. The meshes may differ by a part of a cell; the same equilibrium is found to the
   * same tolerance, but for tissue that folds at the plates' edges and may fold in several ways
   * (tenths of a mm apart, and some tenths of a per cent of the force, in the tests' breast). Does
   * nothing where the breast rubs. SetMaterials and Unload change it too, and drop it where its
   * elements have no shape without load. Throws InputError.
   */
  void SetPredictor(std::unique_ptr<CompressionSimulation> predictor);

  /**
   * Takes the mesh for the shape of a breast that hangs or lies under this gravity (m/s^2, frame of
   * the mesh), as in an image, with the chest wall of the options, and finds the shape without load
   * that gives it: equilibrium is solved in the known deformed shape (Govindjee & Mihalic 1996), at
   * the points of the mesh exactly, as the forward problem does to UnloadToleranceMm. Materials
   * keep their cells. SetMaterials finds the shape again that belongs to the new materials. Where
   * tissue is too soft to bear its weight, StiffnessFactor tells of it. Throws ConvergenceError,
   * Interrupted; things are then as before.
   */
  void Unload(const Vector3& gravityMPerS2, const ProgressCallback& progress = {});
  static constexpr double UnloadToleranceMm = 1e-3;
  /**
   * What Unload has raised all stiffness by, that of the chest wall's layer too: 1, or the least
   * factor (to a twentieth, never less) with which there is a shape without load from which the
   * image's is a stable equilibrium. Materials and options are as they were given. It stays when
   * the materials change, or rises where it must.
   */
  double StiffnessFactor() const;

  /// What a cold start that fails tells.
  enum class Refusal
  {
    /// The last gap that has an equilibrium: a search that takes several times as long as the
    /// start.
    WithLastGap,
    /// Where the way with soft contact ended.
    AtOnce
  };

  /// The plates opened along their normals until they touch nothing of the breast as it hangs free.
  PlatePair OpenedPlates(const PlatePair& plates, const ProgressCallback& progress = {}) const;

  /**
   * Equilibrium between the plates. Cold: the breast first settles under gravity and pull, the
   * plates opened along their normals until they touch nothing, then closed in load steps; without
   * friction, quadratic elements let linear ones on the same cells, or the predictor, go this way
   * and start from where these arrive, or go it themselves if that fails. Warm: starts at `start`
   * (a state of this simulation) and goes straight to the new plates, in steps where that fails.
   * Deterministic. Contact is made stiffer until the penetration is within its limit. Throws
   * ConvergenceError that names the last gap reached or the limit that was missed and the value
   * found, or Interrupted. What is answered has J > 0 at every quadrature point; corners of cells
   * may still be turned over.
   */
  CompressionState Compress(const PlatePair& plates, const CompressionState* start = nullptr,
    const ProgressCallback& progress = {}, Refusal refusal = Refusal::WithLastGap) const;

  /**
   * The equilibrium that a state of another simulation of the same body stands for, between its
   * plates: of several (a breast that is higher than wide topples to either side, tissue folds) the
   * one that the other has found. Meshes may differ as those of a predictor may. Where nothing is
   * found from there, and with friction, it is that of a cold start. Throws as Compress, at once.
   */
  CompressionState Adopt(const CompressionSimulation& other, const CompressionState& state,
    const ProgressCallback& progress = {}) const;

  /**
   * dx/dp at a converged state for parameters that move the plates, then for those that change the
   * materials (one rate per material: with { {}, {}, { fat's modulus } } p is the ratio of material
   * 2's stiffness to fat's), then for those that change the loading, by the implicit function
   * theorem: one back-substitution each. Returns one vector of 3 x nodeCount (mm per unit of p) for
   * each. With friction they are exact for the last load step with its normal forces frozen. After
   * Unload the shape without load changes with the materials and with the chest wall's stiffness;
   * StiffnessFactor counts as given.
   */
  std::vector<std::vector<double>> Sensitivities(const CompressionState& state,
    const std::vector<PlatePairVelocity>& velocities,
    const std::vector<MaterialVelocity>& materialVelocities = {},
    const std::vector<LoadingVelocity>& loadingVelocities = {}) const;

  /// Rate of PaddleForceN with a parameter that moves the plates, N per unit; as exact.
  double PaddleForceRate(const CompressionState& state, const PlatePairVelocity& velocity) const;

  /**
   * The state in which the paddle presses with `forceN` (positive), to a ten-thousandth of it, by
   * Newton's method on the exact rate of the force, bracketed. `plates` stand anywhere on their
   * way; `closing` is how they move with a parameter that brings them together. Throws
   * CompressionError that names the last gap and its force where the plates cannot be closed so
   * far, else as Compress.
   */
  CompressionState CompressToForce(const PlatePair& plates, const PlatePairVelocity& closing,
    double forceN, const ProgressCallback& progress = {}) const;

  /**
   * Other constants for the materials, as many as at construction, with the mesh, the field and the
   * order of the unknowns kept: states from before are starts for Compress, no longer equilibria.
   * After Unload the shape without load is found anew. Throws InputError, and after Unload
   * ConvergenceError, and then leaves things as they were.
   */
  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  const std::vector<ElasticMaterial>& Materials() const;

  /// Volume change and stress of every cell of the mesh in a state.
  std::vector<CellMeasures> MeasuresOf(const CompressionState& state) const;
  /// Pressure of the plates at every node, kPa: 0 inside the body and where nothing touches.
  std::vector<double> ContactPressuresKPa(const CompressionState& state) const;

  std::size_t NumberOfNodes() const;
  std::size_t NumberOfUnknowns() const;
  /// Undeformed node positions, 3 x nodeCount, mm. The first nodes are the mesh's points.
  const std::vector<double>& RestPositions() const;
  /// Node positions in the mesh as it was given: RestPositions, or, after Unload, the equilibrium
  /// under that gravity, at the mesh's points to UnloadToleranceMm.
  const std::vector<double>& ImagePositions() const;

private:
  friend class Embedding;
  /// How far Compress goes: contact hard and all limits kept; or only a prediction
  /// for another simulation, soft contact and a wide tolerance.
  enum class Finish
  {
    Complete,
    Prediction
  };
  /// Cold where there is no start: by way of `predicted` positions, or of the predictor.
  CompressionState Run(const PlatePair& plates, const CompressionState* start, Finish finish,
    const ProgressCallback& progress, double loadStepFactor = 1,
    std::vector<double> predicted = {}) const;
  /// A cold run; where it fails, another one in smaller steps.
  CompressionState RunCold(const PlatePair& plates, const ProgressCallback& progress) const;
  /// The least gap from `fromMm` on, in steps of 15 %, that has an equilibrium, mm.
  double LeastGapMm(const PlatePair& plates, double fromMm, const ProgressCallback& progress) const;
  /// Where the predictor moves the nodes to; empty where it cannot.
  std::vector<double> PredictedPositions(const PlatePair& plates,
    const ProgressCallback& progress) const;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};
}

#endif
