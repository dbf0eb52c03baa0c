// SPDX-License-Identifier: Apache-2.0
#include "BreastBetweenPlates.h"
#include "Refusals.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <string>

namespace
{
using namespace mammoray;
using test::MakeBreast;
using test::MakePlates;

TEST(ForceSearch, FindsTheThicknessOfAForce)
{
  CompressionSimulation simulation = MakeBreast({}, 0.49, 4);
  const PlatePair plates = MakePlates(58);
  const double force = simulation.Compress(plates).PaddleForceN;
  PlatePairVelocity closing; // half by either plate
  closing.Support.Linear = 0.5 * plates.Support.Normal;
  closing.Paddle.Linear = 0.5 * plates.Paddle.Normal;
  const CompressionState state = simulation.CompressToForce(MakePlates(70), closing, force);
  EXPECT_NEAR(state.PaddleForceN, force, 1e-4 * force);
  // 1e-4 of the force over its relative rate, about 0.1 / mm.
  EXPECT_NEAR(GapMm(state.Plates), 58, 0.005);
  EXPECT_THROW(simulation.CompressToForce(plates, closing, 0), InputError);
  EXPECT_THROW(simulation.CompressToForce(plates, {}, 5), InputError);
  try
  {
    simulation.CompressToForce(plates, closing, 1e5);
    FAIL() << "ten tons were reached";
  }
  catch (const CompressionError& error)
  {
    EXPECT_THAT(error.what(), test::Mentions("force", "100000.00 N"));
    EXPECT_LT(error.LastGapMm(), 58);
  }
}
}
