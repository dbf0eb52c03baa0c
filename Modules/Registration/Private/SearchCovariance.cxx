// SPDX-License-Identifier: Apache-2.0
#include "Private/SearchCovariance.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace mammoray
{
namespace
{
bool IsOf(const FreeParameter& parameter, std::size_t view)
{
  return std::find(parameter.Views.begin(), parameter.Views.end(), view) != parameter.Views.end();
}

/// Parameters that are fixed but uncertain: those with a prior, a shared one once.
std::vector<FreeParameter> Considered(const SearchState& search)
{
  std::vector<FreeParameter> considered;
  for (std::size_t view = 0; view < search.Views.size(); ++view)
  {
    for (int index = 0; index < ParameterCount; ++index)
    {
      const RegistrationParameter& parameter = search.Views[view].Result.Parameters[index];
      if (parameter.Fixed && parameter.PriorSigma > 0 && (view == 0 || !IsShared(index)))
      {
        considered.push_back({ index, search.ViewsOf(index, view), 0, 0, parameter.PriorSigma });
      }
    }
  }
  return considered;
}

/// The number, among free parameters, of a parameter of a view; nothing if it is fixed.
std::optional<std::size_t> UnknownOf(const std::vector<FreeParameter>& unknowns, int parameter,
  std::size_t view)
{
  const auto found = std::find_if(unknowns.begin(), unknowns.end(),
    [&](const FreeParameter& unknown)
    { return unknown.Parameter == parameter && IsOf(unknown, view); });
  return found == unknowns.end()
    ? std::nullopt
    : std::optional(static_cast<std::size_t>(found - unknowns.begin()));
}

/// d residuals / d parameters in units of their scales, at the evaluated point, whose Jacobian has
/// those of the unknowns.
Eigen::MatrixXd ColumnsOf(RegistrationEvaluator& evaluator,
  const std::vector<FreeParameter>& parameters)
{
  Eigen::MatrixXd columns =
    Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(evaluator.Residuals.size()),
      static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t view = 0; view < evaluator.Views.size(); ++view)
  {
    const std::size_t first = evaluator.First[view];
    const std::size_t count = evaluator.NumberOfResiduals(view);
    const auto put = [&](std::size_t index, const double* column, double scale)
    {
      columns.col(static_cast<Eigen::Index>(index))
        .segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count)) =
        scale * Eigen::Map<const Eigen::VectorXd>(column, static_cast<Eigen::Index>(count));
    };
    std::vector<int> wanted;
    std::vector<std::size_t> places;
    for (std::size_t index = 0; index < parameters.size(); ++index)
    {
      const FreeParameter& parameter = parameters[index];
      if (!IsOf(parameter, view))
      {
        continue;
      }
      if (const auto known = UnknownOf(evaluator.FreeParameters, parameter.Parameter, view))
      {
        put(index, evaluator.Jacobian.col(static_cast<Eigen::Index>(*known)).data() + first,
          parameter.Scale / evaluator.FreeParameters[*known].Scale);
      }
      else
      {
        wanted.push_back(parameter.Parameter);
        places.push_back(index);
      }
    }
    const RegistrationResiduals::Jacobian jacobian = evaluator.Views[view]->Differentiate(wanted);
    for (std::size_t index = 0; index < wanted.size(); ++index)
    {
      put(places[index], jacobian.Columns[wanted[index]].data(), parameters[places[index]].Scale);
    }
  }
  return columns;
}

/**
 * The breast's edge in a picture and in a mesh: a voxel, a facet's distance, the rounder edges of
 * the model's plates and where air ends put all of an outline a little in or out, alike in all
 * residuals, so that they do not tell. Standard deviation of that, mm.
 */
constexpr double EdgeSigmaMm = 0.4;

/**
 * Tissue in the model lies beside the true by a smooth displacement that no residual shows, since
 * the parameters have absorbed it: standard deviation each way, mm, and the length over which it is
 * alike, mm. What a picture tells is no better than that: where it is compared by its gradients,
 * ten twins' parameters were within two of their deviations in 64 % without it, in 97 with it.
 */
constexpr double DisplacementMm = 0.4;
constexpr double DisplacementAlikeMm = 30;

/// Difference between the displacements of tissue at the two plates, as an angle, degrees. It looks
/// like a roll or pitch of the unit.
double ShearDeg(double thicknessMm)
{
  const double alike = std::exp(-thicknessMm / DisplacementAlikeMm);
  return std::sqrt(2 * (1 - alike)) * DisplacementMm / thicknessMm * 180 / std::numbers::pi;
}

