// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PixelMask_h
#define mammoray_PixelMask_h

#include "mammoray/Foundation/Raster.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <cstddef>
#include <vector>

namespace mammoray
{
/// A side of a picture.
enum class Side
{
  Left,
  Right,
  Top,
  Bottom
};

/// "left", "right", "upper" or "lower".
const char* NameOf(Side side);

/// The pixels of a picture and their distances, mm.
struct PixelGrid
{
  int Columns = 0;
  int Rows = 0;
  double ColumnSpacing = 1;
  double RowSpacing = 1;

  std::size_t Count() const
  {
    return static_cast<std::size_t>(this->Columns) * static_cast<std::size_t>(this->Rows);
  }
  RasterShape Shape() const { return { this->Columns, this->Rows }; }
  std::size_t Index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Columns) +
      static_cast<std::size_t>(column);
  }
};

/// A value for each pixel of a grid, row by row: 1 where it is set, else 0.
using PixelMask = std::vector<unsigned char>;

/// The distance of each set pixel's centre to the nearest centre of a clear one, mm; 0 at clear
/// pixels, infinite where there is none. The border of the picture is nothing special.
MAMMORAYREGISTRATION_EXPORT std::vector<float> DistanceToClear(const PixelGrid& grid,
  const PixelMask& mask);

/// Signed distance to the outline of a mask, mm, negative inside; its border with the picture is
/// none.
MAMMORAYREGISTRATION_EXPORT std::vector<float> SignedDistance(const PixelGrid& grid,
  const PixelMask& mask);

/// How far a mask touches each side of the picture, in the order of Side, mm.
MAMMORAYREGISTRATION_EXPORT std::array<double, 4> TouchedSides(const PixelGrid& grid,
  const PixelMask& mask);

/**
 * A dark frame along a side of the picture (rows that the detector does not read) is no air: where
 * the breast touches the line 1 mm inside the side much more than the side itself, the stripe
 * between is filled.
 */
MAMMORAYREGISTRATION_EXPORT void FillDarkFrame(const PixelGrid& grid, PixelMask& mask);

/// The parts of the mask that are thicker than `thinnest` mm, and the pixels of the mask near them.
MAMMORAYREGISTRATION_EXPORT PixelMask WithoutThinParts(const PixelGrid& grid, PixelMask mask,
  double thinnest);
}

#endif
