// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterCells_h
#define mammoray_ScatterCells_h

#include "mammoray/XRay/PathLengthProjector.h"

#include <array>
#include <complex>
#include <cstddef>
#include <vector>

namespace mammoray
{
/// Pixels gathered to cells of about 2 mm: scatter is smooth over some mm; finer cells of the plane
/// change it by less than the table's noise.
class ScatterCells
{
public:
  explicit ScatterCells(const XRayDetector& detector);

  std::size_t Count() const { return static_cast<std::size_t>(this->Columns) * this->Rows; }
  std::size_t CellOf(int column, int row) const
  {
    return static_cast<std::size_t>(row / this->PerRow) * this->Columns +
      static_cast<std::size_t>(column / this->PerColumn);
  }
  /// A place in pixels from the middle of the first, in cells.
  double ColumnOf(double pixelColumn) const { return (pixelColumn + 0.5) / this->PerColumn - 0.5; }
  double RowOf(double pixelRow) const { return (pixelRow + 0.5) / this->PerRow - 0.5; }

  /// The four cells around a place, as they share what is there, and how the shares change as the
  /// place moves by `columnRate` and `rowRate` pixels.
  struct Shares
  {
    std::array<std::size_t, 4> Cells{};
    std::array<double, 4> Values{};
    std::array<double, 4> Rates{};
  };
  Shares SharesAt(double pixelColumn, double pixelRow, double columnRate = 0,
    double rowRate = 0) const;

  int PerColumn = 1;
  int PerRow = 1;
  int Columns = 0;
  int Rows = 0;
  double ColumnMm = 0;
  double RowMm = 0;
};

/// Values of the cells of a picture with a margin around, which repeats itself; or their Fourier
/// transform. Holds two pictures, as real and as imaginary part, which no real kernel mixes.
class ScatterPlane
{
public:
  /// What is farther away than `reachMm` does not matter.
  ScatterPlane(const ScatterCells& cells, double reachMm);

  using Pair = std::array<const std::vector<double>*, 2>;
  /// Nothing in the margin. Null or empty: 0 everywhere.
  void Put(const Pair& values);
  /// The margin as the nearer border.
  void PutWithBorder(const Pair& values);
  void ToFrequencies();
  void FromFrequencies();
  /// Of frequencies.
  void AddProduct(const ScatterPlane& a, const ScatterPlane& b);
  /// Of frequencies.
  void SpreadGaussian(double sigmaMm);
  /// Without the margin.
  std::array<std::vector<double>, 2> Take() const;

private:
  friend class ScatterRings;
  std::size_t At(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Columns) +
      static_cast<std::size_t>(column);
  }

  ScatterCells Grid;
  int Columns;
  int Rows;
  std::vector<std::complex<double>> Values;
};

/// Which parts of the cells around one lie in which ring about its middle.
class ScatterRings
{
public:
  /// `radiiMm`: of the rings' edges, ascending from 0.
  ScatterRings(const ScatterPlane& plane, std::vector<double> radiiMm);
  /// What a cell sends to those around it, each ring's share spread evenly over its area.
  void PutKernel(const std::vector<double>& shares, ScatterPlane& plane) const;

private:
  std::vector<double> Radii;
  /// Of the quarter of the plane to the lower right, the others being its mirror images.
  int Columns;
  int Rows;
  /// [cell * rings + ring], mm^2.
  std::vector<double> Areas;
};
}

#endif