/// Covariance of the sum of the weighted residuals that this displacement causes.
Eigen::MatrixXd DisplacementCovariance(RegistrationEvaluator& evaluator,
  const ResidualGroups& compared, Eigen::Index count)
{
  // The picture moves with the receptor as it does where all tissue is displaced.
  std::vector<std::size_t> all(evaluator.Views.size());
  std::iota(all.begin(), all.end(), std::size_t{ 0 });
  const Eigen::MatrixXd moved = ColumnsOf(evaluator,
    { { LateralParameter, all }, { AnteriorParameter, all }, { RollParameter, all },
      { PitchParameter, all } });
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(count, count);
  for (const std::size_t view : all)
  {
    const double shear = ShearDeg(evaluator.Views[view]->Current->Pose().ThicknessMm);
    std::vector<std::array<double, 2>> places;
    std::vector<Eigen::Index> rows;
    Eigen::MatrixXd weighted(0, count);
    for (std::size_t number = 0; number < compared.Groups.size(); ++number)
    {
      const ResidualGroup& group = compared.Groups[number];
      if (compared.View[number] == view && group.Dimension == 2)
      {
        places.insert(places.end(), group.Places.begin(), group.Places.end());
        for (Eigen::Index row = 0; row < group.Residuals.size(); ++row)
        {
          rows.push_back(compared.First[number] + row);
        }
        weighted.conservativeResize(weighted.rows() + group.Residuals.size(), Eigen::NoChange);
        // The columns are in the search's weights, as its residuals are.
        weighted.bottomRows(group.Residuals.size()) = compared.Factors[number] * group.Jacobian;
      }
    }
    const double sizes[] = { DisplacementMm, DisplacementMm, shear, shear };
    for (Eigen::Index way = 0; way < moved.cols(); ++way)
    {
      const Eigen::ArrayXd moves = sizes[way] * moved.col(way)(rows).array();
      scatter += SmoothCovariance(places, (weighted.array().colwise() * moves).matrix(),
        DisplacementAlikeMm);
    }
  }
  return scatter;
}

/// The search as an estimate, whose covariance also has what moves all of an outline, and tissue
/// in the picture.
WeightedEstimate EstimateOf(RegistrationEvaluator& evaluator, const ResidualGroups& compared)
{
  std::vector<double> weights;
  // One sum for each view: its projections share the shift.
  std::vector<Eigen::VectorXd> pulls(compared.View.back() + 1,
    Eigen::VectorXd::Zero(compared.Priors.rows()));
  for (std::size_t number = 0; number < compared.Groups.size(); ++number)
  {
    const ResidualGroup& group = compared.Groups[number];
    const double weight = compared.Factors[number] * compared.Factors[number];
    weights.push_back(weight);
    if (group.Dimension == 1)
    {
      pulls[compared.View[number]] +=
        EdgeSigmaMm * weight * group.Jacobian.colwise().sum().transpose();
    }
  }
  WeightedEstimate estimate(compared.Groups, weights, compared.Variances, compared.Priors);
  Eigen::MatrixXd scatter = DisplacementCovariance(evaluator, compared, compared.Priors.rows());
  // A prior's residual has this deviation; WeightedEstimate counts 1.
  scatter += (PriorWeight * PriorWeight - 1) * compared.Priors;
  for (const Eigen::VectorXd& pull : pulls)
  {
    scatter += pull * pull.transpose();
  }
  estimate.Covariance += estimate.Inverse * scatter * estimate.Inverse;
  return estimate;
}

/// S in units of the unknowns' scales: errors c of considered parameters, by whose unit the
/// residuals change by `columns` (in the search's weights, as its residuals are), move the minimum
/// by S c, S = -A^-1 J^T W J_c (Schmidt 1966; Tapley, Schutz and Born 2004, section 6.2).
Eigen::MatrixXd ShiftOf(const ResidualGroups& compared, const WeightedEstimate& estimate,
  const Eigen::MatrixXd& columns)
{
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(estimate.Inverse.rows(), columns.cols());
  for (std::size_t number = 0; number < compared.Groups.size(); ++number)
  {
    const ResidualGroup& group = compared.Groups[number];
    pull += compared.Factors[number] * group.Jacobian.transpose() *
      columns.middleRows(compared.First[number], group.Residuals.size());
  }
  return -estimate.Inverse * pull;
}

/**
 * Adds what edges rounder than a unit's (SearchedEdgeRadiusMm), or sharper ones, do to the
 * unknowns: all of what lies between the model's and a unit's, as one standard deviation of a
 * considered parameter that no residual tells of, the same for all mammograms. By how much
 * residuals change is told by another equilibrium of each; where one has none, nothing is added,
 * and false returned.
 * The paddle tilts to press out tissue that is too thick behind round edges: in twins it is 3 to 5
 * degrees off, thickness 1.2 mm, alike in all.
 */
bool AddRoundEdges(RegistrationEvaluator& evaluator, const ResidualGroups& compared,
  WeightedEstimate& estimate)
{
  const double radiusMm = MammographyUnit{}.EdgeRadiusMm;
  Eigen::VectorXd changes =
    Eigen::VectorXd::Zero(static_cast<Eigen::Index>(evaluator.Residuals.size()));
  for (std::size_t view = 0; view < evaluator.Views.size(); ++view)
  {
    ViewEvaluator& own = *evaluator.Views[view];
    if (own.Breast.Placement.Unit.EdgeRadiusMm != radiusMm)
    {
      const std::vector<double> residuals = own.WithEdges(radiusMm);
      if (residuals.empty())
      {
        return false;
      }
      const auto first = static_cast<Eigen::Index>(evaluator.First[view]);
      const auto count = static_cast<Eigen::Index>(residuals.size());
      changes.segment(first, count) = Eigen::Map<const Eigen::VectorXd>(residuals.data(), count) -
        Eigen::Map<const Eigen::VectorXd>(evaluator.ResidualsOf(view).data(), count);
    }
  }
  const Eigen::MatrixXd shift = ShiftOf(compared, estimate, changes);
  estimate.Covariance += shift * shift.transpose();
  return true;
}

