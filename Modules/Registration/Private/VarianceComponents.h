// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VarianceComponents_h
#define mammoray_VarianceComponents_h

#include "mammorayRegistrationModule.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace mammoray
{
/// Residuals of one kind, such as the outline's, of unknown variance and alike where they are near
/// each other.
struct ResidualGroup
{
  /// In their own unit, not weighted.
  Eigen::VectorXd Residuals;
  /// d Residuals / d unknowns.
  Eigen::MatrixXd Jacobian;
  /// Where they lie, mm: along a line (y = 0) or in a plane.
  std::vector<std::array<double, 2>> Places;
  /// Of the space they lie in: 1 or 2.
  int Dimension = 1;
  /// The length or area that each of them stands for, mm or mm^2. Positive.
  double Extent = 1;
  /// The part of what it tells that counts, (0, 1]: groups that share an error tell it once.
  double Share = 1;
  /// Variance times length or area over which it is alike that counts at least, however small the
  /// residuals are.
  double LeastCovariance = 0;
};

struct VarianceComponents
{
  /// Of each group: standard deviation, in its unit, and the length or area over which its
  /// residuals are as good as one, mm or mm^2, at least Extent.
  std::vector<double> Sigmas;
  std::vector<double> Correlated;
  /// Of the unknowns; false where residuals and precision together do not tell all of them.
  Eigen::MatrixXd Covariance;
  bool Determined = false;

  /// What the squares of a group's residuals count.
  double Weight(const std::vector<ResidualGroup>& groups, std::size_t group) const;
};

/**
 * The length or area over which residuals are alike: the integral of their autocorrelation up to
 * where it is lost in its own noise, 0.1 (the integral scale; of a stationary series of n, as many
 * values are as good as n / scale independent ones, Bartlett 1946), at least Extent. Of more than
 * some thousand residuals a part is taken, every so many.
 */
MAMMORAYREGISTRATION_EXPORT double IntegralScale(const ResidualGroup& group);

/**
 * Variances of groups of residuals at a minimum of their weighted squares, from the residuals
 * themselves: iterated almost unbiased estimation, sigma^2 = r^T r / (n - tr(C N)), each group
 * counting as many residuals as are independent (Förstner 1979; where it settles it is the
 * restricted maximum likelihood of Patterson and Thompson 1971). `precision`: what is known of the
 * unknowns beforehand, the inverse of their covariance. A group is left at least one residual to
 * tell its variance by.
 */
MAMMORAYREGISTRATION_EXPORT VarianceComponents EstimateVariances(
  const std::vector<ResidualGroup>& groups, const Eigen::MatrixXd& precision);

/**
 * The covariance of sums over places of `scores` (one row each) times an unknown field of variance
 * 1 that is alike over `alikeMm`: the sum of exp(-distance / alikeMm) s_i^T s_j over all pairs (of
 * Matern's fields the one with nu = 1/2). Places within an eighth of that length count as one.
 */
MAMMORAYREGISTRATION_EXPORT Eigen::MatrixXd SmoothCovariance(
  const std::vector<std::array<double, 2>>& places, const Eigen::MatrixXd& scores, double alikeMm);

/**
 * The minimum of squares with any weights w as an estimate of the unknowns. Errors e of the
 * residuals move it by -A^-1 J^T w e, A = J^T w J + P, P the precision of what is known beforehand;
 * so its covariance is A^-1 (J^T w S w J + P) A^-1, S that of the residuals (the sandwich, Huber
 * 1967). That of EstimateVariances, (J^T S^-1 J + P)^-1, is less unless w is S^-1.
 */
struct MAMMORAYREGISTRATION_EXPORT WeightedEstimate
{
  /// A^-1.
  Eigen::MatrixXd Inverse;
  Eigen::MatrixXd Covariance;

  /// `weights`: of the squares of each group's residuals. The variances must be Determined.
  WeightedEstimate(const std::vector<ResidualGroup>& groups, const std::vector<double>& weights,
    const VarianceComponents& variances, const Eigen::MatrixXd& precision);
};
}

#endif
