// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionSimulation_h
#define mammoray_CompressionSimulation_h

#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
struct FrictionPoint;

/// Means over the quadrature points of a deformed cell.
struct CellMeasures
{
  /// det F: deformed volume divided by undeformed volume.
  double J = 1;
  /// Von Mises equivalent of the Cauchy stress, kPa.
  double VonMisesKPa = 0;
};

/// Returns the material index at a position of the undeformed body (mm, frame of the mesh); 0 is
/// outside.
using MaterialField = std::function<int(const Vector3&)>;

/// Returns true where the body continues at a position outside the mesh (mm, frame of the mesh).
using BodyField = std::function<bool(const Vector3&)>;

/// Interpolation of the displacement in a tetrahedron, and the cells that share one volume
/// constraint.
enum class ElementType
{
  /// Ten nodes; one volume constraint per cell, besides a weaker one at each quadrature point.
  Quadratic,
  /// Four nodes; one volume constraint per patch of about eight cells.
  PatchAveragedLinear
};

/// How the breast is attached to the fixed materials.
enum class ChestWallMode
{
  /// The nodes at the wall do not move.
  Fixed,
  /// The nodes slide along the surface of the fixed body and hardly leave it.
  Sliding,
  /// An elastic layer connects breast and wall.
  Elastic
};

/// Stiffness of the layer between chest wall and breast: traction per displacement, kPa / mm.
struct WallStiffness
{
  /// Across the wall, for leaving and entering it; positive.
  double Normal = 0;
  /// Along the wall; not negative.
  double Tangential = 0;

  bool operator==(const WallStiffness&) const = default;
};

struct CompressionOptions
{
  /// Quadratic cells are accurate on a few thousand cells. Patch-averaged linear cells are for
  /// meshes of tens of thousands.
  ElementType Element = ElementType::Quadratic;
  ChestWallMode ChestWall = ChestWallMode::Fixed;
  /// Stiffness of the elastic chest wall. A sliding wall uses Normal from here and SlidingStiffness
  /// along the wall. A fixed wall ignores both.
  WallStiffness Wall{ 1000.0, 1.0 };
  /**
   * Tangential stiffness of a sliding chest wall, kPa / mm; positive. It must not be 0, because
   * nothing else resists a sideways shift between plates without friction. With the default, the
   * weight of a breast of 0.4 kg on a base of 80 cm^2 (0.5 kPa of shear) moves it by 17 mm, which
   * is what is observed between lying and standing. It is a tenth of the pressures of compression.
   */
  double SlidingStiffness = 0.03;
  /// Coefficient of the smoothed Coulomb friction between breast and plates; not negative.
  double Friction = 0.0;
  /// Acceleration of gravity during compression, m/s^2, in the frame of the mesh.
  Vector3 GravityMPerS2{ 0, 0, 0 };
  /**
   * Force with which the technologist pulls the breast onto the receptor, N, in the frame of the
   * mesh (the gantry's anterior direction). It is distributed over the volume of the tissue that is
   * not fixed and acts while and after the plates close. Displacing the chest wall instead would
   * equal a shift of the plates (BreastPose::AnteriorMm).
   */
  Vector3 PullN{ 0, 0, 0 };
  /**
   * Contact pressure = ContactStiffness * g^2, where g is the depth inside a layer of 0.05 mm in
   * front of each plate; kPa / mm^2. Inside the plate the pressure follows the tangent of this
   * parabola, from 150 kPa on. At a mean pressure of 1 to 10 kPa a breast rests 0.04 mm in front of
   * the plates. At the plates' edges more than 200 kPa have been observed.
   */
  double ContactStiffness = 60000.0;
  /// Newton's method stops when the norm of the residual force is below this fraction of the norm
  /// of the contact force, or of a force derived from the stiffness while nothing touches.
  double RelativeTolerance = 1e-8;
  /// Largest number of Newton steps of one solution. Twice as many are allowed where contact must
  /// be hardened in small steps.
  int MaximumNewtonSteps = 60;
  /// Largest closing of the plates in one load step of a cold start, as a fraction of the open gap.
  double LargestLoadStep = 0.1;

  bool operator==(const CompressionOptions&) const = default;
};

/// Derivative of the loading in CompressionOptions with respect to a parameter, per unit of it.
struct LoadingDerivative
{
  WallStiffness Wall;
  double Friction = 0.0;
  Vector3 GravityMPerS2{ 0, 0, 0 };
  Vector3 PullN{ 0, 0, 0 };
};

