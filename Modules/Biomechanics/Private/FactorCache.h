// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FactorCache_h
#define mammoray_FactorCache_h

#include "Private/Objective.h"
#include "Private/SparseCholesky.h"
#include "mammorayBiomechanicsModule.h"

#include <functional>
#include <vector>

namespace mammoray
{
/**
 * The Cholesky factor of an objective's Hessian, and the positions it belongs to: it still serves
 * for positions nearby, which saves a factorisation.
 */
class MAMMORAYBIOMECHANICS_EXPORT FactorCache
{
public:
  /// A factor of positions this near, mm, gives Newton steps and sensitivities to the last digits
  /// in a few products, or not at all. An expensive one gives steps from farther away.
  static constexpr double NearMm = 0.01;

  /// The pattern must outlive the cache.
  explicit FactorCache(const SparsePattern& pattern);

  /// Makes the factor that of the matrix `values` at the positions `x`. Answers false where the
  /// matrix is not positive definite.
  bool Factorize(const std::vector<double>& values, const std::vector<double>& x);
  /**
   * The same; where the matrix is indefinite, with as little as needed of the positive definite
   * matrix that `projected` makes mixed in. `stiffer`: more of it than in the last factor, which
   * was of the same positions. Answers false where all of it does not help.
   */
  bool FactorizeMixed(const std::vector<double>& values, const std::vector<double>& x,
    const std::function<std::vector<double>()>& projected, bool stiffer = false);
  /// Share of the positive definite matrix in the last factor of FactorizeMixed.
  double Share() const { return this->MixedShare; }

  /// Largest difference of a coordinate from the positions of the factor, mm; infinite where there
  /// is none or one of a mixed matrix.
  double DistanceMm(const std::vector<double>& x) const;
  /// The factor belongs to no positions any more.
  void Forget() { this->Positions.clear(); }

  /// Solves for `columns` right-hand sides stored one after the other, in place, to the
  /// factor's precision.
  void Solve(std::vector<double>& columns) { this->Cholesky.Solve(columns); }
  /**
   * The solutions for the matrix `values` that the factor is of; those of one in single precision
   * refined as by RefineNearby, and false where that fails. Of a mixed matrix, whose values are not
   * kept, as Solve gives them.
   */
  bool SolveOwn(const std::vector<double>& values, const std::vector<double>& right,
    std::size_t count, std::vector<double>& solution);
  /**
   * The solution for the matrix `values` of the positions `x` by conjugate gradients, to a
   * thousandth, where the factor's positions are near. An expensive factor, of a mixed matrix too,
   * serves from 0.5 mm away, to a hundredth, in steps that take some half of a factorisation's time
   * at most. Answers false where it is too far, the steps do not suffice or the matrix is found
   * indefinite.
   */
  bool SolveNearby(const std::vector<double>& values, const std::vector<double>& x,
    const std::vector<double>& right, std::vector<double>& solution);
  /// The same for `count` right-hand sides by iterative refinement, each to 1e-9 of its own size.
  bool RefineNearby(const std::vector<double>& values, const std::vector<double>& right,
    std::size_t count, std::vector<double>& solution);
  /// y = A x of the symmetric matrix with these values.
  void Multiply(const std::vector<double>& values, const double* x, double* y) const
  {
    this->Cholesky.Multiply(values, x, y);
  }
  /// Most memory that factor and working space have taken so far, bytes.
  double PeakBytes() const { return this->Cholesky.PeakBytes(); }

private:
  SparseCholesky Cholesky;
  /// Empty: the factor is of no positions.
  std::vector<double> Positions;
  /// Whether the factor is that of the matrix itself, not of a mixed one.
  bool Pure = false;
  double MixedShare = 0;
  /// The positive definite matrix of the last positions, where it was needed.
  std::vector<double> Projected;
};
}

#endif
