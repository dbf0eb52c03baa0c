// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FrictionEnergy_h
#define mammoray_FrictionEnergy_h

#include "Private/ContactEnergy.h"
#include "Private/Energy.h"
#include "Private/MovingPart.h"
#include "Private/PlateFriction.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/// Where friction comes from: a state before, the points that touched there with their anchors
/// dragged to it.
struct FrictionStart
{
  FrictionPoints Dragged;
  std::vector<double> Positions;
  PlatePair Plates;
};

/**
 * Energy of the friction with two plates (FrictionPoint: its normal forces and anchors are frozen);
 * its pieces are the body's elements. It has no negative curvature.
 */
class MAMMORAYBIOMECHANICS_EXPORT FrictionEnergy : public Energy
{
public:
  /// Without points. The part must outlive the energy.
  explicit FrictionEnergy(const MovingPart& part)
    : Part(part)
  {
  }
  void SetPoints(FrictionPoints points);
  /// Ordered by elements.
  const FrictionPoints& Points() const { return this->Ordered; }
  void SetPlates(const PlatePair& plates) { this->Touched = plates; }

  std::size_t NumberOfPieces() const override { return this->Part.Body().NumberOfElements(); }
  std::span<const std::int32_t> NodesOf(std::size_t element) const override
  {
    return this->Part.Body().NodesOf(element);
  }
  /// Measures friction and its share of the normal forces.
  bool Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// Adds - d gradient / dp of an element, for parameters that move the plates, to one column of
  /// unknowns for each; the anchors move with the plates.
  void AddPlateForces(std::size_t element, const std::vector<double>& x,
    const std::vector<PlatePairVelocity>& velocities, std::vector<double>& columns) const;
  /// The same for a parameter that changes the coefficient of friction at this rate.
  void AddCoefficientForces(std::size_t element, const std::vector<double>& x, double rate,
    double* column) const;
  /// See ContactEnergy::AddPaddleForceRate.
  void AddPaddleForceRate(std::size_t element, const std::vector<double>& x,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities,
    double& rate) const;

private:
  template <typename Function>
  void ForEachPoint(std::size_t element, const std::vector<double>& x,
    const Function& function) const;

  const MovingPart& Part;
  PlatePair Touched;
  FrictionPoints Ordered;
  /// Those of element e are Starts[e] to Starts[e + 1]; empty without points.
  std::vector<std::size_t> Starts;
};

/**
 * Friction of this coefficient for the contact of `part` at `x`: points that touched in the state
 * before keep their anchors, others have theirs where they were then.
 */
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints FrictionOfContact(const MovingPart& part,
  const ContactEnergy& contact, const std::vector<double>& x, const PlatePair& plates,
  double coefficient, const FrictionStart& before);
/// `points` with their anchors dragged to the positions `x`.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints DraggedTo(const ElasticBody& body,
  const std::vector<double>& x, const PlatePair& plates, FrictionPoints points);
}

#endif
