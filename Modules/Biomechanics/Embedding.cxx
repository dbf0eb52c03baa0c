// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Biomechanics/Embedding.h"

#include "Private/CellPatches.h"
#include "Private/CompressionInternals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace mammoray
{
namespace
{
/// Weights of the ten nodes at barycentric coordinates `l`, extrapolated to `l` + `away` with the
/// gradient in the middle of the cell. At the corner of a cell that is bent around a plate's edge
/// the gradient is ten times larger: it threw skin 90 mm out of a breast.
void QuadraticWeights(const Eigen::Vector4d& l, const Eigen::Vector4d& away, double* weights)
{
  for (int c = 0; c < 4; ++c)
  {
    weights[c] = l[c] * (2 * l[c] - 1);
  }
  for (int e = 0; e < 6; ++e)
  {
    const int i = CellEdges[e][0];
    const int j = CellEdges[e][1];
    weights[4 + e] = 4 * l[i] * l[j] + away[i] + away[j];
  }
}

/// Finds cells by position. Cells are treated as straight-sided; a regular grid holds their
/// bounding boxes.
class CellLocator
{
public:
  CellLocator(const ElasticBody& body, const std::vector<double>& positions)
    : Body(body)
    , Positions(positions)
  {
    const std::size_t cellCount = body.NumberOfCells();
    this->Low.setConstant(std::numeric_limits<double>::infinity());
    this->High = -this->Low;
    for (std::size_t cell = 0; cell < cellCount; ++cell)
    {
      const auto corners = this->Corners(cell);
      this->Low = this->Low.cwiseMin(corners.rowwise().minCoeff());
      this->High = this->High.cwiseMax(corners.rowwise().maxCoeff());
    }
    this->Cells.reserve(cellCount);
    for (std::size_t cell = 0; cell < cellCount; ++cell)
    {
      this->Cells.emplace_back(this->Corners(cell));
    }
    const Eigen::Vector3d extent = (this->High - this->Low).cwiseMax(1e-9);
    // Choose bins that hold about one cell.
    const double width = std::cbrt(extent.prod() / static_cast<double>(cellCount));
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Size[axis] = std::clamp(static_cast<int>(std::ceil(extent[axis] / width)), 1, 256);
      this->BinWidth[axis] = extent[axis] / this->Size[axis];
    }
    this->Bins.resize(static_cast<std::size_t>(this->Size[0]) * this->Size[1] * this->Size[2]);
    for (std::size_t cell = 0; cell < cellCount; ++cell)
    {
      const auto corners = this->Corners(cell);
      ForEachBin(this->BinOf(corners.rowwise().minCoeff()),
        this->BinOf(corners.rowwise().maxCoeff()),
        [&](const Eigen::Vector3i& bin)
        { this->Bins[this->Index(bin)].push_back(static_cast<std::int32_t>(cell)); });
    }
  }

  Eigen::Matrix<double, 3, 4> Corners(std::size_t cell) const
  {
    Eigen::Matrix<double, 3, 4> corners;
    for (int c = 0; c < 4; ++c)
    {
      const std::int32_t node = this->Body.Cells()[this->Body.NodesPerCell() * cell + c];
      corners.col(c) = Eigen::Map<const Eigen::Vector3d>(&this->Positions[3 * node]);
    }
    return corners;
  }

  Eigen::Vector4d Barycentric(std::size_t cell, const Eigen::Vector3d& point) const
  {
    const Eigen::Vector3d l = this->Cells[cell].Inverse * (point - this->Cells[cell].Corner);
    return { 1 - l.sum(), l[0], l[1], l[2] };
  }

  /// Returns the cell that contains or is nearest to the point; `nearest` receives the nearest
  /// point of it.
  std::int32_t Find(const Eigen::Vector3d& point, Eigen::Vector3d& nearest) const
  {
    const Eigen::Vector3i home = this->BinOf(point);
    for (const std::int32_t cell : this->Bins[this->Index(home)])
    {
      if (this->Barycentric(cell, point).minCoeff() >= -1e-10)
      {
        nearest = point;
        return cell;
      }
    }
    std::int32_t best = -1;
    double bestDistance = std::numeric_limits<double>::infinity();
    const int rings = this->Size.maxCoeff();
    for (int ring = 0; ring <= rings; ++ring)
    {
      // Cells in a farther ring are at least this far from the point, projected into the grid's
      // box.
      const double reach = (ring - 1) * this->BinWidth.minCoeff();
      if (reach > 0 && bestDistance < reach)
      {
        break;
      }
      const auto around = Eigen::Vector3i::Constant(ring);
      ForEachBin((home - around).cwiseMax(0),
        (home + around).cwiseMin(this->Size - Eigen::Vector3i::Ones()),
        [&](const Eigen::Vector3i& bin)
        {
          if ((bin - home).cwiseAbs().maxCoeff() == ring)
          {
            this->FindInBin(bin, point, bestDistance, best, nearest);
          }
        });
    }
    return best;
  }

private:
  /// Data of a cell that every search needs.
  struct Cell
  {
    /// Inverse of the matrix of the three sides from corner 0.
    Eigen::Matrix3d Inverse;
    Eigen::Vector3d Corner;
    Eigen::Vector3d Low;
    Eigen::Vector3d High;

    explicit Cell(const Eigen::Matrix<double, 3, 4>& corners)
      : Inverse((corners.rightCols<3>().colwise() - corners.col(0)).inverse())
      , Corner(corners.col(0))
      , Low(corners.rowwise().minCoeff())
      , High(corners.rowwise().maxCoeff())
    {
    }
    double DistanceToBox(const Eigen::Vector3d& point) const
    {
      return (point - point.cwiseMax(this->Low).cwiseMin(this->High)).norm();
    }
  };

  /// Replaces the best cell so far by a nearer one of the bin.
  void FindInBin(const Eigen::Vector3i& bin, const Eigen::Vector3d& point, double& bestDistance,
    std::int32_t& best, Eigen::Vector3d& nearest) const
  {
    for (const std::int32_t cell : this->Bins[this->Index(bin)])
    {
      if (this->Cells[cell].DistanceToBox(point) >= bestDistance)
      {
        continue;
      }
      const Eigen::Vector3d candidate = this->NearestInCell(cell, point);
      const double distance = (candidate - point).norm();
      if (distance < bestDistance)
      {
        bestDistance = distance;
        best = cell;
        nearest = candidate;
      }
    }
  }

  /// Calls visit(bin) for all bins from `from` to `to`.
  template <typename Visit>
  static void ForEachBin(const Eigen::Vector3i& from, const Eigen::Vector3i& to, const Visit& visit)
  {
    for (int k = from[2]; k <= to[2]; ++k)
    {
      for (int j = from[1]; j <= to[1]; ++j)
      {
        for (int i = from[0]; i <= to[0]; ++i)
        {
          visit(Eigen::Vector3i(i, j, k));
        }
      }
    }
  }

  Eigen::Vector3i BinOf(const Eigen::Vector3d& point) const
  {
    Eigen::Vector3i bin;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double position = (point[axis] - this->Low[axis]) / this->BinWidth[axis];
      bin[axis] = static_cast<int>(std::clamp(position, 0.0, this->Size[axis] - 1.0));
    }
    return bin;
  }
  std::size_t Index(const Eigen::Vector3i& bin) const
  {
    return (static_cast<std::size_t>(bin[2]) * this->Size[1] + bin[1]) * this->Size[0] + bin[0];
  }

  Eigen::Vector3d NearestInCell(std::size_t cell, const Eigen::Vector3d& point) const
  {
    if (this->Barycentric(cell, point).minCoeff() >= 0)
    {
      return point;
    }
    const auto corners = this->Corners(cell);
    Eigen::Vector3d best = corners.col(0);
    for (int face = 0; face < 4; ++face)
    {
      const Eigen::Vector3d candidate = NearestInTriangle(corners.col((face + 1) % 4),
        corners.col((face + 2) % 4), corners.col((face + 3) % 4), point);
      if ((candidate - point).squaredNorm() < (best - point).squaredNorm())
      {
        best = candidate;
      }
    }
    return best;
  }

  static Eigen::Vector3d NearestInTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
    const Eigen::Vector3d& c, const Eigen::Vector3d& point)
  {
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double area = normal.squaredNorm();
    const double u = normal.dot((c - b).cross(point - b)) / area;
    const double v = normal.dot((a - c).cross(point - c)) / area;
    if (u >= 0 && v >= 0 && u + v <= 1)
    {
      return u * a + v * b + (1 - u - v) * c;
    }
    Eigen::Vector3d best = a;
    const Eigen::Vector3d ends[3][2] = { { a, b }, { b, c }, { c, a } };
    for (const auto& end : ends)
    {
      const Eigen::Vector3d along = end[1] - end[0];
      const double t = std::clamp(along.dot(point - end[0]) / along.squaredNorm(), 0.0, 1.0);
      const Eigen::Vector3d candidate = end[0] + t * along;
      if ((candidate - point).squaredNorm() < (best - point).squaredNorm())
      {
        best = candidate;
      }
    }
    return best;
  }

  const ElasticBody& Body;
  const std::vector<double>& Positions;
  std::vector<Cell> Cells;
  Eigen::Vector3d Low;
  Eigen::Vector3d High;
  Eigen::Vector3i Size;
  Eigen::Vector3d BinWidth;
  std::vector<std::vector<std::int32_t>> Bins;
};
}

