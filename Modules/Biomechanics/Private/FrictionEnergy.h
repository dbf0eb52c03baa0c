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
/// The previous state of friction: its contact points with their anchors dragged along, its
/// positions and plates.
struct FrictionStart
{
  FrictionPoints Dragged;
  std::vector<double> Positions;
  PlatePair Plates;
};

/// Energy of the friction with two plates, with frozen normal forces and anchors (see
/// FrictionPoint). Its pieces are the body's elements. Its Hessian is positive semidefinite.
class MAMMORAYBIOMECHANICS_EXPORT FrictionEnergy : public Energy
{
public:
  /// Begins without points. The part must outlive the energy.
  explicit FrictionEnergy(const MovingPart& part)
    : Part(part)
  {
  }
  void SetPoints(FrictionPoints points);
  /// Points, ordered by elements.
  const FrictionPoints& Points() const { return this->OrderedPoints; }
  void SetPlates(const PlatePair& plates) { this->CurrentPlates = plates; }

  std::size_t NumberOfPieces() const override { return this->Part.Body().NumberOfElements(); }
  std::span<const std::int32_t> NodesOf(std::size_t element) const override
  {
    return this->Part.Body().NodesOf(element);
  }
  /// Measures the friction force and its share of the normal forces.
  bool Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// Adds -d gradient / dp of an element for parameters that move the plates, to one column of
  /// unknowns each. The anchors move with the plates.
  void AddPlateForces(std::size_t element, const std::vector<double>& x,
    const std::vector<PlatePairVelocity>& velocities, std::vector<double>& columns) const;
  /// As AddPlateForces for a parameter with this derivative of the coefficient of friction.
  void AddCoefficientForces(std::size_t element, const std::vector<double>& x, double rate,
    double* column) const;
  /// See ContactEnergy::AddPaddleForceDerivative.
  void AddPaddleForceDerivative(std::size_t element, const std::vector<double>& x,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities,
    double& rate) const;

private:
  template <typename Function>
  void ForEachPoint(std::size_t element, const std::vector<double>& x,
    const Function& function) const;

  const MovingPart& Part;
  PlatePair CurrentPlates;
  FrictionPoints OrderedPoints;
  /// Element e has the points Starts[e] to Starts[e + 1] - 1; empty if there are no points.
  std::vector<std::size_t> Starts;
};

/// Friction points for the contact of `part` at `x`. Points that touched in the previous state keep
/// their anchors; new points have theirs where they were in that state.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints FrictionOfContact(const MovingPart& part,
  const ContactEnergy& contact, const std::vector<double>& x, const PlatePair& plates,
  double coefficient, const FrictionStart& before);
/// Returns `points` with their anchors dragged to the positions `x`.
MAMMORAYBIOMECHANICS_EXPORT FrictionPoints DraggedTo(const ElasticBody& body,
  const std::vector<double>& x, const PlatePair& plates, FrictionPoints points);
}

#endif
