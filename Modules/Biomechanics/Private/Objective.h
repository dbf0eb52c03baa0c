// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Objective_h
#define mammoray_Objective_h

#include "Private/Energy.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace mammoray
{
/// Lower triangle of a symmetric sparse matrix by columns: the rows of column c are Rows[Starts[c]]
/// to Rows[Starts[c + 1] - 1], ascending.
struct SparsePattern
{
  std::vector<int> Starts{ 0 };
  std::vector<int> Rows;

  /// Position of an entry (row >= column) of the pattern among the values.
  std::size_t PlaceOf(std::int32_t column, std::int32_t row) const
  {
    const auto begin = this->Rows.begin() + this->Starts[column];
    const auto end = this->Rows.begin() + this->Starts[column + 1];
    return static_cast<std::size_t>(std::lower_bound(begin, end, row) - this->Rows.begin());
  }
};

/// Value and derivatives of an objective at one set of positions, up to the requested order.
struct Evaluation
{
  /// False if the energy is not defined; then the other members are meaningless.
  bool Valid = false;
  /// kPa mm^3
  double Energy = 0;
  PositionMeasures Measures;
  /// Gradient with respect to all coordinates, kPa mm^2; at fixed ones it is minus the reaction
  /// force.
  std::vector<double> Gradient;
  /// Norm of the gradient at the unknowns, and the force it is divided by.
  double ResidualNorm = 0;
  double ForceScale = 1;
  /// Values of the entries of the pattern.
  std::vector<double> Hessian;

  double RelativeResidual() const { return this->ResidualNorm / this->ForceScale; }
};

/// A function of the coordinates of points, some of which are fixed. NewtonSolver knows nothing
/// else of it. Evaluate uses internal memory, so one thread may use an objective at a time.
class Objective
{
public:
  virtual ~Objective() = default;
  /// Coordinate of each unknown, ascending.
  virtual const std::vector<std::int32_t>& Coordinates() const = 0;
  /// Pattern of the Hessian with respect to the unknowns.
  virtual const SparsePattern& Pattern() const = 0;
  /// Evaluates the objective at `x` (all coordinates) up to `order`.
  virtual void Evaluate(const std::vector<double>& x, EnergyOrder order, Evaluation& result) = 0;
  /// Roundoff error of the energy, kPa mm^3.
  virtual double Noise() const = 0;
  /// A number that changes whenever the function changes.
  virtual std::uint64_t Version() const = 0;
  /// The same function with all coordinates fixed except those with the largest gradient and those
  /// around them; null if these are too many.
  virtual std::unique_ptr<Objective> WorstPart(const std::vector<double>& gradient) const = 0;
};
}

#endif