Embedding::Embedding(const CompressionSimulation& simulation, const std::vector<double>& points)
  : NodesPerPoint(simulation.Internal->Body.NodesPerCell())
{
  const ElasticBody& body = simulation.Internal->Body;
  if (points.size() % 3 != 0 ||
    !std::all_of(points.begin(), points.end(), [](double c) { return std::isfinite(c); }))
  {
    throw InputError("embedding: expected three finite coordinates for each point");
  }
  const CellLocator locator(body, simulation.ImagePositions());
  const std::size_t count = points.size() / 3;
  const int perPoint = this->NodesPerPoint;
  this->Nodes.resize(perPoint * count);
  this->Weights.resize(perPoint * count);
  this->CellIndices.resize(count);
  ParallelFor(count,
    [&](std::size_t p)
    {
      const Eigen::Vector3d point(points[3 * p], points[3 * p + 1], points[3 * p + 2]);
      Eigen::Vector3d nearest = point;
      const std::int32_t cell = locator.Find(point, nearest);
      this->CellIndices[p] = cell;
      // Use the shape functions inside a cell. Outside, use their tangent at the nearest point: it
      // is exact for linear fields and avoids the growth of a parabola for others.
      const Eigen::Vector4d l = locator.Barycentric(cell, nearest);
      const Eigen::Vector4d away = locator.Barycentric(cell, point) - l;
      double* weights = &this->Weights[perPoint * p];
      if (body.Type() == ElementType::Quadratic)
      {
        QuadraticWeights(l, away, weights);
      }
      else
      {
        Eigen::Map<Eigen::Vector4d>{ weights } = l + away;
      }
      std::copy_n(&body.Cells()[perPoint * cell], perPoint, &this->Nodes[perPoint * p]);
    });
}