/// The covariance of the unknowns and of what is considered, in units of their scales and priors
/// (consider covariance, ShiftOf).
Eigen::MatrixXd ConsiderCovariance(RegistrationEvaluator& evaluator,
  const std::vector<FreeParameter>& considered, const ResidualGroups& compared,
  const WeightedEstimate& estimate)
{
  const Eigen::MatrixXd shift = ShiftOf(compared, estimate, ColumnsOf(evaluator, considered));
  const Eigen::Index count = shift.rows();
  const Eigen::Index fixed = shift.cols();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(count + fixed, count + fixed);
  covariance.topLeftCorner(count, count) = estimate.Covariance + shift * shift.transpose();
  covariance.topRightCorner(count, fixed) = shift;
  covariance.bottomLeftCorner(fixed, count) = shift.transpose();
  return covariance;
}

/// The part of a covariance of parameters, in units of their scales, that belongs to a view: of all
/// ParameterCount, in their own units, 0 for those without one.
std::vector<double> PartOf(const Eigen::MatrixXd& covariance,
  const std::vector<FreeParameter>& parameters, std::size_t view)
{
  std::vector<double> part(std::size_t{ ParameterCount } * ParameterCount, 0.0);
  for (std::size_t i = 0; i < parameters.size(); ++i)
  {
    for (std::size_t j = 0; IsOf(parameters[i], view) && j < parameters.size(); ++j)
    {
      if (IsOf(parameters[j], view))
      {
        part[parameters[i].Parameter * ParameterCount + parameters[j].Parameter] =
          parameters[i].Scale * parameters[j].Scale *
          covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      }
    }
  }
  return part;
}

/// Groups are in pairs, outline and picture; of a mammogram that of Target comes first.
void KeepMisfit(const ResidualGroups& compared, std::size_t view, RegistrationMisfit& misfit)
{
  const auto first = static_cast<std::size_t>(
    std::find(compared.View.begin(), compared.View.end(), view) - compared.View.begin());
  misfit.OutlineSigmaMm = compared.Variances.Sigmas[first];
  misfit.OutlineScaleMm = compared.Variances.Correlated[first];
  misfit.PictureSigma = compared.Variances.Sigmas[first + 1];
  misfit.PictureScaleMm = std::sqrt(compared.Variances.Correlated[first + 1]);
}

}

Eigen::MatrixXd CovarianceOf(RegistrationEvaluator& evaluator, const ResidualGroups& compared)
{
  return EstimateOf(evaluator, compared).Covariance;
}

void KeepCovariance(RegistrationEvaluator& evaluator, SearchState& search)
{
  evaluator.ReturnTo(search.CurrentBreasts());
  const std::optional<ResidualGroups> found = CompareGroups(evaluator);
  if (!found)
  {
    return;
  }
  const ResidualGroups& compared = *found;
  const std::vector<FreeParameter>& unknowns = evaluator.FreeParameters;
  for (std::size_t view = 0; view < search.Views.size(); ++view)
  {
    KeepMisfit(compared, view, search.Views[view].Result.Misfit);
  }
  WeightedEstimate estimate = EstimateOf(evaluator, compared);
  if (!AddRoundEdges(evaluator, compared, estimate))
  {
    for (ViewSearch& view : search.Views)
    {
      view.Result.Warnings.push_back(
        "Between plates with a unit's sharper edges no equilibrium was found: standard deviations "
        "do not count that the model's edges are rounder.");
    }
  }
  const std::size_t n = unknowns.size();
  search.Covariance.resize(n * n);
  for (std::size_t i = 0; i < n; ++i)
  {
    for (std::size_t j = 0; j < n; ++j)
    {
      search.Covariance[i * n + j] = unknowns[i].Scale * unknowns[j].Scale *
        estimate.Covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  const std::vector<FreeParameter> considered = Considered(search);
  const Eigen::MatrixXd extended = ConsiderCovariance(evaluator, considered, compared, estimate);
  std::vector<FreeParameter> all = unknowns;
  all.insert(all.end(), considered.begin(), considered.end());
  for (std::size_t view = 0; view < search.Views.size(); ++view)
  {
    ViewResult& result = search.Views[view].Result;
    result.Covariance = PartOf(estimate.Covariance, unknowns, view);
    result.ConsideredCovariance = PartOf(extended, all, view);
    for (const FreeParameter& parameter : unknowns)
    {
      if (IsOf(parameter, view))
      {
        result.StandardDeviations[parameter.Parameter] =
          std::sqrt(result.Covariance[parameter.Parameter * (ParameterCount + 1)]);
      }
    }
  }
}
}
