// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MovingPart_h
#define mammoray_MovingPart_h

#include "Private/ElasticBody.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mammoray
{
/// The part of a body that can move: its elements, the boundary faces that can touch a plate, and
/// its unknowns.
class MAMMORAYBIOMECHANICS_EXPORT MovingPart
{
public:
  /// `fixed` are 3 x nodeCount flags of coordinates that do not move. Cells flagged in `rigid`
  /// (empty for none) are left out. The body must outlive this object. Throws InputError if nothing
  /// can move.
  MovingPart(const ElasticBody& body, const std::vector<bool>& fixed,
    const std::vector<bool>& rigid = {});

  const ElasticBody& Body() const { return this->WholeBody; }
  const std::vector<bool>& RigidCells() const { return this->Rigid; }
  /// Elements with at least one free node, ascending.
  const std::vector<std::int32_t>& Elements() const { return this->MovingElements; }
  /// Boundary faces of an element with at least one free node.
  const std::vector<std::int32_t>& FacesOf(std::size_t element) const
  {
    return this->ElementFaces[element];
  }
  /// Element of a boundary face; -1 if the face cannot move.
  std::int32_t ElementOfFace(std::int32_t face) const { return this->FaceElements[face]; }

  /// Index of the unknown of each coordinate; -1 if the coordinate is fixed.
  const std::vector<std::int32_t>& Unknowns() const { return this->UnknownOfCoordinate; }
  /// Coordinate of each unknown, ascending.
  const std::vector<std::int32_t>& Coordinates() const { return this->CoordinateOfUnknown; }
  std::size_t NumberOfUnknowns() const { return this->CoordinateOfUnknown.size(); }

  /// Undeformed volume of the elements that do not move, mm^3, at construction.
  double RigidVolume() const { return this->VolumeAtRest; }

  /// Adds a force at a node to a column of unknowns.
  void AddAtNode(std::int32_t node, const Vector3& force, double* column) const;
  /// Adds a force at a point of a boundary face, given by its shape functions, to a column of
  /// unknowns.
  void AddAtFace(const ElasticBody::BoundaryFace& face, const std::array<double, 6>& shape,
    const Vector3& force, double* column) const;

private:
  const ElasticBody& WholeBody;
  std::vector<bool> Rigid;
  std::vector<std::int32_t> MovingElements;
  std::vector<std::vector<std::int32_t>> ElementFaces;
  std::vector<std::int32_t> FaceElements;
  std::vector<std::int32_t> UnknownOfCoordinate;
  std::vector<std::int32_t> CoordinateOfUnknown;
  double VolumeAtRest = 0;
};
}

#endif
