// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Progress.h"

#include <gtest/gtest.h>

#include <string>

namespace
{
using namespace mammoray;

TEST(Progress, IsToldOfFractionAndStage)
{
  double told = -1;
  std::string stage;
  ReportProgress(
    [&](double fraction, const char* name)
    {
      told = fraction;
      stage = name;
      return true;
    },
    0.25, "meshing");
  EXPECT_EQ(told, 0.25);
  EXPECT_EQ(stage, "meshing");
}

TEST(Progress, StopsTheWorkWhenAsked)
{
  const ProgressCallback stop = [](double, const char*) { return false; };
  EXPECT_THROW(ReportProgress(stop, 0, "meshing"), Interrupted);
  EXPECT_NO_THROW(ReportProgress({}, 0, "meshing")); // nobody listens
}
}
