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
  /// Residuals in their own unit, not weighted.
  Eigen::VectorXd Residuals;
  /// d Residuals / d unknowns.
  Eigen::MatrixXd Jacobian;
  /// Their positions, mm: along a line (y = 0) or in a plane.
  std::vector<std::array<double, 2>> Places;
  /// Dimension of the space they lie in: 1 or 2.
  int Dimension = 1;
  /// Length or area that each of them represents, mm or mm^2. Positive.
  double Extent = 1;
  /// Share of its information that counts, (0, 1]: groups with a common error count once together.
  double Share = 1;
  /// Lower limit of variance times correlation length or area, however small the residuals are.
  double LeastCovariance = 0;
};

struct VarianceComponents
{
  /// For each group the standard deviation, in its unit, and the length or area over which its
  /// residuals count as one, mm or mm^2, at least Extent.
  std::vector<double> Sigmas;
  std::vector<double> Correlated;
  /// Covariance of the free parameters, and whether residuals and priors together determine them.
  Eigen::MatrixXd Covariance;
  bool Determined = false;

  /// Weight of the squares of a group's residuals.
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