/// No equilibrium exists between the requested plates, or it could not be reached.
class CompressionError : public ConvergenceError
{
public:
  CompressionError(const std::string& message, double lastGapMm, const std::string& reason)
    : ConvergenceError(message)
    , LastGap(lastGapMm)
    , ReasonText(reason)
  {
  }
  /// The smallest distance of the plates on the way for which an equilibrium was found, mm. With
  /// Refusal::AtOnce, the distance at which the solver gave up.
  double LastGapMm() const { return this->LastGap; }
  /// Why the solver could not go further; also a part of the message.
  const std::string& Reason() const { return this->ReasonText; }

private:
  double LastGap;
  std::string ReasonText;
};

/// Distance from the face of the support to the paddle's edge, mm.
MAMMORAYBIOMECHANICS_EXPORT double GapMm(const PlatePair& plates);

/// Forces and measures of a set of node positions.
struct EquilibriumMeasures
{
  /// Force of the paddle on the breast along its normal, N (kPa mm^2 = 1e-3 N).
  double PaddleForceN = 0;
  double SupportForceN = 0;
  /// Deepest penetration of a contact point into a plate, mm; at most PenetrationLimitMm(Plates) in
  /// a CompressionState.
  double LargestPenetrationMm = 0;
  /// Smallest and largest det F over the quadrature points.
  double SmallestJ = 1;
  double LargestJ = 1;
  /// Deformed volume divided by undeformed volume.
  double VolumeRatio = 1;
  /// Norm of the residual force divided by the norm of the largest kind of force; compare
  /// CompressionOptions::RelativeTolerance.
  double RelativeResidual = 0;
  /// Largest distance that a node of the chest wall has moved across the wall and along it, mm.
  double LargestWallLiftMm = 0;
  double LargestWallGlideMm = 0;
};

/// A converged equilibrium.
struct CompressionState : EquilibriumMeasures
{
  /// Positions of the simulation nodes, 3 x nodeCount, mm.
  std::vector<double> Positions;
  /// The plates between which the body is in equilibrium.
  PlatePair Plates;
  /// Contact stiffness that was used, kPa / mm^2: that of the options, or more where the
  /// penetration limit required it.
  double ContactStiffness = 0;
  /// Factor on all stiffness; see CompressionSimulation::StiffnessFactor.
  double StiffnessFactor = 1;
  /// Normal forces and anchors of friction in this state; null without friction.
  std::shared_ptr<const std::vector<FrictionPoint>> Friction;
  /// Newton steps and load steps of this simulation; those of a predictor are not counted.
  int NewtonSteps = 0;
  int LoadSteps = 0;
  double Seconds = 0;
  /// Largest memory of the sparse factorisation, MiB.
  double FactorMiB = 0;
};

/// A sentence for users that states a CompressionSimulation::StiffnessFactor above 1; empty for 1.
MAMMORAYBIOMECHANICS_EXPORT std::string StiffnessNote(double factor);

/// Largest penetration that a state may have, mm: 0.05 mm or 0.1 % of the plates' distance,
/// whichever is larger.
MAMMORAYBIOMECHANICS_EXPORT double PenetrationLimitMm(const PlatePair& plates);

/**
 * Quasi-static compression of a nearly incompressible elastic body between two rigid plates. The
 * equilibrium minimises the potential energy
 *
 *   E = sum_q w_q psi(F_q) + sum_s A_s b(g_s),   psi = w(J^(-2/3) tr F^T F - 3) + kappa/2 (J -
 * 1)^2,
 *
 * where q are quadrature points with weights w_q, F_q is the deformation gradient, J = det F_q, and
 * w is the neo-Hookean or Fung's exponential law (ShapeEnergy). b is a C2 penalty of the gap g_s
 * between a surface point s of area A_s and a plate. Smoothed Coulomb friction, gravity and a pull
 * are optional. Elements are quadratic tetrahedra made from the given linear ones, or these linear
 * ones; most of kappa acts on the mean of J over a cell or a patch of cells, which prevents
 * locking. The breast is fixed to the chest wall, slides along it, or is attached to it
 * elastically.
 *
 * With friction a state depends on the load steps and on the start. Methods that solve change the
 * solver's last factor and evaluation, so they are not const; later results differ by no more than
 * the tolerance. One thread may use a simulation at a time. It uses all cores itself.
 */