std::vector<double> Embedding::Map(const std::vector<double>& nodeValues) const
{
  std::vector<double> result(3 * this->NumberOfPoints());
  this->Map(nodeValues, result);
  return result;
}

void Embedding::Map(std::span<const double> nodeValues, std::span<double> pointValues) const
{
  const auto perPoint = static_cast<std::size_t>(this->NodesPerPoint);
  ParallelFor(this->NumberOfPoints(),
    [&](std::size_t p)
    {
      double sum[3] = { 0, 0, 0 };
      for (std::size_t a = 0; a < perPoint; ++a)
      {
        const double weight = this->Weights[perPoint * p + a];
        const double* value =
          &nodeValues[3 * static_cast<std::size_t>(this->Nodes[perPoint * p + a])];
        for (int axis = 0; axis < 3; ++axis)
        {
          sum[axis] += weight * value[axis];
        }
      }
      std::copy_n(sum, 3, &pointValues[3 * p]);
    });
}

std::vector<double> Embedding::Gather(const std::vector<double>& pointValues,
  std::size_t nodeCount) const
{
  std::vector<double> sums(3 * nodeCount, 0.0);
  const auto perPoint = static_cast<std::size_t>(this->NodesPerPoint);
  for (std::size_t index = 0; index < this->Weights.size(); ++index)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      sums[3 * static_cast<std::size_t>(this->Nodes[index]) + axis] +=
        this->Weights[index] * pointValues[3 * (index / perPoint) + axis];
    }
  }
  return sums;
}
}
