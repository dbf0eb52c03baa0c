// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LoadEnergy_h
#define mammoray_LoadEnergy_h

#include "Private/ElasticBody.h"
#include "Private/Energy.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/// Weight of 1 g/cm^3 at 1 m/s^2, kPa mm^2 per mm^3.
constexpr double WeightDensity = 1e-3;

/// Energy of dead loads (forces that do not depend on the deformation): minus their work from the
/// undeformed positions on. Its pieces are the nodes; its Hessian is zero.
class MAMMORAYBIOMECHANICS_EXPORT LoadEnergy : public Energy
{
public:
  /// Begins without loads. The body must outlive the energy.
  explicit LoadEnergy(const ElasticBody& body)
    : Body(body)
  {
  }
  /// Sets the forces, 3 x nodeCount, kPa mm^2; empty for none. Throws InputError on another size.
  void SetForces(std::vector<double> forces);
  const std::vector<double>& Forces() const { return this->NodeForces; }

  /// Number of nodes, or 0 without loads.
  std::size_t NumberOfPieces() const override { return this->NodeForces.size() / 3; }
  std::span<const std::int32_t> NodesOf(std::size_t node) const override;
  bool Add(std::size_t node, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

private:
  const ElasticBody& Body;
  std::vector<double> NodeForces;
  std::vector<std::int32_t> NodeIndices;
};

/// Node forces of gravity (m/s^2) on the cells that are not fixed, and of a pull (N) distributed
/// over their volume; 3 x nodeCount, kPa mm^2, empty if both are zero.
MAMMORAYBIOMECHANICS_EXPORT std::vector<double> BodyForces(const ElasticBody& body,
  const std::vector<bool>& fixedCells, const Vector3& gravityMPerS2, const Vector3& pullN);
/// Derivatives of BodyForces if the undeformed nodes move with `restVelocities` (3 x nodeCount);
/// empty if there are no forces.
MAMMORAYBIOMECHANICS_EXPORT std::vector<double> BodyForceDerivatives(const ElasticBody& body,
  const std::vector<bool>& fixedCells, const Vector3& gravityMPerS2, const Vector3& pullN,
  const std::vector<double>& restVelocities);
}

#endif