class MAMMORAYBIOMECHANICS_EXPORT CompressionSimulation
{
public:
  /**
   * `mesh` holds linear tetrahedra, mm; their materials index `materials`. With a `field` the mesh
   * need not follow the anatomy: stiffness is averaged from the field around each quadrature point.
   * Where the field answers 0 or a fixed material, the cell's own material is used. `fixed[m]` is
   * true if material m does not move: all nodes of its cells are fixed. If the chest wall is not
   * Fixed, nodes that such a cell shares with other cells move with those cells, and the fixed
   * cells at the wall are only deformed along.
   *
   * `outsideTissue` tells where the body continues outside the mesh. A face of the boundary is a
   * cut if the point half a side outside its centroid lies there. The nodes of a cut do not move,
   * whatever the mode of the chest wall: the tissue outside is as stiff as the tissue inside and is
   * connected with the rest of the body, so it neither swings nor slides. Throws InputError on an
   * unusable mesh, material or option.
   */
  CompressionSimulation(const TetrahedralMesh& mesh, const std::vector<ElasticMaterial>& materials,
    const std::vector<bool>& fixed, const MaterialField& field = {},
    const CompressionOptions& options = {}, const BodyField& outsideTissue = {});
  ~CompressionSimulation();
  CompressionSimulation(CompressionSimulation&&) noexcept;
  CompressionSimulation& operator=(CompressionSimulation&&) noexcept;

  /**
   * Sets a coarser simulation of the same body, with as many materials, whose result a cold start
   * uses as its initial guess. A few thousand quadratic cells take seconds; tens of thousands of
   * cells would need minutes to fold at the plates' edges, but need only some dozen Newton steps
   * from this guess. The meshes may differ by a fraction of a cell. The same equilibrium is found
   * to the same tolerance, except where tissue folds at the plates' edges: it can fold in several
   * ways, which differ by tenths of a millimetre and some tenths of a per cent of the force in the
   * tests' breast. Has no effect with friction. SetMaterials and Unload are passed on to the
   * predictor, which is dropped where its elements have no stress-free shape. Throws InputError.
   */
  void SetPredictor(std::unique_ptr<CompressionSimulation> predictor);

  /**
   * Interprets the mesh as the shape of a breast under this gravity (m/s^2, frame of the mesh), as
   * it was imaged, and finds the stress-free shape from which that gravity produces it. Equilibrium
   * is solved in the known deformed shape (Govindjee & Mihalic 1996). It holds at the points of the
   * mesh exactly in the inverse problem and to UnloadToleranceMm in the forward problem. Every cell
   * keeps its material. SetMaterials repeats the search for the new materials. If the tissue is too
   * soft to carry its weight, StiffnessFactor is above 1. Throws ConvergenceError or Interrupted
   * and leaves the simulation unchanged then.
   */
  void Unload(const Vector3& gravityMPerS2, const ProgressCallback& progress = {});
  static constexpr double UnloadToleranceMm = 1e-3;
  /**
   * The factor by which Unload has multiplied all stiffness, including that of the chest wall's
   * layer: 1, or the least factor (to 5 %, never too small) for which a stress-free shape exists
   * from which the imaged shape is a stable equilibrium. Materials() and the options stay as given.
   * When the materials change the factor stays, or rises where it must.
   */
  double StiffnessFactor() const;

  /// What a failed cold start reports.
  enum class Refusal
  {
    /// The smallest gap that has an equilibrium. The search for it takes several times as long as
    /// the start.
    WithLastGap,
    /// The gap at which the path with soft contact ended.
    AtOnce
  };

  /// The plates, opened along their normals until they touch nothing of the freely hanging breast.
  PlatePair OpenedPlates(const PlatePair& plates, const ProgressCallback& progress = {});

  /**
   * Solves for the equilibrium between the plates.
   *
   * Without `start` (cold): the breast settles under gravity and pull while the plates are open.
   * The plates then close in load steps. Without friction, quadratic elements first let linear
   * elements on the same cells, or the predictor, find an initial guess; if that fails they follow
   * the path themselves. With `start` (warm, a state of this simulation): goes to the new plates in
   * one step, or in several where that fails. Contact is hardened until the penetration is within
   * its limit.
   *
   * The result is deterministic and has J > 0 at every quadrature point; corners of cells may still
   * be inverted. Throws CompressionError, which states the last gap or the violated limit and the
   * value found, or Interrupted.
   */
  CompressionState Compress(const PlatePair& plates, const CompressionState* start = nullptr,
    const ProgressCallback& progress = {}, Refusal refusal = Refusal::WithLastGap);

  /**
   * Finds the equilibrium of this simulation that corresponds to a state of another simulation of
   * the same body, between the same plates. Where several equilibria exist (a breast that is higher
   * than wide topples to either side; tissue folds) it is the one that the other simulation found.
   * Meshes may differ as those of a predictor may. With friction, or if nothing is found from
   * there, it is that of a cold start. Throws as Compress with Refusal::AtOnce.
   */
  CompressionState Adopt(const CompressionSimulation& other, const CompressionState& state,
    const ProgressCallback& progress = {});

