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
/// The Cholesky factor of an objective's Hessian and the positions it belongs to. Nearby positions
/// can reuse it, which saves a factorisation.
class MAMMORAYBIOMECHANICS_EXPORT FactorCache
{
public:
  /// Within this distance (largest difference of a coordinate, mm) a factor either yields Newton
  /// steps and sensitivities to the last digits in a few products or is rejected. An expensive
  /// factor is also used for steps from farther away.
  static constexpr double NearMm = 0.01;

  /// The pattern must outlive the cache.
  explicit FactorCache(const SparsePattern& pattern);

  /// Factorises the matrix `values` of the positions `x`. Returns false if the matrix is not
  /// positive definite.
  bool Factorize(const std::vector<double>& values, const std::vector<double>& x);
  /**
   * As Factorize. If the matrix is indefinite, adds as small a share as needed of the positive
   * definite matrix that `projected` returns. `stiffer` requests a larger share than that of the
   * last factor, which must belong to the same positions. Returns false if even the whole of it
   * does not help.
   */
  bool FactorizeMixed(const std::vector<double>& values, const std::vector<double>& x,
    const std::function<std::vector<double>()>& projected, bool stiffer = false);
  /// Share of the positive definite matrix in the last factor of FactorizeMixed, [0, 1].
  double Share() const { return this->MixedShare; }

  /// Largest difference of a coordinate from the positions of the factor, mm. It is infinite if
  /// there is no factor or if the factor is of a mixed matrix.
  double DistanceMm(const std::vector<double>& x) const;
  /// Marks the factor as belonging to no positions.
  void Forget() { this->Positions.clear(); }

  /// Solves in place for the right-hand sides stored one after the other in `columns`, to the
  /// factor's precision.
  void Solve(std::vector<double>& columns) { this->Cholesky.Solve(columns); }
  /// Solves for the matrix `values` that was factorised. A factor in single precision is refined as
  /// by RefineNearby; returns false if that fails. For a mixed matrix, whose values are not kept,
  /// the result is that of Solve.
  bool SolveOwn(const std::vector<double>& values, const std::vector<double>& right,
    std::size_t count, std::vector<double>& solution);
  /**
   * Solves for the matrix `values` of the positions `x` by preconditioned conjugate gradients to a
   * relative residual of 1e-3, if the factor's positions are near. An expensive factor, also one of
   * a mixed matrix, is used within 0.5 mm, to 1e-2, with iterations that take at most about half of
   * the time of a factorisation. Returns false if the factor is too far away, the iterations do not
   * suffice or the matrix is indefinite.
   */
  bool SolveNearby(const std::vector<double>& values, const std::vector<double>& x,
    const std::vector<double>& right, std::vector<double>& solution);
  /// As SolveNearby for `count` right-hand sides, by iterative refinement; each to 1e-9 of its own
  /// norm.
  bool RefineNearby(const std::vector<double>& values, const std::vector<double>& right,
    std::size_t count, std::vector<double>& solution);
  /// y = A x for the symmetric matrix with these values.
  void Multiply(const std::vector<double>& values, const double* x, double* y) const
  {
    this->Cholesky.Multiply(values, x, y);
  }
  /// Largest memory of factor and working space so far, bytes.
  double PeakBytes() const { return this->Cholesky.PeakBytes(); }

private:
  SparseCholesky Cholesky;
  /// Positions of the factor; empty if it belongs to none.
  std::vector<double> Positions;
  /// True if the matrix itself was factorised, not a mixed one.
  bool Pure = false;
  double MixedShare = 0;
  /// The positive definite matrix at the last positions, if it was needed.
  std::vector<double> Projected;
};
}

#endif
