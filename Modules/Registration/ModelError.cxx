// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/ModelError.h"

#include "mammoray/Registration/RegistrationResult.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace mammoray
{
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

double VolumeOf(const TetrahedralMesh& mesh, std::size_t cell)
{
  const auto* const corners = &mesh.Cells[4 * cell];
  const Vector3 first = PointAt(mesh.Points, corners[0]);
  return std::abs(Dot(PointAt(mesh.Points, corners[1]) - first,
           Cross(PointAt(mesh.Points, corners[2]) - first,
             PointAt(mesh.Points, corners[3]) - first))) /
    6;
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
{
  std::vector<double> volumes;
  for (const bool between : { true, false })
  {
    volumes.assign(anatomy.NumberOfCells(), 0.0);
    for (std::size_t cell = 0; cell < volumes.size(); ++cell)
    {
      if (!between || placed.ToGantry(MiddleOf(anatomy, points, cell))[1] > 0)
      {
        volumes[cell] = VolumeOf(anatomy, cell);
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
  return std::hypot(ModelErrorMm, ModelErrorShare * Norm(compressed - rigid));
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