  /**
   * Velocities dx/dp of the nodes at a converged state, by the implicit function theorem: one
   * back-substitution per parameter. The fields come in this order: parameters that move the
   * plates, that change the materials (one derivative per material; with { {}, {}, { fat's modulus
   * } } p is the ratio of material 2's stiffness to fat's), and that change the loading. With
   * friction they are exact for the last load step with its normal forces frozen. After Unload they
   * include the change of the stress-free shape with the materials and with the chest wall's
   * stiffness; StiffnessFactor is fixed constant.
   */
  VectorFields Sensitivities(const CompressionState& state,
    const std::vector<PlatePairVelocity>& velocities,
    const std::vector<MaterialDerivative>& materialDerivatives = {},
    const std::vector<LoadingDerivative>& loadingDerivatives = {});

  /// Derivatives of a number, the loss, with respect to what an equilibrium depends on.
  struct LossGradient
  {
    /// With respect to a relative change of the stiffness (Young's modulus) of each cell of the
    /// mesh and of each material, the others unchanged; 0 for fixed ones.
    std::vector<double> Cells;
    std::vector<double> Materials;
    /// With respect to each parameter that moves the plates, per unit of it.
    std::vector<double> Plates;
  };
  /**
   * The gradient of a loss whose derivatives with respect to the positions of the nodes at a
   * converged state are `loss`, 3 x nodeCount, 1/mm, in reverse mode: one back-substitution with
   * the equilibrium's factor for any number of cells. As exact as Sensitivities. Throws InputError
   * on a loss of another size, and after Unload, where the stress-free shape depends on all cells.
   */
  LossGradient Backward(const CompressionState& state, const std::vector<double>& loss,
    const std::vector<PlatePairVelocity>& velocities = {});

  /// Derivative of PaddleForceN with respect to a parameter that moves the plates, N per unit; as
  /// exact as Sensitivities.
  double PaddleForceDerivative(const CompressionState& state, const PlatePairVelocity& velocity);

  /**
   * Solves for the state in which the paddle presses with `forceN` (positive, N), to 1e-4 of it, by
   * a bracketed Newton's method on the exact derivative of the force. `plates` are any plates on
   * the path; `closing` is their velocity with a parameter that brings them together. Throws
   * CompressionError, which states the last gap and its force, if the plates cannot close that far;
   * otherwise as Compress.
   */
  CompressionState CompressToForce(const PlatePair& plates, const PlatePairVelocity& closing,
    double forceN, const ProgressCallback& progress = {});

  /**
   * Replaces the constants of the materials, as many as at construction. Mesh, field and order of
   * the unknowns stay, so earlier states can start Compress, but are no longer equilibria. After
   * Unload the stress-free shape is found again. Throws InputError, and after Unload
   * ConvergenceError, and leaves the simulation unchanged then.
   */
  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  const std::vector<ElasticMaterial>& Materials() const;

  /// Volume change and stress of every cell of the mesh in a state.
  std::vector<CellMeasures> MeasuresOf(const CompressionState& state) const;
  /// Contact pressure at every node, kPa; 0 inside the body and where nothing touches.
  std::vector<double> ContactPressuresKPa(const CompressionState& state);

  std::size_t NumberOfNodes() const;
  std::size_t NumberOfUnknowns() const;
  /// Stress-free node positions, 3 x nodeCount, mm. The first nodes are the mesh's points.
  const std::vector<double>& RestPositions() const;
  /// Node positions in the given mesh, mm: RestPositions, or, after Unload, the equilibrium under
  /// that gravity (at the mesh's points to UnloadToleranceMm).
  const std::vector<double>& ImagePositions() const;

private:
  friend class Embedding;
  /// Complete: contact is hardened and all limits are met. Prediction: an initial guess for another
  /// simulation, with soft contact and a wide tolerance.
  enum class Finish
  {
    Complete,
    Prediction
  };
  /// Without `start` it is a cold run, which begins at `predicted` positions or at the predictor's.
  CompressionState Run(const PlatePair& plates, const CompressionState* start, Finish finish,
    const ProgressCallback& progress, double loadStepFactor = 1,
    std::vector<double> predicted = {});
  /// A cold run. If it fails, it is repeated with smaller load steps.
  CompressionState RunCold(const PlatePair& plates, const ProgressCallback& progress);
  /// The smallest gap from `fromMm` on, in steps of 15 %, that has an equilibrium, mm.
  double LeastGapMm(const PlatePair& plates, double fromMm, const ProgressCallback& progress);
  /// Node positions between the plates by the predictor; empty if there is none or it fails.
  std::vector<double> PredictedPositions(const PlatePair& plates, const ProgressCallback& progress);

  struct Internals;
  std::unique_ptr<Internals> Internal;
};
}

#endif
