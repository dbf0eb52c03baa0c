// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionInternals_h
#define mammoray_CompressionInternals_h

#include "Private/AttachmentEnergy.h"
#include "Private/ElasticBody.h"
#include "Private/EquilibriumSolver.h"
#include "Private/InverseEquilibrium.h"
#include "Private/StressFreeShape.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"

#include <functional>
#include <optional>
#include <span>

namespace mammoray
{
struct CompressionSimulation::Internals
{
  ElasticBody Body;
  CompressionOptions Options;
  /// One flag per cell: true for cells of a fixed material.
  std::vector<bool> FixedCells;
  /// Coordinates that do not move, 3 x nodeCount.
  std::vector<bool> FixedCoordinates;
  /// The wall's energy if the breast slides along the wall or is attached elastically.
  std::optional<AttachmentEnergy> Wall;
  EquilibriumSolver Solver;
  /// The materials as given, and the factor by which all stiffness exceeds theirs.
  std::vector<ElasticMaterial> GivenMaterials;
  double Factor = 1;
  /// The inverse problem that Unload has solved.
  struct Unloading
  {
    Vector3 Gravity;
    InverseEquilibrium Inverse;
    StressFreeShape Shape;

    Unloading(Internals& internals, const Vector3& gravity, const std::vector<double>& corners)
      : Gravity(gravity)
      , Inverse(internals.Body, internals.Wall ? &*internals.Wall : nullptr,
          internals.FixedCoordinates, internals.FixedCells, corners, gravity)
      , Shape(Inverse, internals.Solver, internals.Options.RelativeTolerance)
    {
    }
  };
  /// Null if the mesh is the stress-free shape.
  std::unique_ptr<Unloading> Unloaded;
  /// Node positions in the given mesh; see CompressionSimulation::ImagePositions.
  std::vector<double> Image;
  std::size_t NumberOfPoints;
  /// Mid-side nodes that belong to no cell of moving tissue: the middle, then the ends of its side.
  std::vector<std::array<std::int32_t, 3>> Followers;
  /// Equilibrium under gravity and pull without plates; empty until it is known.
  std::vector<double> Settled;
  /// Simulation that provides the initial guess of cold starts; null if there is none.
  std::unique_ptr<CompressionSimulation> Predictor;
  /// Embedding of this body's nodes in `Predictor`.
  std::unique_ptr<Embedding> InPredictor;

  Internals(ElasticBody body, std::vector<bool> fixedCells, std::size_t pointCount,
    const CompressionOptions& options, const BodyField& outsideTissue);

  /// Finds the mid-side nodes in fixed cells whose sides end on a wall that can move.
  void FindFollowers();
  /// Places these nodes midway between the ends of their sides, in positions or velocities (3 x
  /// nodeCount).
  void DrawAlong(std::span<double> values) const;
  /// The transpose of DrawAlong: a loss's derivatives at these nodes go to the ends of their sides.
  void GatherDrawn(std::span<double> loss) const;
  /// Dead loads of every node, 3 x nodeCount, kPa mm^2; empty if there are none.
  std::vector<double> Loads(const Vector3& gravityMPerS2, const Vector3& pullN) const;
  /// Moves `x` from the equilibrium under the loads `from` to the one under `to`, without plates
  /// and friction, in smaller steps where a step fails. Throws ConvergenceError.
  void Settle(const std::vector<double>& from, const std::vector<double>& to,
    std::vector<double>& x, const ProgressCallback& progress);
  /// The breast under the options' loads with open plates. It starts at the imaged shape or, if the
  /// body hung there, at the equilibrium under gravity; otherwise at the undeformed shape.
  const std::vector<double>& SettledPositions(const ProgressCallback& progress);
  /// Implement the methods of the same names of CompressionSimulation for this body.
  void Unload(const Vector3& gravityMPerS2, const ProgressCallback& progress);
  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  /// Embeds this body's nodes in the predictor's body, both in the imaged shape.
  void EmbedInPredictor();
  /// Positions of this body's nodes, `embedded` in another simulation, for the `positions` of its
  /// nodes.
  std::vector<double> PositionsIn(const CompressionSimulation& other, const Embedding& embedded,
    const std::vector<double>& positions) const;
  /// Applies a change to the predictor and drops the predictor if that fails.
  void ChangePredictor(const std::function<void(CompressionSimulation&)>& change);
  /// Adds the velocities of the stress-free shape with materials and wall; only after Unload.
  void AddStressFreeVelocities(EquilibriumDerivatives& velocities);
  /// Restores the solver's contact, friction and loads from a state.
  void Recall(const CompressionState& state);

private:
  void SetStiffness(double factor);
  void FindRest(const ProgressCallback& progress);
  void TakeRest(const ProgressCallback& progress);
};
}

#endif
