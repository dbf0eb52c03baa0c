// SPDX-License-Identifier: Apache-2.0
#include "SimulatedMammogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mammoray
{
namespace
{
TEST(SimulatedMammogram, AFieldBeginsAtTheChestWallAndIsCentredOnTheBreast)
{
  for (const DetectorField& field : { SmallField, LargeField })
  {
    for (const double up : { 1.0, -1.0 })
    {
      const ReceptorGrid grid = SimulatedDetector(0.5, up, field);
      // The left breast's chest wall is at the left, the right one's at the right.
      const int wall = up > 0 ? 0 : grid.Columns - 1;
      const ReceptorPoint first = grid.PositionOf(wall, 0);
      const ReceptorPoint last = grid.PositionOf(grid.Columns - 1 - wall, grid.Rows - 1);
      EXPECT_NEAR(first[0], -last[0], 1e-9);
      EXPECT_NEAR(up * (first[0] - last[0]), field.WidthMm - 0.5, 1e-9);
      EXPECT_NEAR(first[1], 0.25, 1e-9);
      EXPECT_NEAR(last[1], field.DepthMm - 0.25, 1e-9);
    }
  }
}

TEST(SimulatedMammogram, IsCutAtItsFrontAndNowhereElse)
{
  const ReceptorGrid grid = SimulatedDetector(10);
  std::vector<float> picture(grid.NumberOfPixels(), 0.0F);
  EXPECT_FALSE(IsCutAtFront(picture, grid));
  const auto columns = static_cast<std::size_t>(grid.Columns);
  // All along the chest wall, both sides, and up to the last but one column.
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel)
  {
    picture[pixel] = pixel % columns + 1 < columns ? 1.0F : 0.0F;
  }
  EXPECT_FALSE(IsCutAtFront(picture, grid));
  picture[7 * columns - 1] = 0.01F;
  EXPECT_TRUE(IsCutAtFront(picture, grid));
  std::fill(picture.begin(), picture.end(), 0.0F);
  picture[7 * columns] = 0.01F;
  EXPECT_FALSE(IsCutAtFront(picture, grid));
  EXPECT_TRUE(IsCutAtFront(picture, SimulatedDetector(10, -1)));
}

/// A slab of attenuation 2 over the half of the field at the chest wall, with a denser strip in it.
struct SlabOnDetector
{
  ReceptorGrid Grid = SimulatedDetector(2);
  std::vector<float> Attenuation = std::vector<float>(Grid.NumberOfPixels(), 0.0F);
  static constexpr int Dense = 20;

  SlabOnDetector()
  {
    for (std::size_t pixel = 0; pixel < this->Attenuation.size(); ++pixel)
    {
      const int column = static_cast<int>(pixel) % this->Grid.Columns;
      this->Attenuation[pixel] = column >= this->Grid.Columns / 2 ? 0.0F
        : column == Dense                                         ? 2.5F
                                                                  : 2.0F;
    }
  }

  Mammogram Developed(PictureKind kind) const
  {
    Draws draws(1, 0, 0);
    return Develop({}, this->Attenuation, this->Grid, { .Kind = kind, .Noise = 0 }, draws);
  }

  /// Of the middle row.
  float At(const Mammogram& picture, int column) const
  {
    return picture
      .Pixels[static_cast<std::size_t>(this->Grid.Rows / 2) * this->Grid.Columns + column];
  }
};

TEST(SimulatedMammogram, RawPicturesFollowIntensity)
{
  const SlabOnDetector slab;
  const Mammogram raw = slab.Developed(PictureKind::Raw);
  EXPECT_EQ(raw.PresentationIntent, Mammogram::Intent::ForProcessing);
  EXPECT_EQ(raw.IntensitySign, 1);
  // Whole numbers of 12 bits.
  EXPECT_NEAR(slab.At(raw, 5) / slab.At(raw, 80), std::exp(-2.0), 1e-3);
  EXPECT_NEAR(slab.At(raw, SlabOnDetector::Dense) / slab.At(raw, 80), std::exp(-2.5), 1e-3);
}

TEST(SimulatedMammogram, ScatterIsHalfThePrimaryAndTheHeelTakesAFifth)
{
  const SlabOnDetector slab;
  const Mammogram raw = slab.Developed(PictureKind::Raw);
  const Mammogram scattered = slab.Developed(PictureKind::Scattered);
  // In the middle of the slab, 45 mm from either border and away from the strip, about all that is
  // within three deviations of 15 mm is slab.
  const int middle = slab.Grid.Columns / 4;
  const double heel = 1 - 0.2 * middle / slab.Grid.Columns;
  EXPECT_NEAR(slab.At(scattered, middle) / slab.At(raw, middle), 1.5 * heel, 0.03);
  // Air far from the breast has lost what the heel takes and got nothing.
  const int front = slab.Grid.Columns - 1;
  EXPECT_NEAR(slab.At(scattered, front) / slab.At(raw, front), 1 - 0.2 * front / slab.Grid.Columns,
    1e-3);
  // Scatter reaches beside the breast.
  const int beside = slab.Grid.Columns / 2 + 2;
  EXPECT_GT(slab.At(scattered, beside) / slab.At(raw, beside),
    1 - 0.2 * beside / slab.Grid.Columns);
}

TEST(SimulatedMammogram, EqualisedPicturesKeepDetailsAndLoseWhatVariesSlowly)
{
  SlabOnDetector slab;
  // A slope of 1 over the slab.
  for (std::size_t pixel = 0; pixel < slab.Attenuation.size(); ++pixel)
  {
    const int column = static_cast<int>(pixel) % slab.Grid.Columns;
    slab.Attenuation[pixel] +=
      slab.Attenuation[pixel] > 0 ? 2.0F * column / slab.Grid.Columns : 0.0F;
  }
  const Mammogram display = slab.Developed(PictureKind::Display);
  const Mammogram equalised = slab.Developed(PictureKind::Equalised);
  EXPECT_EQ(display.PresentationIntent, Mammogram::Intent::ForPresentation);
  EXPECT_EQ(equalised.IntensitySign, -1);
  const auto detailOverSlope = [&](const Mammogram& picture)
  {
    const auto at = [&](int column) { return slab.At(picture, column); };
    return (at(SlabOnDetector::Dense) -
             0.5 * (at(SlabOnDetector::Dense - 1) + at(SlabOnDetector::Dense + 1))) /
      (at(SlabOnDetector::Dense + 12) - at(SlabOnDetector::Dense - 12));
  };
  EXPECT_GT(detailOverSlope(display), 0);
  // 0.7 of the slope is taken off, and what the window does to the contrast is done to both.
  EXPECT_GT(detailOverSlope(equalised), 2.5 * detailOverSlope(display));
}
}
}
