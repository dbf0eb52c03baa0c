// SPDX-License-Identifier: Apache-2.0
#include "Private/ResidualGroups.h"

#include "Private/PictureResiduals.h"

#include <cmath>

namespace mammoray
{
namespace
{
/**
 * Smallest misfit between models of one breast that differ in mesh and elements: outlines 0.25 mm,
 * correlated over 30 mm; pictures a tenth of the root mean square of the compared features, over
 * 14 mm (medians of twins). A target that happens to be made like the model is no better known: a
 * ball compressed and searched on nearly the same mesh was found 3.4 mm too thick, six of the
 * deviations that its small residuals gave.
 */
constexpr double LeastOutlineCovariance = 2.0;
constexpr double LeastPictureCovariance = 2.0;

/// Distances along a line through places, mm, and their mean.
double AlongLine(const std::vector<ReceptorPoint>& places,
  std::vector<std::array<double, 2>>& distances)
{
  double length = 0;
  for (std::size_t index = 0; index < places.size(); ++index)
  {
    length += index == 0 ? 0
                         : std::hypot(places[index][0] - places[index - 1][0],
                             places[index][1] - places[index - 1][1]);
    distances.push_back({ length, 0 });
  }
  return length / static_cast<double>(places.size());
}

/// Appends the outline and the picture of one projection, whose residuals begin at `first`.
void AddGroups(const PictureResiduals& compared, PosedBreast& seen,
  const Eigen::VectorXd& residuals, const Eigen::MatrixXd& jacobian, Eigen::Index first,
  ResidualGroups& groups)
{
  const auto outline = static_cast<Eigen::Index>(compared.NumberOfOutlineResiduals());
  const auto picture = static_cast<Eigen::Index>(compared.NumberOfIntensityResiduals());
  const auto add = [&](Eigen::Index begin, Eigen::Index count, double factor) -> ResidualGroup&
  {
    groups.First.push_back(begin);
    groups.Factors.push_back(factor);
    ResidualGroup& group = groups.Groups.emplace_back(ResidualGroup{
      residuals.segment(begin, count) / factor, jacobian.middleRows(begin, count) / factor, {} });
    group.Share = compared.Share();
    return group;
  };
  ResidualGroup& line = add(first, outline, compared.OutlineFactor());
  line.Extent = AlongLine(compared.OutlinePlaces(seen), line.Places);
  line.LeastCovariance = LeastOutlineCovariance;
  ResidualGroup& plane = add(first + outline, picture, compared.IntensityFactor());
  plane.Places = compared.IntensityPlaces();
  plane.Dimension = 2;
  plane.Extent = compared.AreaPerFeature();
  plane.LeastCovariance = LeastPictureCovariance * compared.TargetRms() * compared.TargetRms();
}

ResidualGroups GroupsOf(RegistrationEvaluator& evaluator)
{
  ResidualGroups groups;
  const Eigen::Map<const Eigen::VectorXd> residuals(evaluator.Residuals.data(),
    static_cast<Eigen::Index>(evaluator.Residuals.size()));
  Eigen::Index first = 0;
  for (std::size_t number = 0; number < evaluator.Views.size(); ++number)
  {
    const ViewEvaluator& view = *evaluator.Views[number];
    Eigen::Index begin = first;
    for (std::size_t projection = 0; projection < view.Compared.NumberOfProjections(); ++projection)
    {
      const PictureResiduals& picture = view.Compared.Picture(projection);
      AddGroups(picture, view.Compared.Seen(*view.Current, projection), residuals,
        evaluator.Jacobian, begin, groups);
      groups.View.resize(groups.Groups.size(), number);
      begin += static_cast<Eigen::Index>(picture.NumberOfResiduals());
    }
    first += static_cast<Eigen::Index>(evaluator.NumberOfResiduals(number));
  }
  return groups;
}

/// Rows of the Jacobian that belong to priors: in their standard deviations.
Eigen::MatrixXd PriorRows(const RegistrationEvaluator& evaluator)
{
  std::vector<Eigen::Index> rows;
  for (std::size_t index = 0; index < evaluator.RobustWidths.size(); ++index)
  {
    if (!std::isfinite(evaluator.RobustWidths[index]))
    {
      rows.push_back(static_cast<Eigen::Index>(index));
    }
  }
  return evaluator.Jacobian(rows, Eigen::all);
}
}

void ResidualGroups::WeighByVariances(RegistrationEvaluator& evaluator)
{
  std::vector<std::vector<double>> factors(evaluator.Views.size());
  for (std::size_t group = 0; group < this->Groups.size(); ++group)
  {
    this->Factors[group] = std::sqrt(this->Variances.Weight(this->Groups, group));
    factors[this->View[group]].push_back(this->Factors[group]);
  }
  evaluator.Weigh(factors);
}

std::optional<ResidualGroups> CompareGroups(RegistrationEvaluator& evaluator)
{
  evaluator.PrepareForEvaluation(true, true);
  if (!evaluator.Valid || evaluator.Stopped)
  {
    return std::nullopt;
  }
  ResidualGroups groups = GroupsOf(evaluator);
  const Eigen::MatrixXd priorRows = PriorRows(evaluator);
  groups.Priors = priorRows.transpose() * priorRows;
  // Variances are estimated with the priors' own deviations, without the weight of the search.
  groups.Variances = EstimateVariances(groups.Groups, groups.Priors / (PriorWeight * PriorWeight));
  if (!groups.Variances.Determined)
  {
    return std::nullopt;
  }
  return groups;
}
}
