// SPDX-License-Identifier: Apache-2.0
#include "Private/Plate.h"

#include <vnl/algo/vnl_cholesky.h>
#include <vnl/vnl_matrix_fixed.h>
#include <vnl/vnl_vector_fixed.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mammoray
{
namespace
{
using Values = std::vector<double>;

/// The normal equations of the plate over columns x rows cells.
class PlateEquations
{
public:
  PlateEquations(int columns, int rows, Values weights, double stiffness)
    : Columns(columns)
    , Rows(rows)
    , Weights(std::move(weights))
    , Stiffness(stiffness)
  {
  }

  /// (W + stiffness D'D) h with the second differences D.
  Values Apply(const Values& h) const
  {
    Values result(h.size());
    for (std::size_t n = 0; n < h.size(); ++n)
    {
      result[n] = this->Weights[n] * h[n];
    }
    this->ForEachDifference(
      [&](const std::array<std::size_t, 4>& at, const std::array<double, 4>& factors)
      {
        double difference = 0;
        for (int k = 0; k < 4; ++k)
        {
          difference += factors[k] * h[at[k]];
        }
        for (int k = 0; k < 4; ++k)
        {
          result[at[k]] += this->Stiffness * factors[k] * difference;
        }
      });
    return result;
  }

  Values Diagonal() const
  {
    Values diagonal = this->Weights;
    this->ForEachDifference(
      [&](const std::array<std::size_t, 4>& at, const std::array<double, 4>& factors)
      {
        for (int k = 0; k < 4; ++k)
        {
          diagonal[at[k]] += this->Stiffness * factors[k] * factors[k];
        }
      });
    return diagonal;
  }

  /// Conjugate gradients with diagonal preconditioning, starting at `h`.
  Values Solve(const Values& right, Values h) const
  {
    constexpr double tolerance = 1e-5;
    const Values diagonal = this->Diagonal();
    const auto dot = [](const Values& a, const Values& b)
    {
      double sum = 0;
      for (std::size_t n = 0; n < a.size(); ++n)
      {
        sum += a[n] * b[n];
      }
      return sum;
    };
    Values residual = this->Apply(h);
    for (std::size_t n = 0; n < h.size(); ++n)
    {
      residual[n] = right[n] - residual[n];
    }
    const double goal = tolerance * tolerance * dot(right, right);
    Values direction(h.size(), 0.0);
    double last = 1;
    for (std::size_t step = 0; step < 4 * h.size() && dot(residual, residual) > goal; ++step)
    {
      Values scaled = residual;
      for (std::size_t n = 0; n < h.size(); ++n)
      {
        scaled[n] /= diagonal[n];
      }
      const double now = dot(residual, scaled);
      for (std::size_t n = 0; n < h.size(); ++n)
      {
        direction[n] = scaled[n] + (step == 0 ? 0 : now / last) * direction[n];
      }
      last = now;
      const Values applied = this->Apply(direction);
      const double length = now / dot(direction, applied);
      for (std::size_t n = 0; n < h.size(); ++n)
      {
        h[n] += length * direction[n];
        residual[n] -= length * applied[n];
      }
    }
    return h;
  }

private:
  template <typename Visit>
  void ForEachDifference(Visit visit) const
  {
    const auto at = [this](int x, int z)
    { return static_cast<std::size_t>(z) * this->Columns + static_cast<std::size_t>(x); };
    const double sqrt2 = std::numbers::sqrt2;
    for (int z = 0; z < this->Rows; ++z)
    {
      for (int x = 0; x < this->Columns; ++x)
      {
        if (x > 0 && x + 1 < this->Columns)
        {
          visit(std::array<std::size_t, 4>{ at(x - 1, z), at(x, z), at(x + 1, z), at(x, z) },
            std::array<double, 4>{ 1, -2, 1, 0 });
        }
        if (z > 0 && z + 1 < this->Rows)
        {
          visit(std::array<std::size_t, 4>{ at(x, z - 1), at(x, z), at(x, z + 1), at(x, z) },
            std::array<double, 4>{ 1, -2, 1, 0 });
        }
        if (x + 1 < this->Columns && z + 1 < this->Rows)
        {
          visit(
            std::array<std::size_t, 4>{ at(x, z), at(x + 1, z), at(x, z + 1), at(x + 1, z + 1) },
            std::array<double, 4>{ sqrt2, -sqrt2, -sqrt2, sqrt2 });
        }
      }
    }
  }

  int Columns;
  int Rows;
  Values Weights;
  double Stiffness;
};
}

HeightMap::Pointer FitPlate(const HeightMap* heights, const HeightMap* weights, double wavelengthMm)
{
  const auto size = heights->GetLargestPossibleRegion().GetSize();
  const int columns = static_cast<int>(size[0]);
  const int rows = static_cast<int>(size[1]);
  const double fineMm = heights->GetSpacing()[0];
  const int block = std::max(1, static_cast<int>(wavelengthMm / 16 / fineMm));
  // Cells extend one beyond the last fine one, so that every fine one lies between cells.
  const int cells = (columns - 1) / block + 2;
  const int cellRows = (rows - 1) / block + 2;
  Values sums(static_cast<std::size_t>(cells) * cellRows, 0.0);
  Values right(sums.size(), 0.0);
  double sum = 0;
  double total = 0;
  // Bilinear weights: the fine heights act like springs on the plate, lumped to the nodes.
  for (int z = 0; z < rows; ++z)
  {
    for (int x = 0; x < columns; ++x)
    {
      const double weight = weights->GetPixel({ { x, z } });
      const double height = heights->GetPixel({ { x, z } });
      const std::size_t node = static_cast<std::size_t>((z + block / 2) / block) * cells +
        static_cast<std::size_t>((x + block / 2) / block);
      if (weight > 0)
      {
        sums[node] += weight / (block * block);
        right[node] += weight * height / (block * block);
        sum += weight * height;
        total += weight;
      }
    }
  }
  const double stiffness = std::pow(wavelengthMm / (2 * std::numbers::pi * fineMm * block), 4.0);
  const PlateEquations equations(cells, cellRows, sums, stiffness);
  const Values nodes = equations.Solve(right, Values(sums.size(), total > 0 ? sum / total : 0.0));
  HeightMap::Pointer plate = MakeLike<HeightMap>(*heights, 0.0f);
  for (int z = 0; z < rows; ++z)
  {
    for (int x = 0; x < columns; ++x)
    {
      const int i = x / block;
      const int k = z / block;
      const double u = static_cast<double>(x % block) / block;
      const double w = static_cast<double>(z % block) / block;
      const auto node = [&](int a, int b)
      { return nodes[static_cast<std::size_t>(b) * cells + static_cast<std::size_t>(a)]; };
      plate->SetPixel({ { x, z } },
        static_cast<float>((1 - w) * ((1 - u) * node(i, k) + u * node(i + 1, k)) +
          w * ((1 - u) * node(i, k + 1) + u * node(i + 1, k + 1))));
    }
  }
  return plate;
}

HeightMap::Pointer FitParaboloid(const HeightMap* heights, const HeightMap* weights)
{
  constexpr int terms = 6;
  using Terms = vnl_vector_fixed<double, terms>;
  const auto size = heights->GetLargestPossibleRegion().GetSize();
  const int columns = static_cast<int>(size[0]);
  const int rows = static_cast<int>(size[1]);
  const double halfMm = 0.5 * heights->GetSpacing()[0] * std::max(columns, rows);
  const auto termsAt = [&](int x, int z)
  {
    const double u = (x - 0.5 * (columns - 1)) * heights->GetSpacing()[0] / halfMm;
    const double w = (z - 0.5 * (rows - 1)) * heights->GetSpacing()[1] / halfMm;
    const double values[terms] = { 1, u, w, u * u, u * w, w * w };
    return Terms(values);
  };
  vnl_matrix_fixed<double, terms, terms> normal(0.0);
  Terms right(0.0);
  for (int z = 0; z < rows; ++z)
  {
    for (int x = 0; x < columns; ++x)
    {
      const double weight = weights->GetPixel({ { x, z } });
      const Terms t = termsAt(x, z);
      normal += weight * outer_product(t, t);
      right += weight * heights->GetPixel({ { x, z } }) * t;
    }
  }
  // Terms that the heights do not determine stay 0.
  const double least = 1e-6 * normal(0, 0) + std::numeric_limits<double>::min();
  for (int k = 0; k < terms; ++k)
  {
    normal(k, k) += least;
  }
  const Terms found =
    vnl_cholesky(normal.as_matrix(), vnl_cholesky::quiet).solve(right.as_vector());
  HeightMap::Pointer paraboloid = MakeLike<HeightMap>(*heights, 0.0f);
  for (int z = 0; z < rows; ++z)
  {
    for (int x = 0; x < columns; ++x)
    {
      paraboloid->SetPixel({ { x, z } }, static_cast<float>(dot_product(found, termsAt(x, z))));
    }
  }
  return paraboloid;
}

namespace
{
HeightMap::Pointer FitCurvedPlate(const HeightMap* heights, const HeightMap* weights,
  double wavelengthMm)
{
  const HeightMap::Pointer paraboloid = FitParaboloid(heights, weights);
  const HeightMap::Pointer rest = MakeFrom<HeightMap>(*heights,
    [&](std::size_t n)
    { return heights->GetBufferPointer()[n] - paraboloid->GetBufferPointer()[n]; });
  const HeightMap::Pointer plate = FitPlate(rest, weights, wavelengthMm);
  return MakeFrom<HeightMap>(*heights,
    [&](std::size_t n)
    { return plate->GetBufferPointer()[n] + paraboloid->GetBufferPointer()[n]; });
}
}

HeightMap::Pointer FitRobustPlate(const HeightMap* heights, const HeightMap* weights,
  double wavelengthMm, const std::vector<double>& scalesMm, PlateShape shape)
{
  const auto fit = [&](const HeightMap* trusted)
  {
    return shape == PlateShape::Flat ? FitPlate(heights, trusted, wavelengthMm)
                                     : FitCurvedPlate(heights, trusted, wavelengthMm);
  };
  HeightMap::Pointer plate = fit(weights);
  for (const double scale : scalesMm)
  {
    plate = fit(MakeFrom<HeightMap>(*heights,
      [&](std::size_t n)
      {
        const double r = (heights->GetBufferPointer()[n] - plate->GetBufferPointer()[n]) / scale;
        const double trust = std::abs(r) < 1 ? (1 - r * r) * (1 - r * r) : 0.0;
        return weights->GetBufferPointer()[n] * trust;
      }));
  }
  return plate;
}
}
