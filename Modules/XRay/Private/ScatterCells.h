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
/// Groups of pixels of about 2 mm. Scatter is smooth over some mm; smaller cells change it by less
/// than the noise of the kernels.
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
  /// Converts a continuous pixel index to a continuous cell index; centres are at whole numbers.
  double ColumnOf(double pixelColumn) const { return (pixelColumn + 0.5) / this->PerColumn - 0.5; }
  double RowOf(double pixelRow) const { return (pixelRow + 0.5) / this->PerRow - 0.5; }

  /// Bilinear weights of the four cells around a point, and their derivatives when the point moves
  /// by `columnRate` and `rowRate` pixels.
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

/// Cell values with a margin around them, as one period of a periodic image, or their Fourier
/// transform. Holds two images, as real and imaginary parts; real kernels do not mix them.
class ScatterPlane
{
public:
  /// The margin keeps opposite borders apart for kernels up to `reachMm` long.
  ScatterPlane(const ScatterCells& cells, double reachMm);

  using Pair = std::array<const std::vector<double>*, 2>;
  /// Sets both images; 0 in the margin. Null or empty: 0 everywhere.
  void Put(const Pair& values);
  /// Sets the first image; the margin continues the nearer border. Empty: 0 everywhere.
  void PutWithBorder(const std::vector<double>& values);
  void ToFrequencies();
  void FromFrequencies();
  /// Adds the product of two Fourier transforms.
  void AddProduct(const ScatterPlane& a, const ScatterPlane& b);
  /// Convolves with a Gaussian; the plane is a Fourier transform.
  void SpreadGaussian(double sigmaMm);
  /// Both images without the margin.
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

/// The areas that rings around the centre of a cell share with the cells around it.
class ScatterRings
{
public:
  /// `radiiMm`: radii of the rings' edges, ascending from 0.
  ScatterRings(const ScatterPlane& plane, std::vector<double> radiiMm);
  /// Sets `plane` to the kernel of a cell: the share of each ring is distributed evenly over it.
  void PutKernel(const std::vector<double>& shares, ScatterPlane& plane) const;

private:
  std::vector<double> Radii;
  /// Size of the lower right quadrant; the kernel is symmetric.
  int Columns;
  int Rows;
  /// [cell * rings + ring], mm^2.
  std::vector<double> Areas;
};
}

#endif
