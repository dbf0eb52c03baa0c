// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Energy_h
#define mammoray_Energy_h

#include "mammoray/Foundation/Vector3.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace mammoray
{
/// The highest derivative of an energy to compute.
enum class EnergyOrder
{
  Value,
  Gradient,
  Hessian,
  /// The Hessian with its negative eigenvalues replaced by zero.
  ProjectedHessian
};

/// Measures that energies take while they are evaluated; each energy fills in its own.
struct PositionMeasures
{
  /// Smallest and largest det F, and the deformed volume, mm^3.
  double SmallestJ = std::numeric_limits<double>::infinity();
  double LargestJ = -std::numeric_limits<double>::infinity();
  double Volume = 0;
  /// Deepest penetration into a plate, mm.
  double Penetration = 0;
  /// Force along the normal, and friction force, of support and of paddle, kPa mm^2.
  std::array<double, 2> NormalForce{};
  std::array<Vector3, 2> Friction{};
  /// Largest distance that a node of the chest wall has moved across the wall and along it, mm.
  double WallLift = 0;
  double WallGlide = 0;

  /// Adds the measures of another piece.
  void Add(const PositionMeasures& other)
  {
    this->SmallestJ = std::min(this->SmallestJ, other.SmallestJ);
    this->LargestJ = std::max(this->LargestJ, other.LargestJ);
    this->Volume += other.Volume;
    this->Penetration = std::max(this->Penetration, other.Penetration);
    for (int side = 0; side < 2; ++side)
    {
      this->NormalForce[side] += other.NormalForce[side];
      this->Friction[side] = this->Friction[side] + other.Friction[side];
    }
    this->WallLift = std::max(this->WallLift, other.WallLift);
    this->WallGlide = std::max(this->WallGlide, other.WallGlide);
  }
};

/// The energies of one piece, summed, and their derivatives with respect to the coordinates of its
/// n nodes. Rows and columns are 3 * local node + axis. The caller owns the memory, sets it to zero
/// first, and leaves spans empty that the order does not need.
struct PieceTerms
{
  /// kPa mm^3
  double Value = 0;
  /// 3 n, kPa mm^2
  std::span<double> Gradient;
  /// (3 n)^2, symmetric, both halves filled, kPa mm
  std::span<double> Hessian;
  PositionMeasures Measures;
};

/// A term of the potential energy as a function of the node positions: a sum over pieces (elements
/// or single nodes), each of which depends on a few nodes.
class Energy
{
public:
  virtual ~Energy() = default;
  virtual std::size_t NumberOfPieces() const = 0;
  /// Nodes that a piece depends on, in local order.
  virtual std::span<const std::int32_t> NodesOf(std::size_t piece) const = 0;
  /// Adds the energy of a piece at the positions `x` (3 x nodeCount, mm) and its derivatives up to
  /// `order`. Returns false, with unspecified terms, where the energy is not defined. Calls for
  /// different pieces may run in parallel.
  virtual bool Add(std::size_t piece, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const = 0;
};

/// Position of a node, mm.
inline Vector3 NodePosition(const std::vector<double>& x, std::int32_t node)
{
  return { x[3 * node], x[3 * node + 1], x[3 * node + 2] };
}
}

#endif
