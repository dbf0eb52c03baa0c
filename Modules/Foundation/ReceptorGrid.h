// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReceptorGrid_h
#define mammoray_ReceptorGrid_h

#include "mammorayFoundationModule.h"

#include <array>
#include <cstddef>

namespace mammoray
{
/// A point of the receptor plane (z = 0 of the gantry frame): x and y, mm.
using ReceptorPoint = std::array<double, 2>;

/**
 * Grid of pixels in the receptor plane (z = 0 of the gantry frame).
 *
 * Pixel (column, row) has its centre at Origin + column * ColumnStep + row * RowStep, in mm; rows
 * follow one another in memory. The steps must be linearly independent.
 */
struct MAMMORAYFOUNDATION_EXPORT ReceptorGrid
{
  int Columns = 0;
  int Rows = 0;
  ReceptorPoint Origin{ 0, 0 };
  std::array<double, 2> ColumnStep{ 0.1, 0 };
  std::array<double, 2> RowStep{ 0, 0.1 };

  bool operator==(const ReceptorGrid&) const = default;

  /// Columns * Rows; 0 where either is not positive.
  std::size_t NumberOfPixels() const;
  /// Place of a pixel in arrays with one value per pixel.
  std::size_t Index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Columns) +
      static_cast<std::size_t>(column);
  }

  /// Lengths of the steps, mm.
  double ColumnSpacingMm() const;
  double RowSpacingMm() const;
  /// Area of a pixel, mm^2; 0 where the steps are dependent.
  double PixelAreaMm2() const;

  /// Position of a continuous pixel index; pixel centres are at whole numbers.
  ReceptorPoint PositionOf(double column, double row) const;
  /// Continuous column and row of a position: the inverse of PositionOf.
  std::array<double, 2> IndexOf(const ReceptorPoint& position) const;
  /// Whether a position lies on a pixel, at least `marginMm` away from the borders of the grid.
  bool Contains(const ReceptorPoint& position, double marginMm = 0) const;

  /// The grid of factor x factor pixels averaged into one; the rest at the far borders is dropped.
  ReceptorGrid Coarsened(int factor) const;
};
}

#endif
