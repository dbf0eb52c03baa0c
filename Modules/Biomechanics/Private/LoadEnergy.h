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
/// Weight of 1 g/cm^3 at 1 m/s^2 in kPa mm^2 per mm^3.
constexpr double WeightDensity = 1e-3;

/// Energy of dead loads, forces that act whatever the deformation: minus their work from the
/// undeformed positions on. Its pieces are the nodes; its Hessian is zero.
class MAMMORAYBIOMECHANICS_EXPORT LoadEnergy : public Energy
{
public:
  /// Without loads. The body must outlive the energy.
  explicit LoadEnergy(const ElasticBody& body)
    : Body(body)
  {
  }
  /// 3 x nodeCount, kPa mm^2; empty: none. Throws InputError.
  void SetForces(std::vector<double> forces);
  const std::vector<double>& Forces() const { return this->NodeForces; }

  /// 0 without loads.
  std::size_t NumberOfPieces() const override { return this->NodeForces.size() / 3; }
  std::span<const std::int32_t> NodesOf(std::size_t node) const override;
  bool Add(std::size_t node, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

private:
  const ElasticBody& Body;
  std::vector<double> NodeForces;
  std::vector<std::int32_t> NodeIndices;
};

/**
 * Forces of gravity (m/s^2) on the cells that are not held, and of a pull (N) spread over their
 * volume; 3 x nodeCount, kPa mm^2, empty where there are none.
 */
MAMMORAYBIOMECHANICS_EXPORT std::vector<double> BodyForces(const ElasticBody& body,
  const std::vector<bool>& heldCells, const Vector3& gravityMPerS2, const Vector3& pullN);
/// Their rates where the undeformed nodes move with `restVelocities`, 3 x nodeCount; empty where
/// there are none.
MAMMORAYBIOMECHANICS_EXPORT std::vector<double> BodyForceRates(const ElasticBody& body,
  const std::vector<bool>& heldCells, const Vector3& gravityMPerS2, const Vector3& pullN,
  const std::vector<double>& restVelocities);
}

#endif
