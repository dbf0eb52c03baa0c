// SPDX-License-Identifier: Apache-2.0
#include "SmallBreast.h"
#include "mammoray/App/Private/KilovoltageSpectrum.h"
#include "mammoray/App/Private/LiveMammogram.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
using namespace mammoray;

class LiveMammogramTest : public testing::Test
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
    this->Viewed = ReadViewedBreasts(test::WriteSmallBreast(this->Folder)).front();
  }
  test::TemporaryFolder Folder;
  ViewedBreast Viewed;
};

TEST_F(LiveMammogramTest, IsTheProjectionOfTheMovedUnit)
{
  LiveMammogram live(this->Viewed, {});
  live.SetPose(60, 12);
  live.SetSourceOffset({ 40, -25, -80 });
  live.SetKilovoltage(31);
  const std::vector<float> picture = live.Project(1);

  // The same from the parts: the registration's source and detector for the shifted unit.
  const BreastInUnit breast = live.InUnit();
  const auto projector = MakeProjector({});
  projector->SetSurface(live.Surface());
  const PathLengthImage lengths = projector->Project(SourceOf(breast.Placed, breast.Unit),
    DetectorOf(breast.Placed, breast.Grid, 1));
  const Beam beam = MakeBeam(this->Viewed.Materials, AtKilovoltage(this->Viewed.Spectrum, 31),
    DetectorResponse::EnergyIntegrating);
  const std::vector<float> expected = beam.LogAttenuation(lengths);
  ASSERT_EQ(picture.size(), expected.size());
  double largest = 0;
  for (std::size_t pixel = 0; pixel < picture.size(); ++pixel)
  {
    largest = std::max(largest, static_cast<double>(expected[pixel]));
    // The source's place rounds in another way; the device's exponentials are floats.
    ASSERT_NEAR(picture[pixel], expected[pixel], 1e-4) << pixel;
  }
  EXPECT_GT(largest, 1);
}

TEST_F(LiveMammogramTest, HalfResolutionShowsTheSame)
{
  LiveMammogram live(this->Viewed, {});
  const std::vector<float> fine = live.Project(1);
  const std::vector<float> coarse = live.Project(2);
  const ReceptorGrid& grid = live.Grid(2);
  ASSERT_EQ(coarse.size(), static_cast<std::size_t>(grid.Columns) * grid.Rows);
  int compared = 0;
  for (int row = 0; row < grid.Rows; ++row)
  {
    for (int column = 0; column < grid.Columns; ++column)
    {
      const float value = coarse[static_cast<std::size_t>(row) * grid.Columns + column];
      double low = 1e9;
      double high = 0;
      for (int corner = 0; corner < 4; ++corner)
      {
        const double other =
          fine[static_cast<std::size_t>(2 * row + (corner >> 1)) * live.Grid(1).Columns +
            2 * column + (corner & 1)];
        low = std::min(low, other);
        high = std::max(high, other);
      }
      if (low > 0.2)
      {
        ++compared;
        // Between its four pixels, up to the curvature of the surface in a pixel and 1 % for the
        // joined energies.
        EXPECT_GT(value, 0.98 * low - 0.01);
        EXPECT_LT(value, 1.02 * high + 0.01);
      }
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST_F(LiveMammogramTest, IsDarkerAtHigherVoltageWithoutNewRays)
{
  LiveMammogram live(this->Viewed, {});
  const std::vector<float> low = live.Project(1);
  live.SetKilovoltage(34);
  const std::vector<float> high = live.Project(1);
  for (std::size_t pixel = 0; pixel < low.size(); ++pixel)
  {
    // The same rays; thin layers are left to the rounding of floats.
    if (low[pixel] > 0.01F)
    {
      ASSERT_GT(high[pixel], 0);
      ASSERT_LT(high[pixel], low[pixel]);
    }
    else
    {
      ASSERT_LT(high[pixel], 0.01F);
    }
  }
}

TEST_F(LiveMammogramTest, KeepsTheSourceAboveThePaddle)
{
  LiveMammogram live(this->Viewed, {});
  live.SetPose(60, 0);
  live.SetSourceOffset({ 0, 0, -10000 });
  const Vector3 source = live.Placed().ToGantry(live.SourcePosition());
  EXPECT_NEAR(source[2], 2 + 60 + 20, 1e-9);
  EXPECT_THROW(live.SetPoints({ 1, 2, 3 }), InputError);
}
}
