// SPDX-License-Identifier: Apache-2.0
// What the cells of a simulation are, where their material comes from and what is measured in them.
#ifndef mammoray_SimulationCells_h
#define mammoray_SimulationCells_h

#include "mammoray/Foundation/Vector3.h"

#include <functional>

namespace mammoray
{
/// Means over the quadrature points of a deformed cell.
struct CellMeasures
{
  /// det F: deformed over undeformed volume.
  double J = 1;
  /// Von Mises' measure of the Cauchy stress, kPa.
  double VonMisesKPa = 0;
};

/// Material index at a position of the undeformed body (mm, frame of the mesh); 0 = outside.
using MaterialField = std::function<int(const Vector3&)>;

/// Whether the body that the mesh was cut out of goes on at a place beside the mesh (mm, frame of
/// the mesh).
using BodyField = std::function<bool(const Vector3&)>;

/// How tetrahedra carry the displacement and share the volume constraint.
enum class ElementType
{
  /// Ten nodes, one volume constraint for each cell, on top of one by quadrature point.
  Quadratic,
  /// Four nodes, one volume constraint for a patch of about eight cells.
  PatchAveragedLinear
};
}

#endif
