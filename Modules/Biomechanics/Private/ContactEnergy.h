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
/// A quadrature point of a triangle in barycentric coordinates, and the fraction of the area that
/// it represents.
struct FacePoint
{
  std::array<double, 3> Lambda;
  double Weight;
};

/**
 * The centroids of 64 equal small triangles. Where a plate's edge cuts through a face, many points
 * are better than a rule of high degree: on an edge of 3 mm radius that is pressed in by 0.05 mm
 * the contact is 1.1 mm wide. If the points of an 8 mm face lay farther apart, the body would rest
 * on a few of them and snag from one to the next (with 16 points, twice as many Newton steps).
 */
MAMMORAYBIOMECHANICS_EXPORT const std::vector<FacePoint>& FacePoints();

/// Shape functions of the triangle with six or three nodes at a point.
inline std::array<double, 6> FaceShape(const FacePoint& point, int nodes)
{
  const std::array<double, 3>& l = point.Lambda;
  if (nodes == 3)
  {
    return { l[0], l[1], l[2], 0, 0, 0 };
  }
  return { l[0] * (2 * l[0] - 1), l[1] * (2 * l[1] - 1), l[2] * (2 * l[2] - 1), 4 * l[0] * l[1],
    4 * l[1] * l[2], 4 * l[2] * l[0] };
}

/// Interpolates the node values `x` at a point of a boundary face.
inline Vector3 FacePosition(const ElasticBody& body, const ElasticBody::BoundaryFace& face,
  const std::array<double, 6>& shape, const std::vector<double>& x)
{
  const std::span<const std::int32_t> nodes = body.NodesOf(face.Element);
  Vector3 position{ 0, 0, 0 };
  for (int a = 0; a < body.NodesPerFace(); ++a)
  {
    position = position + shape[a] * NodePosition(x, nodes[face.LocalNodes[a]]);
  }
  return position;
}

/// Adds the second derivative of an energy at a point of a boundary face, by the point's position,
/// to the Hessian of an element with so many rows.
void AddFaceHessian(const ElasticBody::BoundaryFace& face, int faceNodes,
  const std::array<double, 6>& shape, const double (&block)[3][3], std::size_t rows,
  std::span<double> hessian);

/// Contact energy per area at a depth in the contact layer with its first and second derivative;
/// see ContactEnergy.
struct ContactLaw
{
  double Energy = 0;
  double Pressure = 0;
  double Slope = 0;

  /// `stiffness` is in kPa / mm^2; `depth` is in mm and positive.
  MAMMORAYBIOMECHANICS_EXPORT ContactLaw(double stiffness, double depth);
};

/// A point of a boundary face that lies in the layer of a plate.
struct ContactPoint
{
  const ElasticBody::BoundaryFace& Face;
  std::int32_t FaceIndex;
  /// Index of the point in FacePoints().
  std::int16_t RulePoint;
  /// Values of the shape functions of the face's nodes.
  std::array<double, 6> Shape;
  Vector3 Position;
  /// 0 for the support, 1 for the paddle.
  std::int16_t Side;
  const Plate& TouchedPlate;
  PlateDistance Distance;
  ContactLaw Law;
  /// Undeformed area that the point represents, mm^2.
  double Weight;
};

/**
 * Energy of the contact with two plates; its pieces are the body's elements. A layer of LayerMm
 * lies in front of each plate. A boundary point at depth g > 0 in it feels the pressure stiffness *
 * g^2 as far as the plate's face, and the tangent of that parabola inside the plate, so that
 * Newton's method does not take many small steps. The energy is C2. Points are the FacePoints of
 * every boundary triangle that can move.
 */
class MAMMORAYBIOMECHANICS_EXPORT ContactEnergy : public Energy
{
public:
  static constexpr double LayerMm = 0.05;

  /// `stiffness` is in kPa / mm^2. The part must outlive the energy.
  ContactEnergy(const MovingPart& part, double stiffness)
    : Part(part)
    , StiffnessValue(stiffness)
  {
  }
  void SetStiffness(double stiffness) { this->StiffnessValue = stiffness; }
  double Stiffness() const { return this->StiffnessValue; }
  void SetPlates(const PlatePair& plates) { this->CurrentPlates = plates; }
  const PlatePair& Plates() const { return this->CurrentPlates; }

  std::size_t NumberOfPieces() const override { return this->Part.Body().NumberOfElements(); }
  std::span<const std::int32_t> NodesOf(std::size_t element) const override
  {
    return this->Part.Body().NodesOf(element);
  }
  /// Measures penetration and normal forces. The projected Hessian omits the negative part along
  /// the plates' rounded edges.
  bool Add(std::size_t element, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// Points of an element that lie in the layers of these plates.
  std::vector<ContactPoint> PointsAt(std::size_t element, const std::vector<double>& x,
    const PlatePair& plates) const;
  /// Adds -d gradient / dp of an element for parameters that move the plates, to one column of
  /// unknowns each.
  void AddPlateForces(std::size_t element, const std::vector<double>& x,
    const std::vector<PlatePairVelocity>& velocities, std::vector<double>& columns) const;
  /// As AddPlateForces if the undeformed nodes move with `restVelocities` (3 x nodeCount), to one
  /// column: the undeformed areas change.
  void AddRestForces(std::size_t element, const std::vector<double>& x,
    const std::vector<double>& restVelocities, double* column) const;
  /// Adds the derivative of the paddle's force on an element, kPa mm^2 per unit of a parameter that
  /// moves the plates by `velocity` and the nodes by `nodeVelocities`.
  void AddPaddleForceDerivative(std::size_t element, const std::vector<double>& x,
    const PlatePairVelocity& velocity, const std::vector<double>& nodeVelocities,
    double& rate) const;
  /// Contact pressure at each node, kPa: the mean around corners of the boundary, interpolated at
  /// the middles of sides, 0 inside the body.
  std::vector<double> NodePressures(const std::vector<double>& x) const;
  /// Smallest distance that support and paddle must each move against their normals so that their
  /// layers touch nothing, mm.
  std::array<double, 2> Opening(const std::vector<double>& x, const PlatePair& plates) const;

private:
  template <typename Function>
  void ForEachPoint(std::size_t element, const std::vector<double>& x, const PlatePair& plates,
    const Function& function) const;

  const MovingPart& Part;
  double StiffnessValue;
  PlatePair CurrentPlates;
};
}

#endif
