// SPDX-License-Identifier: Apache-2.0
#include "Private/ScatterCells.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#endif
#include <unsupported/Eigen/FFT>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace mammoray
{
namespace
{
constexpr double CellMm = 2;

/// The smallest number that is at least `least` and has no prime factors but 2, 3 and 5.
int FourierSize(int least)
{
  for (int size = least;; ++size)
  {
    int rest = size;
    for (const int factor : { 2, 3, 5 })
    {
      while (rest % factor == 0)
      {
        rest /= factor;
      }
    }
    if (rest == 1)
    {
      return size;
    }
  }
}

/// Fourier transform of an image, in place. The inverse divides by the number of values.
void FourierTransform(std::vector<std::complex<double>>& values, int columns, int rows,
  bool inverse)
{
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> in;
  std::vector<std::complex<double>> out;
  const auto line = [&](std::size_t first, std::size_t step, int count)
  {
    in.resize(static_cast<std::size_t>(count));
    for (std::size_t place = 0; place < in.size(); ++place)
    {
      in[place] = values[first + place * step];
    }
    if (inverse)
    {
      fft.inv(out, in);
    }
    else
    {
      fft.fwd(out, in);
    }
    for (std::size_t place = 0; place < in.size(); ++place)
    {
      values[first + place * step] = out[place];
    }
  };
  for (int row = 0; row < rows; ++row)
  {
    line(static_cast<std::size_t>(row) * columns, 1, columns);
  }
  for (int column = 0; column < columns; ++column)
  {
    line(static_cast<std::size_t>(column), static_cast<std::size_t>(columns), rows);
  }
}

/// Signed distance from index 0 in a periodic sequence.
int Signed(int place, int count)
{
  return place <= count / 2 ? place : place - count;
}

/// Linear interpolation between two cells.
struct Between
{
  Between(double place, int count)
    : Low(static_cast<int>(std::floor(place)))
    , Share(place - this->Low)
    , Cells{ std::clamp(this->Low, 0, count - 1), std::clamp(this->Low + 1, 0, count - 1) }
  {
  }
  double Weight(int side) const { return side == 0 ? 1 - this->Share : this->Share; }

  int Low;
  double Share;
  std::array<int, 2> Cells;
};
}

ScatterCells::ScatterCells(const XRayDetector& detector)
{
  const auto gather = [](double pixelMm)
  { return std::max(1, static_cast<int>(std::lround(CellMm / pixelMm))); };
  this->PerColumn = gather(Norm(detector.ColumnStep));
  this->PerRow = gather(Norm(detector.RowStep));
  // Without what rounding makes of a detector that is turned: points of cells lie on the edges of
  // rings.
  const auto sizeOf = [](int pixels, const Vector3& step)
  { return 1e-9 * std::round(1e9 * pixels * Norm(step)); };
  this->ColumnMm = sizeOf(this->PerColumn, detector.ColumnStep);
  this->RowMm = sizeOf(this->PerRow, detector.RowStep);
  this->Columns = (detector.Columns + this->PerColumn - 1) / this->PerColumn;
  this->Rows = (detector.Rows + this->PerRow - 1) / this->PerRow;
}

ScatterCells::Shares ScatterCells::SharesAt(double pixelColumn, double pixelRow, double columnRate,
  double rowRate) const
{
  const Between across(this->ColumnOf(pixelColumn), this->Columns);
  const Between down(this->RowOf(pixelRow), this->Rows);
  Shares shares;
  for (int corner = 0; corner < 4; ++corner)
  {
    const int right = corner & 1;
    const int lower = corner >> 1;
    const auto index = static_cast<std::size_t>(corner);
    shares.Cells[index] = static_cast<std::size_t>(down.Cells[static_cast<std::size_t>(lower)]) *
        static_cast<std::size_t>(this->Columns) +
      static_cast<std::size_t>(across.Cells[static_cast<std::size_t>(right)]);
    shares.Values[index] = across.Weight(right) * down.Weight(lower);
    shares.Rates[index] =
      (right == 0 ? -1 : 1) * columnRate / this->PerColumn * down.Weight(lower) +
      (lower == 0 ? -1 : 1) * rowRate / this->PerRow * across.Weight(right);
  }
  return shares;
}

ScatterPlane::ScatterPlane(const ScatterCells& cells, double reachMm)
  : Grid(cells)
{
  const auto padded = [&](int count, double cellMm)
  {
    const int reach = static_cast<int>(std::ceil(reachMm / cellMm));
    return FourierSize(count + std::min(count, reach) + 1);
  };
  this->Columns = padded(cells.Columns, cells.ColumnMm);
  this->Rows = padded(cells.Rows, cells.RowMm);
  this->Values.resize(
    static_cast<std::size_t>(this->Columns) * static_cast<std::size_t>(this->Rows));
}

void ScatterPlane::Put(const Pair& values)
{
  std::fill(this->Values.begin(), this->Values.end(), 0);
  for (int part = 0; part < 2; ++part)
  {
    const std::vector<double>* of = values[static_cast<std::size_t>(part)];
    for (std::size_t cell = 0; of && cell < of->size(); ++cell)
    {
      const auto columns = static_cast<std::size_t>(this->Grid.Columns);
      std::complex<double>& value =
        this->Values[this->At(static_cast<int>(cell % columns), static_cast<int>(cell / columns))];
      value += part == 0 ? std::complex<double>((*of)[cell], 0) : std::complex(0.0, (*of)[cell]);
    }
  }
}

void ScatterPlane::PutWithBorder(const std::vector<double>& values)
{
  const auto within = [](int place, int count, int size) {
    return place < count ? place : place < (count + size) / 2 ? count - 1 : 0;
  };
  for (int row = 0; row < this->Rows; ++row)
  {
    for (int column = 0; column < this->Columns; ++column)
    {
      const std::size_t cell =
        static_cast<std::size_t>(within(row, this->Grid.Rows, this->Rows)) * this->Grid.Columns +
        static_cast<std::size_t>(within(column, this->Grid.Columns, this->Columns));
      this->Values[this->At(column, row)] = values.empty() ? 0.0 : values[cell];
    }
  }
}

void ScatterPlane::ToFrequencies()
{
  FourierTransform(this->Values, this->Columns, this->Rows, false);
}

void ScatterPlane::FromFrequencies()
{
  FourierTransform(this->Values, this->Columns, this->Rows, true);
}

void ScatterPlane::AddProduct(const ScatterPlane& a, const ScatterPlane& b)
{
  for (std::size_t place = 0; place < this->Values.size(); ++place)
  {
    this->Values[place] += a.Values[place] * b.Values[place];
  }
}

void ScatterPlane::SpreadGaussian(double sigmaMm)
{
  const auto damping = [&](int place, int count, double cellMm)
  {
    const double wave = 2 * std::numbers::pi * Signed(place, count) / (count * cellMm);
    return std::exp(-0.5 * wave * wave * sigmaMm * sigmaMm);
  };
  std::vector<double> across(static_cast<std::size_t>(this->Columns));
  for (int column = 0; column < this->Columns; ++column)
  {
    across[static_cast<std::size_t>(column)] = damping(column, this->Columns, this->Grid.ColumnMm);
  }
  for (int row = 0; row < this->Rows; ++row)
  {
    const double down = damping(row, this->Rows, this->Grid.RowMm);
    for (int column = 0; column < this->Columns; ++column)
    {
      this->Values[this->At(column, row)] *= down * across[static_cast<std::size_t>(column)];
    }
  }
}

std::array<std::vector<double>, 2> ScatterPlane::Take() const
{
  std::array<std::vector<double>, 2> values;
  for (int row = 0; row < this->Grid.Rows; ++row)
  {
    for (int column = 0; column < this->Grid.Columns; ++column)
    {
      const std::complex<double>& value = this->Values[this->At(column, row)];
      values[0].push_back(value.real());
      values[1].push_back(value.imag());
    }
  }
  return values;
}

ScatterRings::ScatterRings(const ScatterPlane& plane, std::vector<double> radiiMm)
  : Radii(std::move(radiiMm))
  , Columns(plane.Columns / 2 + 1)
  , Rows(plane.Rows / 2 + 1)
{
  const double columnMm = plane.Grid.ColumnMm;
  const double rowMm = plane.Grid.RowMm;
  const std::size_t rings = this->Radii.size() - 1;
  this->Areas.resize(static_cast<std::size_t>(this->Columns) * this->Rows * rings);
  double* areas = this->Areas.data();
  for (int row = 0; row < this->Rows; ++row)
  {
    for (int column = 0; column < this->Columns; ++column, areas += rings)
    {
      // Where rings are narrower than a cell, many points of it.
      const int points = std::hypot(column * columnMm, row * rowMm) < 12 * CellMm ? 12 : 3;
      const auto offset = [points](int point) { return (point + 0.5) / points - 0.5; };
      for (int point = 0; point < points * points; ++point)
      {
        const double radius = std::hypot((column + offset(point % points)) * columnMm,
          (row + offset(point / points)) * rowMm);
        const auto above = std::upper_bound(this->Radii.begin(), this->Radii.end(), radius);
        const auto ring = static_cast<std::size_t>(above - this->Radii.begin()) - 1;
        if (ring < rings)
        {
          areas[ring] += columnMm * rowMm / (points * points);
        }
      }
    }
  }
}

void ScatterRings::PutKernel(const std::vector<double>& shares, ScatterPlane& plane) const
{
  std::vector<double> density(shares.size());
  for (std::size_t ring = 0; ring < shares.size(); ++ring)
  {
    density[ring] = shares[ring] /
      (std::numbers::pi *
        (this->Radii[ring + 1] * this->Radii[ring + 1] - this->Radii[ring] * this->Radii[ring]));
  }
  for (int row = 0; row < plane.Rows; ++row)
  {
    for (int column = 0; column < plane.Columns; ++column)
    {
      const std::size_t cell = static_cast<std::size_t>(std::abs(Signed(row, plane.Rows))) *
          static_cast<std::size_t>(this->Columns) +
        static_cast<std::size_t>(std::abs(Signed(column, plane.Columns)));
      double sum = 0;
      for (std::size_t ring = 0; ring < density.size(); ++ring)
      {
        sum += this->Areas[cell * density.size() + ring] * density[ring];
      }
      plane.Values[plane.At(column, row)] = sum;
    }
  }
}
}
