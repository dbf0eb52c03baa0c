// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionInternals_h
#define mammoray_CompressionInternals_h

#include "Private/AttachmentEnergy.h"
#include "Private/ElasticBody.h"
#include "Private/EquilibriumSolver.h"
#include "Private/InverseEquilibrium.h"
#include "Private/RestShape.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"

#include <functional>
#include <optional>

namespace mammoray
{
struct CompressionSimulation::Internals
{
  ElasticBody Body;
  CompressionOptions Options;
  /// One flag per cell: of a held material.
  std::vector<bool> HeldCells;
  /// Coordinates that do not move, 3 x nodeCount.
  std::vector<bool> Fixed;
  /// Where the breast is not held but slides or hangs elastically.
  std::optional<AttachmentEnergy> Wall;
  EquilibriumSolver Solver;
  /// The materials as they were given, and what all stiffness is raised by over them.
  std::vector<ElasticMaterial> Given;
  double Factor = 1;
  /// What Unload has left.
  struct Unloading
  {
    Vector3 Gravity;
    InverseEquilibrium Inverse;
    RestShape Shape;

    Unloading(Internals& internals, const Vector3& gravity, const std::vector<double>& corners)
      : Gravity(gravity)
      , Inverse(internals.Body, internals.Wall ? &*internals.Wall : nullptr, internals.Fixed,
          internals.HeldCells, corners, gravity)
      , Shape(Inverse, internals.Solver, internals.Options.RelativeTolerance)
    {
    }
  };
  /// Null: the mesh is without load.
  std::unique_ptr<Unloading> Unloaded;
  /// See ImagePositions.
  std::vector<double> Image;
  std::size_t NumberOfPoints;
  /// Nodes that no cell of tissue has: a middle, and the ends of its side.
  std::vector<std::array<std::int32_t, 3>> Followers;
  /// Equilibrium under gravity and pull without plates; empty: not known.
  std::vector<double> Settled;
  /// Goes most of the way for a cold start at a small part of the price; empty: none.
  std::unique_ptr<CompressionSimulation> Predictor;
  /// The nodes of the body in `Predictor`.
  std::unique_ptr<Embedding> InPredictor;

  Internals(ElasticBody body, std::vector<bool> heldCells, std::size_t pointCount,
    const CompressionOptions& options, const BodyField& beside);

  /// Finds the middles in held cells, of sides that end on a wall that is not held.
  void FindFollowers();
  /// Puts them between the ends of their sides; positions or velocities, 3 x nodeCount.
  void DrawAlong(std::vector<double>& values) const;
  /// Dead loads of every node, kPa mm^2; empty where there are none.
  std::vector<double> Loads(const Vector3& gravityMPerS2, const Vector3& pullN) const;
  /**
   * From the equilibrium `x` under the loads `from` to that under `to`, without plates and
   * friction; in steps where it fails at once. Throws ConvergenceError.
   */
  void Settle(const std::vector<double>& from, const std::vector<double>& to,
    std::vector<double>& x, const ProgressCallback& progress);
  /// The breast under the options' loads, plates open: from the image, where it hung, else from
  /// rest.
  const std::vector<double>& SettledPositions(const ProgressCallback& progress);
  /// See CompressionSimulation.
  void Unload(const Vector3& gravityMPerS2, const ProgressCallback& progress);
  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  /// Places this body's nodes in that of the predictor, both as they are in the image.
  void EmbedInPredictor();
  /// Where this body's nodes, `embedded` in another simulation, are at its `positions`.
  std::vector<double> PositionsIn(const CompressionSimulation& other, const Embedding& embedded,
    const std::vector<double>& positions) const;
  /// Does the same to the predictor as was done here, and drops it where it cannot follow.
  void ChangePredictor(const std::function<void(CompressionSimulation&)>& change);
  /// How the shape without load changes along with materials and wall; after Unload.
  void AddRestVelocities(EquilibriumVelocities& velocities);
  /// Makes the solver's contact, friction and loads those of the state.
  void Recall(const CompressionState& state);

private:
  void SetStiffness(double factor);
  void FindRest(const ProgressCallback& progress);
  void TakeRest(const ProgressCallback& progress);
};
}

#endif
