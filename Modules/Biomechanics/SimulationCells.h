// Types that describe the cells of a simulation, their material and the measures taken in them.
#ifndef mammoray_SimulationCells_h
#define mammoray_SimulationCells_h

#include "mammoray/Foundation/Vector3.h"

#include <functional>

namespace mammoray
{
/// Means over the quadrature points of a deformed cell.
struct CellMeasures
{
  /// det F: deformed volume divided by undeformed volume.
  double J = 1;
  /// Von Mises equivalent of the Cauchy stress, kPa.
  double VonMisesKPa = 0;
};

/// Returns the material index at a position of the undeformed body (mm, frame of the mesh); 0 is
/// outside.
using MaterialField = std::function<int(const Vector3&)>;

/// Returns true where the body continues at a position outside the mesh (mm, frame of the mesh).
using BodyField = std::function<bool(const Vector3&)>;

/// Interpolation of the displacement in a tetrahedron, and the cells that share one volume
/// constraint.
enum class ElementType
{
  /// Ten nodes; one volume constraint per cell, besides a weaker one at each quadrature point.
  Quadratic,
  /// Four nodes; one volume constraint per patch of about eight cells.
  PatchAveragedLinear
};
}

#endif
