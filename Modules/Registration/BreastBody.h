// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastBody_h
#define mammoray_BreastBody_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Registration/UnitPlacement.h"
#include "mammorayRegistrationModule.h"

#include <optional>
#include <vector>

namespace mammoray
{
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
}

#endif
