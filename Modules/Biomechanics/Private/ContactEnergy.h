// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ContactEnergy_h
#define mammoray_ContactEnergy_h

#include "Private/Energy.h"
#include "Private/MovingPart.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/// Energy per area of a depth in the contact layer, its first and its second derivative; see
/// ContactEnergy.
struct ContactLaw
{
  double Energy = 0;
  double Pressure = 0;
  double Slope = 0;

  /// `stiffness`: kPa / mm^2; `depth`: mm, positive.
  MAMMORAYBIOMECHANICS_EXPORT ContactLaw(double stiffness, double depth);
};

/// A point of a boundary face in the layer of a plate.
struct ContactPoint
{
  const ElasticBody::BoundaryFace& Face;
  std::int32_t FaceIndex;
  /// Its number among FacePoints().
  std::int16_t RulePoint;
  /// Shape functions of the nodes of the face.
  std::array<double, 6> Shape;
  Vector3 Position;
  /// 0: support, 1: paddle.
  std::int16_t Side;
  const Plate& Touched;
  PlateDistance Distance;
  ContactLaw Law;
  /// Undeformed area it stands for, mm^2.
  double Weight;
};

/**
 * Energy of the contact with two plates; its pieces are the body's elements. In front of each plate
 * lies a layer of LayerMm. A boundary point g > 0 deep in it feels the pressure stiffness * g^2 as
 * far as the plate and in the plate the tangent of that parabola, on which Newton's method does not
 * creep; the energy is C2. Points are the FacePoints of every boundary triangle that can move.
 */
class MAMMORAYBIOMECHANICS_EXPORT ContactEnergy : public Energy
{
public:
  static constexpr double LayerMm = 0.05;

  /// `stiffness`: kPa / mm^2. The part must outlive the energy.
  ContactEnergy(const MovingPart& part, double stiffness)
    : Part(part)
    , StiffnessValue(stiffness)
  {
  }
  void SetStiffness(double stiffness) { this->StiffnessValue = stiffness; }
  double Stiffness() const { return this->StiffnessValue; }
  void SetPlates(const PlatePair& plates) { this->Touched = plates; }
  const PlatePair& Plates() const { return this->Touched; }

  std::size_t NumberOfPieces() const override { return this->Part.Body().NumberOfElements(); }
  std::span<const std::int32_t> NodesOf(std::size_t element) const override
  {
    return this->Part.Body().NodesOf(element);
  }
  /// Measures penetration and normal forces. The projected Hessian lacks the part along the plates'
  /// rounded edges, which is negative.
  bool Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// The points of an element that lie in the layers of these plates.
  std::vector<ContactPoint> PointsAt(std::size_t element, const std::vector<double>& x,
    const PlatePair& plates) const;
  /// Adds - d gradient / dp of an element, for parameters that move the plates, to one column of
  /// unknowns for each.
  void AddPlateForces(std::size_t element, const std::vector<double>& x,
    const std::vector<PlatePairVelocity>& velocities, std::vector<double>& columns) const;
  /// The same where the undeformed nodes move with `restVelocities`, 3 x nodeCount, to one column:
  /// points stand for undeformed area.
  void AddRestForces(std::size_t element, const std::vector<double>& x,
    const std::vector<double>& restVelocities, double* column) const;
  /// Adds the rate of the paddle's force on an element, kPa mm^2 per unit of a parameter that moves
  /// the plates by `velocity` and the nodes by `nodeVelocities`.
  void AddPaddleForceRate(std::size_t element, const std::vector<double>& x,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities,
    double& rate) const;
  /// Pressure of the plates at each node, kPa: means around corners of the boundary, between them
  /// at the middles of sides, 0 inside the body.
  std::vector<double> NodePressures(const std::vector<double>& x) const;
  /// Smallest distance each of these plates must move against its normal for its layer to touch
  /// nothing, mm; support, paddle.
  std::array<double, 2> Opening(const std::vector<double>& x, const PlatePair& plates) const;

private:
  template <typename Function>
  void ForEachPoint(std::size_t element, const std::vector<double>& x, const PlatePair& plates,
    const Function& function) const;

  const MovingPart& Part;
  double StiffnessValue;
  PlatePair Touched;
};
}

#endif
