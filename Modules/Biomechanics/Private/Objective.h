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

  /// Place of an entry of the pattern, row >= column, among the values.
  std::size_t PlaceOf(std::int32_t column, std::int32_t row) const
  {
    const auto begin = this->Rows.begin() + this->Starts[column];
    const auto end = this->Rows.begin() + this->Starts[column + 1];
    return static_cast<std::size_t>(std::lower_bound(begin, end, row) - this->Rows.begin());
  }
};

/// An objective at one set of positions, as far as it was asked for.
struct Evaluation
{
  /// False where the energy is not defined; then nothing else counts.
  bool Valid = false;
  /// kPa mm^3
  double Energy = 0;
  PositionMeasures Measures;
  /// By all coordinates, fixed ones too (there minus the force that holds the body), kPa mm^2.
  std::vector<double> Gradient;
  /// Norm of the gradient by the unknowns, and of the force that it is measured against.
  double ResidualNorm = 0;
  double ForceScale = 1;
  /// Values of the pattern's entries.
  std::vector<double> Hessian;

  double RelativeResidual() const { return this->ResidualNorm / this->ForceScale; }
};

/**
 * A function of the coordinates of points, some of which are fixed, as Newton's method minimises
 * it: all that NewtonSolver knows of it. Evaluating uses memory of its own, so one thread at a
 * time.
 */
class Objective
{
public:
  virtual ~Objective() = default;
  /// The coordinate of each unknown, ascending.
  virtual const std::vector<std::int32_t>& Coordinates() const = 0;
  /// Pattern of the Hessian by the unknowns.
  virtual const SparsePattern& Pattern() const = 0;
  /// At `x`, all coordinates, up to `order`.
  virtual void Evaluate(const std::vector<double>& x, EnergyOrder order, Evaluation& result) = 0;
  /// What roundoff does to the energy.
  virtual double Noise() const = 0;
  /// A number that is another one whenever the function has changed.
  virtual std::uint64_t Version() const = 0;
  /**
   * The same function with all coordinates fixed but those where the gradient is largest and those
   * around them; null where they are too many to be a part.
   */
  virtual std::unique_ptr<Objective> WorstPart(const std::vector<double>& gradient) const = 0;
};
}

#endif
