// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/RegistrationResult.h"

#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/PoseParameters.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace mammoray
{
const char* NameOf(Trust trust)
{
  return trust == Trust::Good ? "good" : trust == Trust::Doubtful ? "doubtful" : "none";
}

const char* VerdictOf(Trust trust)
{
  return trust == Trust::Good  ? "The two mammograms match"
    : trust == Trust::Doubtful ? "The match should be checked by eye"
                               : "The match is not to be trusted";
}

namespace
{
/// If both plates hold the breast, each presses with at least this share of the other's force.
constexpr double LeastShareOfForce = 0.05;

/// How many standard deviations a value lies from where its prior expects it: the prior's and,
/// where it is known, the value's own; 0 without a prior.
double DeviationsFromPrior(const RegistrationParameter& parameter, double value, double sigma)
{
  if (parameter.Fixed || !(parameter.PriorSigma > 0))
  {
    return 0;
  }
  return std::abs(value - parameter.Start) /
    std::hypot(parameter.PriorSigma, std::isfinite(sigma) ? sigma : 0.0);
}

/// Adds why a breast may lie otherwise than a match of pictures tells.
template <typename Add>
void AddMechanics(const ViewResult& result, const Add& add)
{
  if (result.State.Positions.empty())
  {
    return;
  }
  // Forces follow a breast's size and the stiffness in the table, which is unknown by a factor of
  // two: the two plates' are compared with each other.
  const auto [least, most] = std::minmax(result.State.PaddleForceN, result.State.SupportForceN);
  if (most <= 0 || least < LeastShareOfForce * most)
  {
    add(Trust::Doubtful,
      "The paddle presses with " + NumberText(result.State.PaddleForceN, 1) +
        " N, the support with " + NumberText(result.State.SupportForceN, 1) +
        " N: what holds the breast in the model is not the plates. At least a twentieth of the "
        "other's force is wanted of each.");
  }
  if (result.OtherEquilibriumMm > 3)
  {
    add(Trust::Doubtful,
      "The breast can lie in another way between the same plates, " +
        NumberText(result.OtherEquilibriumMm, 0) +
        " mm away on average: it may have toppled to the other side.");
  }
}

/// Adds doubts that picture and volume are of one breast, from the correlation of their tissue.
template <typename Add>
void AddTissue(const ViewResult& result, const Add& add)
{
  const double tissue = result.After.TissueCorrelation;
  if (std::isnan(tissue))
  {
    add(Trust::Doubtful,
      "Too little of the breast is as thick as the plates are apart to tell it from another by its "
      "tissue.");
  }
  else if (tissue < GoodTissueCorrelation)
  {
    add(tissue < LeastTissueCorrelation ? Trust::None : Trust::Doubtful,
      "The tissue inside looks little alike in both pictures, as in those of two breasts: its "
      "correlation is " +
        NumberText(tissue, 2) + ", " + NumberText(GoodTissueCorrelation, 2) +
        " or more is wanted.");
  }
}

/// How far the thickness found may lie from a unit's readout, mm: what quality control asks of the
/// indicator (ACR, Digital Mammography QC Manual 2016: 5 mm), or, of thick breasts more, what rigid
/// paddles were measured to be off by (Hauge et al., Med. Phys. 39, 263, 2012: up to 14.3 % of the
/// thickness, flexible ones 26 %).
double ReadoutTolerance(double thicknessMm)
{
  return std::max(5.0, 0.15 * thicknessMm);
}

/// Adds what the header and the result disagree on.
template <typename Add>
void AddHeader(const ViewResult& result, const Add& add)
{
  if (result.HeaderThicknessMm)
  {
    const double off = std::abs(result.Pose.ThicknessMm - *result.HeaderThicknessMm);
    const double most = ReadoutTolerance(*result.HeaderThicknessMm);
    if (off > most)
    {
      // Twice as much no paddle's readout is off.
      add(off > 2 * most ? Trust::None : Trust::Doubtful,
        "The breast was found " + NumberText(result.Pose.ThicknessMm, 1) +
          " mm thick, the mammogram's header says " + NumberText(*result.HeaderThicknessMm, 1) +
          " mm: they are " + NumberText(off, 1) + " mm apart, " + NumberText(most, 1) +
          " mm or less is wanted.");
    }
  }
  for (const std::string& disagreement : result.Disagreements)
  {
    add(Trust::Doubtful, disagreement);
  }
}
}

Assessment Assess(const ViewResult& result)
{
  Assessment assessment;
  const auto add = [&](Trust level, const std::string& reason)
  {
    assessment.Level = std::max(assessment.Level, level);
    assessment.Reasons.push_back(reason);
  };
  if (!std::isfinite(result.After.Correlation) ||
    !std::isfinite(result.After.MeanOutlineDistanceMm) ||
    !std::isfinite(result.After.LargestOutlineDistanceMm))
  {
    add(Trust::None, "The agreement of the pictures could not be computed.");
  }
  AddTissue(result, add);
  if (result.After.Correlation < 0.5)
  {
    add(Trust::Doubtful,
      "The pictures look little alike inside the breast: their correlation is " +
        NumberText(result.After.Correlation, 2) + ", 0.5 or more is wanted.");
  }
  if (result.After.MeanOutlineDistanceMm > 1.5)
  {
    add(result.After.MeanOutlineDistanceMm > 3 ? Trust::None : Trust::Doubtful,
      "The outlines of the breast lie " + NumberText(result.After.MeanOutlineDistanceMm, 1) +
        " mm apart on average, 1.5 mm or less is wanted.");
  }
  if (result.After.LargestOutlineDistanceMm > 5)
  {
    add(result.After.LargestOutlineDistanceMm > 10 ? Trust::None : Trust::Doubtful,
      "At one place the outlines lie " + NumberText(result.After.LargestOutlineDistanceMm, 1) +
        " mm apart, 5 mm or less is wanted.");
  }
  if (!result.Converged)
  {
    add(Trust::Doubtful,
      "The search ended before it had settled" +
        (result.StopReason.empty() ? std::string(".") : ": " + result.StopReason + "."));
  }
  for (std::size_t i = 0; i < std::min(result.Parameters.size(), result.Values.size()); ++i)
  {
    if (AtBound(result.Parameters[i], result.Values[i]))
    {
      add(Trust::Doubtful,
        std::string(FindPoseParameter(result.Parameters[i].Name).Title) +
          " ended at the limit of what was allowed: the best value may lie beyond it.");
    }
    const double sigma =
      i < result.StandardDeviations.size() ? result.StandardDeviations[i] : std::nan("");
    const double deviations = DeviationsFromPrior(result.Parameters[i], result.Values[i], sigma);
    if (deviations > 3)
    {
      add(Trust::Doubtful,
        std::string(FindPoseParameter(result.Parameters[i].Name).Title) + " ended " +
          NumberText(deviations, 1) +
          " standard deviations from what was to be expected, 3 or less are wanted.");
    }
  }
  AddMechanics(result, add);
  AddHeader(result, add);
  return assessment;
}

bool AtBound(const RegistrationParameter& parameter, double value)
{
  const double tolerance = 1e-3 * (parameter.Upper - parameter.Lower);
  return !parameter.Fixed && parameter.Upper > parameter.Lower &&
    (value - parameter.Lower < tolerance || parameter.Upper - value < tolerance);
}

namespace
{
/// A rigid motion is found from so many points: a hundredth of a millimetre of scatter.
constexpr double RigidPoints = 2000;

Vector3 PointAt(const std::vector<double>& points, std::int64_t index)
{
  const double* const at = points.data() + 3 * index;
  return { at[0], at[1], at[2] };
}

/// Mean over the corners of a cell of a field of vectors, one for each point.
Vector3 MiddleOf(const TetrahedralMesh& mesh, const std::vector<double>& field, std::size_t cell)
{
  const auto* const corners = &mesh.Cells[4 * cell];
  return 0.25 *
    (PointAt(field, corners[0]) + PointAt(field, corners[1]) + PointAt(field, corners[2]) +
      PointAt(field, corners[3]));
}

/// The distance below which this part of some points lie that are normally distributed, each alike
/// in all directions with its own deviation: the quantile of a mixture of Maxwell distributions.
double DistanceQuantile(const std::vector<double>& sigmas, double part)
{
  const auto below = [&](double distance)
  {
    double sum = 0;
    for (const double sigma : sigmas)
    {
      const double x = distance / sigma;
      sum += std::erf(x / std::numbers::sqrt2) -
        std::sqrt(2 / std::numbers::pi) * x * std::exp(-0.5 * x * x);
    }
    return sum / static_cast<double>(sigmas.size());
  };
  // A normal distribution has next to nothing beyond ten deviations.
  double low = 0;
  double high = 10 * *std::max_element(sigmas.begin(), sigmas.end());
  for (int halving = 0; halving < 40; ++halving)
  {
    const double middle = 0.5 * (low + high);
    (below(middle) < part ? low : high) = middle;
  }
  return high;
}
}

ModelError::ModelError(const TetrahedralMesh& anatomy, const std::vector<double>& points,
  const VolumeFromGantry& placed)
  : Placed(placed)
{
  std::vector<double> volumes;
  for (const bool between : { true, false })
  {
    volumes.assign(anatomy.NumberOfCells(), 0.0);
    for (std::size_t cell = 0; cell < volumes.size(); ++cell)
    {
      if (!between || placed.ToGantry(MiddleOf(anatomy, points, cell))[1] > 0)
      {
        volumes[cell] = std::abs(anatomy.CellVolume(cell));
      }
    }
    if (std::any_of(volumes.begin(), volumes.end(), [](double volume) { return volume > 0; }))
    {
      break; // else all tissue lies behind the plates' edge
    }
  }
  const double share = std::accumulate(volumes.begin(), volumes.end(), 0.0) / RigidPoints;
  double sum = 0;
  for (std::size_t cell = 0; cell < volumes.size(); ++cell)
  {
    sum += volumes[cell];
    if (volumes[cell] > 0 && sum >= 0.5 * share)
    {
      sum -= share;
      this->Cells.push_back(cell);
    }
  }
  const auto count = static_cast<Eigen::Index>(this->Cells.size());
  Eigen::Matrix3Xd rest(3, count);
  Eigen::Matrix3Xd moved(3, count);
  for (Eigen::Index index = 0; index < count; ++index)
  {
    const std::size_t cell = this->Cells[static_cast<std::size_t>(index)];
    rest.col(index) = Eigen::Vector3d(MiddleOf(anatomy, anatomy.Points, cell).data());
    moved.col(index) = Eigen::Vector3d(MiddleOf(anatomy, points, cell).data());
  }
  const Eigen::Matrix4d rigid = Eigen::umeyama(rest, moved, false);
  for (int row = 0; row < 3; ++row)
  {
    this->Rotation[row] = { rigid(row, 0), rigid(row, 1), rigid(row, 2) };
    this->Shift[row] = rigid(row, 3);
  }
}

double ModelError::SigmaMm(const Vector3& rest, const Vector3& compressed) const
{
  const Vector3 rigid = Vector3{ Dot(this->Rotation[0], rest), Dot(this->Rotation[1], rest),
    Dot(this->Rotation[2], rest) } +
    this->Shift;
  const double behind = std::max(0.0, ModelErrorEdgeMm - this->Placed.ToGantry(compressed)[1]);
  return std::hypot(ModelErrorMm, ModelErrorShare * Norm(compressed - rigid),
    ModelErrorEdgeShare * behind);
}

std::optional<ExpectedError> ExpectedErrorOf(const TetrahedralMesh& anatomy,
  const ViewResult& result)
{
  const std::vector<double>& covariance =
    result.ConsideredCovariance.empty() ? result.Covariance : result.ConsideredCovariance;
  if (covariance.empty())
  {
    return std::nullopt;
  }
  const ModelError model(anatomy, result.Points, result.Placed);
  const std::size_t parameters = result.Sensitivities.size();
  std::vector<double> sigmas;
  for (const std::size_t cell : model.CellsBetween())
  {
    std::vector<Vector3> velocities(parameters);
    for (std::size_t parameter = 0; parameter < parameters; ++parameter)
    {
      if (!result.Sensitivities[parameter].empty())
      {
        velocities[parameter] = MiddleOf(anatomy, result.Sensitivities[parameter], cell);
      }
    }
    double trace = 0;
    for (std::size_t i = 0; i < parameters; ++i)
    {
      for (std::size_t j = 0; j < parameters; ++j)
      {
        trace += covariance[i * parameters + j] * Dot(velocities[i], velocities[j]);
      }
    }
    const double own = model.SigmaMm(MiddleOf(anatomy, anatomy.Points, cell),
      MiddleOf(anatomy, result.Points, cell));
    sigmas.push_back(std::sqrt(trace / 3 + own * own));
  }
  return ExpectedError{ DistanceQuantile(sigmas, 0.5), DistanceQuantile(sigmas, 0.95) };
}
}
